"""The laws of RS, and what is no law: equations over P, Q and R in the text of the language.

`EQUIVALENCES` says under what a law is checked. A law that needs a side condition names it; `CONDITIONS` decides it
for an instance. Docs: docs/language.md, Laws.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import msgspec

from planner_reactor.rs.configurations import World
from planner_reactor.rs.evolves import started
from planner_reactor.rs.parser import parse_process
from planner_reactor.rs.states import Ended
from planner_reactor.rs.terms import Call, Process, calls
from tests.laws.terms import rebuilt

STRONG = "strong"
BINDINGS = "bindings"
TIMED = "timed"
BRANCHING = "branching"
TRACES = "traces"

EQUIVALENCES: Mapping[str, str] = {
    STRONG: "strong bisimilarity, outcomes included",
    BINDINGS: "the same with the results of the whole visible",
    TIMED: "strong bisimilarity of terms with delays, passing time included",
    BRANCHING: "branching bisimilarity that tells divergence, rendezvous at a local port hidden",
    TRACES: "each trace of one side, with the outcome it leads to, is one of the other",
}


class Law(msgspec.Struct, frozen=True):
    """`left = right` for all P, Q, R that fulfil `condition`, in each of the equivalences but those in `not_in`.

    `context` says into what the sides are put: anything, what reads none of their results (`blind`), what is not
    changed by a first silent step (`stable`), or what meets the two writes that P waits for (`driven`). If `guarded`,
    P begins with a step.
    """

    left: str
    right: str
    condition: str = ""
    not_in: tuple[str, ...] = ()
    context: str = "any"
    guarded: bool = False

    @property
    def name(self) -> str:
        return f"{self.left} = {self.right}"

    @property
    def names(self) -> tuple[str, ...]:
        sides = (parse_process(self.left), parse_process(self.right))
        return tuple(sorted({c.name for side in sides for c in calls(side)} & {"P", "Q", "R"}))

    @property
    def equivalences(self) -> tuple[str, ...]:
        return tuple(e for e in EQUIVALENCES if e not in self.not_in)


LAWS = (
    Law("P | Q", "Q | P"),
    Law("P & Q", "Q & P"),
    Law("P # Q", "Q # P", "no two ends in one step"),
    Law("P | (Q | R)", "(P | Q) | R"),
    Law("P & (Q & R)", "(P & Q) & R"),
    Law("P # (Q # R)", "(P # Q) # R"),
    Law("(P ; Q) ; R", "P ; (Q ; R)"),
    Law("(P : Q) : R", "P : (Q : R)"),
    Law("(P ; Q) : R", "P ; (Q : R)"),
    Law("~~P", "P"),
    Law("~(P ; Q)", "P ; ~Q"),
    Law("~(P # Q)", "~P # ~Q", "no two ends in one step"),
    Law("STOP ; P", "P"),
    Law("ABORT ; P", "P"),
    Law("STOP : P", "P"),
    Law("P : STOP", "P"),
    Law("ABORT : P", "ABORT"),
    Law("P | ABORT", "P"),
    Law("P & STOP", "P"),
    Law("P | STOP", "P ; STOP"),
    Law("P & ABORT", "P ; ABORT"),
    Law("~(P | Q)", "~P & ~Q"),
    Law("P # STOP", "STOP"),
    Law("P # NIL", "P"),
    Law("P # ABORT", "ABORT", "P does not stop at once"),
    Law("if P then Q else Q", "P ; Q"),
    Law("if P then STOP else ABORT", "P"),
    Law("if ~P then Q else R", "if P then R else Q"),
    Law("P :; Q", "P : (Q ; (P :; Q))", not_in=(BINDINGS,), context="blind", guarded=True),
    Law("P :: Q", "P : (Q | (P :: Q))", not_in=(BINDINGS,), context="driven"),
    Law("(OUT[h, 1] : P) | (IN[h]<h> : Q)", "P | Q", not_in=(STRONG, BINDINGS, TIMED, TRACES), context="stable"),
)

NON_LAWS = (
    Law("(P : Q) ; R", "P : (Q ; R)"),
    Law("~(P : Q)", "~P : ~Q"),
    Law("~(P | Q)", "~P | ~Q"),
    Law("~(P # Q)", "~P # ~Q"),
    Law("P ; STOP", "P"),
    Law("P | STOP", "P"),
    Law("P & ABORT", "P"),
    Law("P | P", "P"),
    Law("P & P", "P"),
    Law("P # P", "P"),
    Law("P # ABORT", "ABORT"),
    Law("P | Q", "P & Q"),
    Law("P ; (Q | R)", "(P ; Q) | (P ; R)"),
    Law("P : (Q | R)", "(P : Q) | (P : R)"),
    Law("P ; (Q # R)", "(P ; Q) # (P ; R)"),
    Law("P : (Q # R)", "(P : Q) # (P : R)"),
    Law("(P | Q) ; R", "(P ; R) | (Q ; R)"),
    Law("(P # Q) : R", "(P : R) # (Q : R)"),
    Law("P # (Q | R)", "(P # Q) | (P # R)"),
    Law("P | (Q # R)", "(P | Q) # (P | R)"),
    Law("P ; Q", "Q ; P"),
    Law("P : Q", "Q : P"),
    Law("~P : Q", "~(P : Q)"),
    Law("if P then Q else R", "~(P : Q) : R"),
)

Condition = Callable[[Mapping[str, Process], World], bool]


def _apart(instance: Mapping[str, Process], world: World) -> bool:
    """No two parts end in one step: they do not meet at a port, and no two have ended before the first step.

    Two delays that end at the same instant are two steps.
    """
    parts = list(instance.values())
    meeting = sum(any(call.name in ("IN", "OUT") for call in calls(p)) for p in parts)
    return meeting < 2 and sum(_ended(p, world) is not None for p in parts) < 2


def _ended(process: Process, world: World) -> Ended | None:
    """How a process has ended before any step, if it has."""
    term = started(process, world).roots[0][1]
    return term if isinstance(term, Ended) else None


def _not_stopped(instance: Mapping[str, Process], world: World) -> bool:
    ended = _ended(instance["P"], world)
    return ended is None or not ended.ok


CONDITIONS: Mapping[str, Condition] = {
    "no two ends in one step": _apart,
    "P does not stop at once": _not_stopped,
}


def filled(side: Process, instance: Mapping[str, Process]) -> Process:
    """One side of a law with terms in place of P, Q and R."""
    return rebuilt(side, lambda call: instance.get(call.name, Call(call.name, call.arguments, call.results)))
