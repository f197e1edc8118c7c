"""Reads planning domains `*.itl`: from the sentences of a text to a `Domain`, with every fault found on the
way.

The notation is that of R Fig. 5 with what a whole domain needs beside it (assumptions, goals, rules, facts,
persistence, sensing); the grammar stands in `itl_syntax`, the meaning of each part in `domain`. Faults of
single sentences are found here, those between sentences in `checks`.
"""

from __future__ import annotations

from collections.abc import Iterable
from os import PathLike
from typing import TYPE_CHECKING, TypeAlias

from planner_reactor.errors import Diagnostic, DomainError
from planner_reactor.logic.allen import NAMED, inverse, relations
from planner_reactor.logic.checks import Survey, findings
from planner_reactor.logic.domain import (
    AT_START,
    MEETS,
    ActionSchema,
    Assumption,
    Condition,
    Domain,
    Effect,
    Exclusion,
    Goal,
    Persistence,
    Rule,
)
from planner_reactor.logic.formulas import Atom, Term
from planner_reactor.logic.itl_metrics import Metrics
from planner_reactor.logic.itl_nodes import (
    AssumptionNode,
    AtomNode,
    Clause,
    FactNode,
    GoalNode,
    Name,
    PersistenceNode,
    RelationNode,
    ResourceNode,
    RuleNode,
    SchemaNode,
    Sentence,
    UnequalNode,
)
from planner_reactor.logic.itl_syntax import LABELS, parse
from planner_reactor.logic.itl_tokens import Source
from planner_reactor.logic.scope import TIME, Constraints, Scope, standing

if TYPE_CHECKING:
    from pathlib import Path

_Atoms: TypeAlias = Iterable[tuple[AtomNode, Atom]]
_CONDITIONS = ("presumes", "applicability", "executability")
_ENDS_WITH_TIME = relations(["f", "e"])
_ALL_TIME = NAMED["encompasses"]


def read_domain(source: str | Path, *, file: str | None = None) -> Domain:
    """The domain in a file (a Path, or a name that ends in `.itl`) or in a text.

    DomainError with all that is wrong; OSError if the file cannot be read.
    """
    domain, found = _read(*_text_of(source, file), warnings=False)
    errors = [finding for finding in found if finding.severity == "error"]
    if errors:
        raise DomainError(errors)
    return domain


def check_domain(text: str, *, file: str = "<text>") -> tuple[Diagnostic, ...]:
    """Everything that is wrong (errors) or odd (warnings) about a domain text, in the order of the text."""
    try:
        return _read(text, file)[1]
    except DomainError as error:
        return error.diagnostics


def _text_of(source: str | Path, file: str | None) -> tuple[str, str]:
    if isinstance(source, PathLike) or (source.endswith(".itl") and "\n" not in source):
        with open(source, encoding="utf-8") as text:
            return text.read(), file or str(source)
    return source, file or "<text>"


def _read(text: str, file: str, *, warnings: bool = True) -> tuple[Domain, tuple[Diagnostic, ...]]:
    source = Source(text, file)
    sentences, wrong = parse(source)
    builder = _Builder(source, wrong, sentences)
    for sentence in sorted(sentences, key=lambda s: isinstance(s, PersistenceNode)):
        builder.add(sentence)  # persistence last: which of its names are constants shows elsewhere
    domain = builder.domain()
    wrong.extend(findings(builder.survey, domain, whole=not wrong, warnings=warnings))
    return domain, tuple(sorted(wrong, key=lambda found: (found.place.line, found.place.column)))


