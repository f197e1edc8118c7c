"""The grammar of a domain text `*.itl`: from tokens to the sentences that it consists of, nothing resolved yet.

    sentence    = assumption | goal | rule | persistence | fact | resource | schema
    assumption  = "atp_assumption" NAME "(" [names] ")" {"likelihood" NUMBER | "monitor" monitor | "reinstatable"} ";"
    monitor     = "flag" NUMBER | "reaction"
    goal        = "atp_goal" NAME ["forall" names ":"] clause ["=>" clause] ["instead" atom {"," atom}] ";"
    rule        = "atp_rule" ["forall" names ":"] clause ("=>" | "<=>") clause ";"
    persistence = "atp_persistence" ["forall" names ":"] atom "while" atom {"and" atom} ";"
    fact        = "atp_fact" clause ";"
    resource    = "atp_resource" NAME ["(" names ")"] ["capacity" NUMBER] ";"
    schema      = "atp_actionschema" NAME ["<" [names] ">" "<" [names] ">"] {"senses" | "cleanup"}
                  {"intervals" names ";" | ("input" | "output" | "intervals") ":" names [";"] | LABEL ":" clauses
                  | "duration" ":" NUMBER [".." NUMBER] ";" | "uses" ":" use {"," use} ";"}
                  "endactionschema" [NAME] [";" | ":"]
    use         = NAME ["(" [names] ")"] [NUMBER]
    clauses     = clause {";" clause} [";"]
    clause      = ["Exists" names ":"] literal {"and" literal}
    literal     = atom ["@" NAME] | "(" clause ")" ["@" NAME] | "[" clause "]" ["@" NAME]
                | "ITL" "(" NAME "," relation "," NAME ")" | NAME "/=" NAME
    relation    = NAME | "[" NAME {[","] NAME} "]"

`LABEL` is presumes, applicability, executability, effects, otherwise or expansions; labels may be capitalised. A
sentence that is wrong is reported and skipped, so that one reading finds several errors.
"""

from __future__ import annotations

from collections.abc import Callable

from planner_reactor.errors import Diagnostic, nearest
from planner_reactor.logic.allen import BASES, NAMED, relations
from planner_reactor.logic.itl_nodes import (
    AssumptionNode,
    AtomNode,
    Clause,
    DemandNode,
    FactNode,
    GoalNode,
    LiteralNode,
    Name,
    PersistenceNode,
    RelationNode,
    ResourceNode,
    RuleNode,
    SchemaNode,
    Sentence,
    UnequalNode,
)
from planner_reactor.logic.itl_tokens import Source, Token, WrongSentence, tokens

LABELS = ("presumes", "applicability", "executability", "effects", "otherwise", "expansions")
_FURTHER = ("intervals", "input", "output", "duration", "uses")


def parse(source: Source) -> tuple[list[Sentence], list[Diagnostic]]:
    """The sentences of a text and what is wrong with the others; DomainError if it cannot even be cut
    into tokens.
    """
    reader = _Parser(source)
    sentences: list[Sentence] = []
    wrong: list[Diagnostic] = []
    while reader.token.kind != "end":
        try:
            sentences.append(reader.sentence())
        except WrongSentence as error:
            wrong.append(error.diagnostic)
            reader.skip_sentence()
    return sentences, wrong


