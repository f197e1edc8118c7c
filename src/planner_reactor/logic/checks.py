"""What is wrong or odd between the sentences of a domain: a `Survey` gathers who uses what, `findings`
judges.

Errors: a name defined twice, a predicate with different numbers of arguments, a condition that nothing in
the domain can ever bring about, an assumption that does not exist. Warnings: what is never used, and a
constant that stands only once and looks like a slip for a variable.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from planner_reactor.errors import Diagnostic, nearest
from planner_reactor.logic.domain import ActionSchema, Domain
from planner_reactor.logic.formulas import Atom
from planner_reactor.logic.itl_nodes import AtomNode, Name, SchemaNode
from planner_reactor.logic.itl_tokens import Source
from planner_reactor.logic.scope import TIME, Constants


class Survey:
    """Where the names of a domain are defined and used."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.constants: Constants = {}
        self.names: list[tuple[str, Name]] = []
        self.atoms: dict[str, list[tuple[AtomNode, str]]] = {}
        self.odd: list[Diagnostic] = []
        self.instead: list[tuple[AtomNode, Atom]] = []

    def named(self, what: str, name: Name) -> None:
        """Something with a name of its own: an assumption, a goal, an action schema."""
        self.names.append((what, name))

    def atom(self, node: AtomNode, role: str) -> None:
        """An atom in the role `needed`, `produced` or `mentioned`."""
        self.atoms.setdefault(node.name.text, []).append((node, role))

    def unknown_assumption(self, node: AtomNode, known: Iterable[str], wrong: list[Diagnostic]) -> None:
        hint = nearest(node.name.text, known) or f"known: {', '.join(known) or 'none'}"
        message = f"{node.name.text} is not an assumption"
        wrong.append(self.source.diagnostic(node.name.offset, "unknown-assumption", message, hint))

    def schema(self, node: SchemaNode, schema: ActionSchema, intervals: Mapping[str, bool]) -> None:
        """What is odd about one action schema."""
        for name in node.intervals:
            if not intervals.get(name.text, True) and name.text != TIME:
                self._warn(name, "unused-interval", f"the interval {name.text} is never used")
        if not schema.effects:
            self._warn(node.name, "no-effects", f"{node.name.text} has no effects, so nothing can ever ask for it")
        if schema.abstract and (schema.senses or schema.cleanup):
            mark = node.marks[0]
            message = f"{node.name.text} is abstract, {mark} has no meaning for it"
            self.odd.append(self.source.diagnostic(node.name.offset, "misplaced-mark", message))
        mentioned = {a for e in (*schema.effects, *schema.otherwise) for a in e.atom.arguments}
        for name, variable in zip(node.outputs, schema.outputs, strict=True):
            if variable not in mentioned:
                self._warn(name, "unused-result", f"no effect of {node.name.text} says anything of {name.text}")

    def _warn(self, name: Name, code: str, message: str) -> None:
        self.odd.append(self.source.diagnostic(name.offset, code, message, severity="warning"))


def findings(survey: Survey, domain: Domain, *, whole: bool, warnings: bool) -> Iterator[Diagnostic]:
    """Every finding; what only a whole domain can be blamed for (`whole`) is left out if sentences
    were skipped.
    """
    yield from survey.odd
    yield from _duplicates(survey)
    yield from _arities(survey, domain)
    if whole:
        yield from _never_produced(survey, domain)
        yield from _nothing_to_stand_in_for(survey, domain)
    if whole and warnings:
        yield from _never_used(survey, domain)
        yield from _never_taken(survey, domain)
        yield from _suspicious(survey)


def _duplicates(survey: Survey) -> Iterator[Diagnostic]:
    seen: dict[str, tuple[str, Name]] = {}
    for what, name in survey.names:
        if name.text in seen:
            first, at = seen[name.text]
            line = survey.source.place(at.offset).line
            message = f"the {what} {name.text} has the name of the {first} in line {line}"
            yield survey.source.diagnostic(name.offset, "duplicate-name", message, "choose another name")
        seen.setdefault(name.text, (what, name))


def _arities(survey: Survey, domain: Domain) -> Iterator[Diagnostic]:
    for predicate, uses in survey.atoms.items():
        first = uses[0][0]
        expected, where = len(first.arguments), f"as in line {survey.source.place(first.name.offset).line}"
        if predicate in domain.assumptions:
            expected, where = domain.assumptions[predicate].parameters, "as the assumption declares"
        for node, _ in uses:
            if len(node.arguments) != expected:
                message = f"{predicate} with {len(node.arguments)} arguments"
                yield survey.source.diagnostic(node.name.offset, "arity", message, f"expected {expected}, {where}")


def _never_produced(survey: Survey, domain: Domain) -> Iterator[Diagnostic]:
    produced = {p for p, uses in survey.atoms.items() if any(role == "produced" for _, role in uses)}
    produced |= set(domain.assumptions)
    for predicate, uses in survey.atoms.items():
        if predicate not in produced:
            node, role = next((use for use in uses if use[1] == "needed"), uses[0])
            severity = "error" if role == "needed" else "warning"
            message = f"nothing brings about {predicate}: no fact, rule, effect or assumption"
            hint = nearest(predicate, sorted(produced))
            yield survey.source.diagnostic(node.name.offset, "unknown-predicate", message, hint, severity=severity)


def _nothing_to_stand_in_for(survey: Survey, domain: Domain) -> Iterator[Diagnostic]:
    """What a goal acts instead of must be an abstract action: those alone are disabled."""
    abstract = [schema.name for schema in domain.schemas.values() if schema.abstract]
    for node, atom in survey.instead:
        name, schema = node.name, domain.schemas.get(atom.predicate)
        if schema is None or not schema.abstract:
            hint = nearest(name.text, abstract) or f"abstract are {', '.join(abstract) or 'none'}"
            yield survey.source.diagnostic(name.offset, "unknown-action", f"{name.text} is no abstract action", hint)
        elif len(atom.arguments) != len(schema.inputs):
            message = f"{name.text} with {len(atom.arguments)} arguments"
            hint = f"expected {len(schema.inputs)}, as the action takes"
            yield survey.source.diagnostic(name.offset, "arity", message, hint)


def _never_used(survey: Survey, domain: Domain) -> Iterator[Diagnostic]:
    for what, name in survey.names:
        if what == "assumption" and name.text not in survey.atoms:
            message = f"nothing rests on the assumption {name.text}"
            yield survey.source.diagnostic(name.offset, "unused-assumption", message, severity="warning")
    if not domain.goals:
        yield survey.source.diagnostic(
            0, "no-goal", "the domain has no goal", "atp_goal states one", severity="warning"
        )


def _never_taken(survey: Survey, domain: Domain) -> Iterator[Diagnostic]:
    taken = {demand.resource.predicate for schema in domain.schemas.values() for demand in schema.uses}
    for what, name in survey.names:
        if what == "resource" and name.text not in taken:
            message = f"no action uses the resource {name.text}"
            yield survey.source.diagnostic(name.offset, "unused-resource", message, severity="warning")


def _suspicious(survey: Survey) -> Iterator[Diagnostic]:
    for text, uses in survey.constants.items():
        name, variables = uses[0]
        near = nearest(text, variables)
        if len(uses) == 1 and near:
            message = f"{text} is a constant that stands nowhere else"
            yield survey.source.diagnostic(name.offset, "lone-constant", message, near, severity="warning")