class _Builder:
    """Collects the parts of a domain; what is wrong goes to `wrong`."""

    def __init__(self, source: Source, wrong: list[Diagnostic], sentences: Iterable[Sentence]) -> None:
        self.survey = Survey(source)
        self._source = source
        self._wrong = wrong
        self._arity = {s.name.text: len(s.parameters) for s in sentences if isinstance(s, AssumptionNode)}
        self._assumptions: list[Assumption] = []
        self._goals: list[Goal] = []
        self._rules: list[Rule] = []
        self._exclusions: list[Exclusion] = []
        self._persistences: list[Persistence] = []
        self._facts: list[Atom] = []
        self._schemas: list[ActionSchema] = []
        self._metrics = Metrics(source, wrong, sentences)

    def domain(self) -> Domain:
        return Domain(
            assumptions=self._assumptions,
            goals=self._goals,
            rules=self._rules,
            exclusions=self._exclusions,
            persistences=self._persistences,
            facts=self._facts,
            schemas=self._schemas,
            resources=self._metrics.resources.values(),
            file=self._source.file,
        )

    def add(self, sentence: Sentence) -> None:
        scope = Scope(self._source, self._wrong, self.survey.constants)
        match sentence:
            case AssumptionNode():
                self._assumptions.append(self._assumption(sentence))
            case GoalNode():
                self._goals.append(self._goal(sentence, scope))
            case RuleNode():
                self._rule(sentence, scope)
            case PersistenceNode():
                self._persistences.append(self._persistence(sentence, scope))
            case FactNode():
                self._facts.extend(self._fact(sentence, scope))
            case ResourceNode():
                self.survey.named("resource", sentence.name)
            case SchemaNode():
                self._schemas.append(self._schema(sentence, scope))

    # ------------------------------------------------------------------------------------------ sentences

    def _assumption(self, node: AssumptionNode) -> Assumption:
        self.survey.named("assumption", node.name)
        likelihood = 0.5 if node.likelihood is None else float(node.likelihood.text)
        if node.likelihood is not None and not 0 <= likelihood <= 1:
            self._error(node.likelihood, "likelihood", f"a likelihood of {likelihood}", "expected 0 to 1")
        period = 2000 if node.period is None else int(float(node.period.text))
        if period <= 0:
            self._error(node.period or node.name, "period", f"a period of {period} ms", "expected more than 0")
        return Assumption(
            node.name.text,
            len(node.parameters),
            likelihood,
            "reaction" if node.monitor == "reaction" else "flag",
            period,
            node.reinstatable,
            self._source.place(node.name.offset),
        )

    def _goal(self, node: GoalNode, scope: Scope) -> Goal:
        self.survey.named("goal", node.name)
        clauses = [c for c in (node.antecedent, node.consequent) if c is not None]
        scope.declare_quantified([*node.forall, *(n for c in clauses for n in c.exists)], standing(clauses))
        for clause in clauses:
            scope.check_relations([clause])
        antecedent = self._atoms(node.antecedent, scope, "needed") if node.antecedent else []
        consequent = self._atoms(node.consequent, scope, "needed")
        said = Constraints([node.consequent])
        ends = [scope.relation(said, atom.at, TIME, 0) for atom, _ in consequent]
        lasting = tuple(end != 0 and end & ~_ENDS_WITH_TIME == 0 for end in ends)
        return Goal(
            node.name.text,
            tuple(atom for _, atom in antecedent),
            tuple(atom for _, atom in consequent),
            lasting,
            len(scope.variables),
            kept=self._is_kept(node, ends),
            instead=tuple(self._instead(atom, scope) for atom in node.instead),
            place=self._source.place(node.name.offset),
        )

    def _instead(self, node: AtomNode, scope: Scope) -> Atom:
        """An abstract action with its arguments: constants as they are, variables for whatever it is asserted with."""
        atom = scope.atom(node)
        self.survey.instead.append((node, atom))
        return atom

    def _is_kept(self, node: GoalNode, ends: list[int]) -> bool:
        """Must everything that is wanted hold at all times? Not only a part of it."""
        always = [end != 0 and end & ~_ALL_TIME == 0 for end in ends]
        if any(always) and not all(always):
            self._error(node.name, "unsupported-goal", f"{node.name.text} is kept in part, and achieved in part",
                        "expected a goal of each")  # fmt: skip
        return any(always)

    def _rule(self, node: RuleNode, scope: Scope) -> None:
        clauses = [node.left, node.right]
        scope.declare_quantified([*node.forall, *(n for c in clauses for n in c.exists)], standing(clauses))
        scope.check_relations(clauses)
        if any(isinstance(literal, RelationNode) for literal in node.right.literals):
            self._exclusion(node, scope)
            return
        body, said = self._atoms(node.left, scope, "needed"), Constraints(clauses)
        distinct = self._distinct(node.left, scope)
        for head_node, head in self._atoms(node.right, scope, "produced"):
            self._no_assumption(head_node, "follow from a rule")
            centre = head_node.at.text if head_node.at else ""
            conditions = tuple(
                Condition(atom, scope.relation(said, at.at, centre, NAMED["equal"]))
                for at, atom in body
                if at.name.text not in self._arity
            )
            assumptions = tuple(atom for at, atom in body if at.name.text in self._arity)
            place = self._source.place(node.offset)
            self._rules.append(
                Rule(
                    head,
                    conditions,
                    assumptions,
                    distinct,
                    len(scope.variables),
                    place,
                )
            )

    def _exclusion(self, node: RuleNode, scope: Scope) -> None:
        atoms = self._atoms(node.left, scope, "mentioned")
        relation = node.right.literals[0]
        if len(node.right.literals) != 1 or not isinstance(relation, RelationNode):
            self._error(node.right, "unsupported-rule", "ITL(…) among several conclusions",
                        "expected ITL(i, disjunct, j) alone")  # fmt: skip
            return
        if relation.relation != NAMED["disjunct"]:
            self._error(relation.first, "unsupported-rule", "a rule that orders intervals otherwise",
                        "expected disjunct")  # fmt: skip
            return
        ends = []
        for name in (relation.first, relation.second):
            held = [(at, atom) for at, atom in atoms if at.at is not None and at.at.text == name.text]
            if not held:
                self._error(name, "unknown-interval", f"nothing in the rule holds over {name.text}",
                            "expected the interval of one of its conditions")  # fmt: skip
                return
            ends.append(held[0])
        for at, _ in atoms:
            self._no_assumption(at, "be a condition of a rule that concludes ITL(…)")
        given = tuple(atom for at, atom in atoms if all(at is not end[0] for end in ends))
        place = self._source.place(node.offset)
        distinct = self._distinct(node.left, scope)
        self._exclusions.append(Exclusion(ends[0][1], ends[1][1], given, distinct, len(scope.variables), place))

    def _persistence(self, node: PersistenceNode, scope: Scope) -> Persistence:
        if node.forall:
            scope.declare(node.forall)
        else:
            known = self.survey.constants
            scope.declare([n for n in _once(node.atom.arguments) if not n.number and n.text not in known])
        self.survey.atom(node.atom, "mentioned")
        assumptions = tuple(scope.atom(a) for a in node.assumptions)
        for assumption in node.assumptions:
            self._need_assumption(assumption)
        place = self._source.place(node.atom.name.offset)
        return Persistence(scope.atom(node.atom), assumptions, len(scope.variables), place)

    def _fact(self, node: FactNode, scope: Scope) -> list[Atom]:
        if node.clause.exists:
            self._error(node.clause, "misplaced-exists", "Exists in a fact", "expected named things only")
        found = []
        for literal in node.clause.literals:
            if isinstance(literal, AtomNode):
                self._no_assumption(literal, "be a fact")
                self.survey.atom(literal, "produced")
                found.append(scope.atom(literal))
            else:
                self._error(node.clause, "misplaced-relation", "a constraint in a fact", "expected p(x, …)")
        return found

    def _schema(self, node: SchemaNode, scope: Scope) -> ActionSchema:
        self.survey.named("action schema", node.name)
        inputs, outputs = scope.declare(node.inputs), scope.declare(node.outputs)
        scope.declare_intervals(node.intervals)
        scope.declare_intervals([node.name], used=True)
        clauses = [clause for _, clause in node.sections]
        unnamed: list[int] = []
        intervals = standing(clauses)
        for label, clause in node.sections:
            new = scope.declare_quantified(_once(clause.exists, scope.variables), intervals)
            unnamed.extend(new if label in ("effects", "otherwise") else ())
        scope.check_relations(clauses)
        atoms: dict[str, list[tuple[AtomNode, Atom]]] = {label: [] for label in LABELS}
        for label, clause in node.sections:
            role = "produced" if label in ("effects", "otherwise") else "needed"
            atoms[label].extend(self._atoms(clause, scope, role))
        schema = ActionSchema(
            node.name.text,
            inputs=inputs,
            outputs=outputs,
            unnamed=tuple(unnamed),
            presumes=self._presumed(atoms["presumes"]),
            applicability=self._applicable(atoms),
            executability=tuple(self._conditions(node, atoms["executability"], scope)),
            effects=tuple(self._effects(node, "effects", atoms["effects"], scope)),
            otherwise=tuple(self._effects(node, "otherwise", atoms["otherwise"], scope)),
            expansions=tuple(atom for _, atom in atoms["expansions"]),
            senses="senses" in node.marks,
            cleanup="cleanup" in node.marks,
            duration=self._metrics.duration(node),
            uses=self._metrics.uses(node, scope),
            variables=tuple(scope.variables),
            place=self._source.place(node.name.offset),
        )
        self.survey.schema(node, schema, scope.intervals)
        return schema

    # --------------------------------------------------------------------------------- sections of schemas

    def _presumed(self, atoms: _Atoms) -> tuple[Atom, ...]:
        for node, _ in atoms:
            if node.name.text not in self._arity:
                self.survey.unknown_assumption(node, self._arity, self._wrong)
        return tuple(atom for _, atom in atoms)

    def _applicable(self, atoms: dict[str, list[tuple[AtomNode, Atom]]]) -> tuple[Atom, ...]:
        """What must hold at selection: also assumptions that stand among the executability conditions."""
        assumed = [atom for node, atom in atoms["executability"] if node.name.text in self._arity]
        return tuple([atom for _, atom in atoms["applicability"]] + assumed)

    def _conditions(self, schema: SchemaNode, atoms: _Atoms, scope: Scope) -> Iterable[Condition]:
        said = Constraints(clause for label, clause in schema.sections if label in _CONDITIONS)
        for node, atom in atoms:
            if node.name.text not in self._arity:
                yield Condition(atom, scope.relation(said, node.at, schema.name.text, AT_START))

    def _effects(self, schema: SchemaNode, label: str, atoms: _Atoms, scope: Scope) -> Iterable[Effect]:
        said = Constraints(clause for other, clause in schema.sections if other == label)
        for node, atom in atoms:
            self._no_assumption(node, "be an effect")
            relation = scope.relation(said, node.at, schema.name.text, 0)
            yield Effect(atom, inverse(relation) if relation else MEETS)

    # ---------------------------------------------------------------------------------------- small parts

    def _atoms(self, clause: Clause, scope: Scope, role: str) -> list[tuple[AtomNode, Atom]]:
        found = []
        for literal in clause.literals:
            if isinstance(literal, AtomNode):
                if literal.at is not None:
                    scope.interval(literal.at)
                self.survey.atom(literal, role)
                found.append((literal, scope.atom(literal)))
        return found

    def _distinct(self, clause: Clause, scope: Scope) -> tuple[tuple[Term, Term], ...]:
        return tuple(
            (scope.term(literal.first), scope.term(literal.second))
            for literal in clause.literals
            if isinstance(literal, UnequalNode)
        )

    def _need_assumption(self, node: AtomNode) -> None:
        if node.name.text in self._arity:
            self.survey.atom(node, "needed")
        else:
            self.survey.unknown_assumption(node, self._arity, self._wrong)

    def _no_assumption(self, node: AtomNode, what: str) -> None:
        if node.name.text in self._arity:
            self._error(node.name, "misplaced-assumption", f"the assumption {node.name.text} cannot {what}",
                        "assumptions are only relied upon")  # fmt: skip

    def _error(self, where: Name | Clause, code: str, message: str, hint: str) -> None:
        self._wrong.append(self._source.diagnostic(where.offset, code, message, hint))


def _once(names: Iterable[Name], known: Iterable[str] = ()) -> list[Name]:
    """The names that are not known yet, each once."""
    seen = set(known)
    found = []
    for name in names:
        if name.text not in seen:
            seen.add(name.text)
            found.append(name)
    return found