class _Parser:
    def __init__(self, source: Source) -> None:
        self.source = source
        self._tokens = tokens(source)
        self._next = 0
        self.token: Token = self._tokens[0]
        self._sentences: dict[str, Callable[[], Sentence]] = {
            "atp_assumption": self._assumption,
            "atp_goal": self._goal,
            "atp_rule": self._rule,
            "atp_persistence": self._persistence,
            "atp_fact": self._fact,
            "atp_resource": self._resource,
            "atp_actionschema": self._schema,
        }

    def sentence(self) -> Sentence:
        read = self._sentences.get(self.token.text)
        if read is None:
            raise self._wrong(f"a sentence of the domain: one of {', '.join(self._sentences)}", self._sentences)
        self._advance()
        return read()

    def skip_sentence(self) -> None:
        """Go on to the next word that can begin a sentence."""
        while self.token.kind != "end":
            self._advance()
            if self.token.text in self._sentences:
                return

    def _assumption(self) -> AssumptionNode:
        name = self._name("the name of an assumption")
        parameters = self._arguments("()")
        likelihood = period = None
        monitor, reinstatable = "flag", False
        while not self._taken(";"):
            if self._taken("likelihood"):
                likelihood = self._number("a likelihood between 0 and 1")
            elif self._taken("reinstatable"):
                reinstatable = True
            elif self._taken("monitor"):
                monitor = self.token.text
                if self._taken("flag"):
                    period = self._number("the period of the monitor in milliseconds")
                elif not self._taken("reaction"):
                    raise self._wrong("flag MILLISECONDS or reaction", ("flag", "reaction"))
            else:
                raise self._wrong("likelihood, monitor, reinstatable or ;", ("likelihood", "monitor", "reinstatable"))
        return AssumptionNode(name, parameters, likelihood, period, monitor, reinstatable)

    def _goal(self) -> GoalNode:
        name = self._name("the name of a goal")
        forall = self._quantified("forall")
        antecedent: Clause | None = None
        consequent = self._clause()
        if self._taken("=>"):
            antecedent, consequent = consequent, self._clause()
        instead: list[AtomNode] = []
        while self._taken("," if instead else "instead"):
            instead.append(self._atom())
        self._need(";")
        return GoalNode(name, forall, antecedent, consequent, tuple(instead))

    def _rule(self) -> RuleNode:
        offset = self.token.offset
        forall = self._quantified("forall")
        left = self._clause()
        definition = self.token.text == "<=>"
        if not definition and self.token.text != "=>":
            raise self._wrong("and, => or <=>")
        self._advance()
        right = self._clause()
        self._need(";")
        return RuleNode(forall, right, left, offset) if definition else RuleNode(forall, left, right, offset)

    def _persistence(self) -> PersistenceNode:
        forall = self._quantified("forall")
        atom = self._atom()
        self._need("while")
        assumptions = [self._atom()]
        while self._taken("and"):
            assumptions.append(self._atom())
        self._need(";")
        return PersistenceNode(forall, atom, tuple(assumptions))

    def _fact(self) -> FactNode:
        clause = self._clause()
        self._need(";")
        return FactNode(clause)

    def _resource(self) -> ResourceNode:
        name, parameters = self._name("the name of a resource"), self._optional_arguments()
        capacity = self._number("how many there are") if self._taken("capacity") else None
        self._need(";", "capacity or ;")
        return ResourceNode(name, parameters, capacity)

    def _schema(self) -> SchemaNode:
        name = self._name("the name of an action schema")
        inputs: tuple[Name, ...] = ()
        outputs: tuple[Name, ...] = ()
        intervals: tuple[Name, ...] = ()
        sections: list[tuple[str, Clause]] = []
        duration: tuple[Name, Name] | None = None
        uses: tuple[DemandNode, ...] = ()
        if self.token.text == "<":
            inputs, outputs = self._arguments("<>"), self._arguments("<>")
        marks: list[str] = []
        while self.token.text in ("senses", "cleanup"):
            marks.append(self.token.text)
            self._advance()
        while not self._taken("endactionschema"):
            label = self.token.text.lower()
            if label in ("input", "output", "intervals"):
                self._advance()
                found = self._listed()
                inputs = inputs + found if label == "input" else inputs
                outputs = outputs + found if label == "output" else outputs
                intervals = intervals + found if label == "intervals" else intervals
            elif label == "duration":
                duration = self._duration()
            elif label == "uses":
                uses += self._uses()
            elif label in LABELS:
                self._label()
                sections.extend((label, clause) for clause in self._clauses())
            else:
                words = (*LABELS, *_FURTHER, "endactionschema")
                raise self._wrong(f"a section of the schema ({', '.join(LABELS)}) or endactionschema", words)
        self._taken(name.text)
        _ = self._taken(";") or self._taken(":")
        return SchemaNode(name, inputs, outputs, tuple(marks), intervals, tuple(sections), duration, uses)

    def _duration(self) -> tuple[Name, Name]:
        self._label()
        least = self._number("a duration in milliseconds")
        most = self._number("the longest duration in milliseconds") if self._taken("..") else least
        self._need(";", ".. or ;")
        return least, most

    def _uses(self) -> tuple[DemandNode, ...]:
        self._label()
        found = [self._demand()]
        while self._taken(","):
            found.append(self._demand())
        self._need(";", ", or ;")
        return tuple(found)

    def _demand(self) -> DemandNode:
        name, arguments = self._name("a resource"), self._optional_arguments()
        return DemandNode(name, arguments, self._number("an amount") if self.token.kind == "number" else None)

    def _optional_arguments(self) -> tuple[Name, ...]:
        return self._arguments("()") if self.token.text == "(" else ()

    def _clauses(self) -> list[Clause]:
        found: list[Clause] = []
        while not self._at_section():
            if self.token.text in self._sentences:
                raise self._wrong("endactionschema before the next sentence")
            found.append(self._clause())
            if not self._taken(";") and not self._at_section():
                raise self._wrong("and, ; or the next section")
        return found

    def _at_section(self) -> bool:
        word = self.token.text.lower()
        if word == "endactionschema":
            return True
        following = self._tokens[self._next + 1].text if self.token.kind == "name" else ""
        if word == "intervals":
            return following != "("
        return following == ":" and word in (*LABELS, *_FURTHER)

    def _clause(self) -> Clause:
        offset = self.token.offset
        exists = self._quantified("Exists")
        literals = list(self._literals())
        while self._taken("and"):
            exists += self._quantified("Exists")
            literals.extend(self._literals())
        return Clause(exists, tuple(literals), offset)

    def _literals(self) -> tuple[LiteralNode, ...]:
        """One literal, or those of a group in brackets with its interval given to each that has none."""
        if self.token.text in ("(", "["):
            return self._group()
        if self.token.text == "ITL":
            return (self._relation(),)
        if self.token.kind == "name" and self._tokens[self._next + 1].text == "/=":
            first = self._name("a name")
            self._advance()
            return (UnequalNode(first, self._name("a name", numbers=True)),)
        atom = self._atom()
        return (AtomNode(atom.name, atom.arguments, self._interval()),)

    def _group(self) -> tuple[LiteralNode, ...]:
        closing = ")" if self.token.text == "(" else "]"
        self._advance()
        clause = self._clause()
        self._need(closing)
        if clause.exists:
            raise WrongSentence(
                self.source.diagnostic(clause.offset, "misplaced-exists", "Exists inside brackets",
                                       "put it before the brackets")
            )  # fmt: skip
        interval = self._interval()
        return tuple(
            AtomNode(literal.name, literal.arguments, interval)
            if isinstance(literal, AtomNode) and literal.at is None
            else literal
            for literal in clause.literals
        )

    def _interval(self) -> Name | None:
        return self._name("an interval") if self._taken("@") else None

    def _atom(self) -> AtomNode:
        name = self._name("a predicate")
        return AtomNode(name, self._arguments("()"))

    def _relation(self) -> RelationNode:
        self._advance()
        self._need("(")
        first = self._name("an interval")
        self._need(",")
        relation = self._relation_names()
        self._need(",")
        second = self._name("an interval")
        self._need(")")
        return RelationNode(first, relation, second)

    def _relation_names(self) -> int:
        if not self._taken("["):
            name = self._name("a relation between intervals")
            if name.text not in NAMED and name.text not in BASES:
                raise self._unknown_relation(name)
            return NAMED[name.text] if name.text in NAMED else relations([name.text])
        found = 0
        while not self._taken("]"):
            name = self._name("a relation or ]")
            if name.text not in BASES:
                raise self._unknown_relation(name)
            found |= relations([name.text])
            self._taken(",")
        if not found:
            raise self._wrong(f"some of {' '.join(BASES)} inside the brackets before this")
        return found

    def _unknown_relation(self, name: Name) -> WrongSentence:
        known = (*NAMED, *BASES)
        hint = nearest(name.text, known) or f"expected one of {', '.join(NAMED)} or a list of {' '.join(BASES)}"
        message = f"{name.text} is not a relation between intervals"
        return WrongSentence(self.source.diagnostic(name.offset, "unknown-relation", message, hint))

    def _quantified(self, word: str) -> tuple[Name, ...]:
        if self.token.text not in (word, word.lower(), word.capitalize()):
            return ()
        self._advance()
        names = self._names()
        self._need(":")
        return names

    def _listed(self) -> tuple[Name, ...]:
        """`a, b;` or, as X §6.3 prints it, `: [a, b]`."""
        self._taken(":")
        if self._taken("["):
            names = () if self.token.text == "]" else self._names()
            self._need("]")
        else:
            names = self._names()
        self._taken(";")
        return names

    def _names(self) -> tuple[Name, ...]:
        found = [self._name("a name")]
        while self._taken(","):
            found.append(self._name("a name"))
        return tuple(found)

    def _arguments(self, brackets: str) -> tuple[Name, ...]:
        closing = brackets[1]
        self._need(brackets[0])
        found: list[Name] = []
        while not self._taken(closing):
            if found:
                self._need(",", ", or " + closing)
            found.append(self._name("a name or " + closing, numbers=True))
        return tuple(found)

    def _name(self, expected: str, *, numbers: bool = False) -> Name:
        token = self.token
        if token.kind != "name" and not (numbers and token.kind == "number"):
            raise self._wrong(expected)
        self._advance()
        return Name(token.text, token.offset, token.kind == "number")

    def _number(self, expected: str) -> Name:
        if self.token.kind != "number":
            raise self._wrong(expected)
        return self._name(expected, numbers=True)

    def _taken(self, text: str) -> bool:
        if self.token.text != text:
            return False
        self._advance()
        return True

    def _label(self) -> None:
        self._advance()
        self._need(":")

    def _need(self, text: str, expected: str = "") -> None:
        if self.token.text != text:
            raise self._wrong(expected or text)
        self._advance()

    def _advance(self) -> None:
        if self.token.kind != "end":
            self._next += 1
            self.token = self._tokens[self._next]

    def _wrong(self, expected: str, words: object = ()) -> WrongSentence:
        found = self.token.text or "the end of the text"
        near = nearest(found, words) if isinstance(words, (tuple, dict)) else ""
        hint = f"expected {expected}" + (f"; {near}" if near else "")
        return WrongSentence(self.source.diagnostic(self.token.offset, "syntax", f"unexpected {found}", hint))
