"""No adaptation leaves the planner before it is verified (R §5.5): consistent, safe, bounded, atomic, local.

A `Gate` stands between what the planner writes and what it sends. It keeps the reactions that the reactor will have, as
far as the planner knows, and asks `analysis.adaptations` about each change of them. What does not hold is not sent: the
planner takes it as refused, with the reason. What adds only situations that never were needs no look, so the first
adaptation goes out at once; texts are read when a later one needs them.
"""

from __future__ import annotations

from msgspec.structs import replace

from planner_reactor.analysis.adaptations import Environment, Verdict, Verifier
from planner_reactor.analysis.labels import show_label
from planner_reactor.errors import RSError
from planner_reactor.link.messages import Adaptation, Perception
from planner_reactor.link.surgeries import surgery
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.reactions import Reaction, reaction_of

NOTHING_WAS = Verdict(bound_s=0.0)
"""Of what adds to nothing: nobody can be in its way, and it waits for nobody."""


class Gate:
    """Verifies the adaptations of one planner, in the order in which they are issued."""

    def __init__(self, environment: Environment | None = None, *, mode: str = "drain") -> None:
        self.verifier = Verifier(environment, mode=mode)
        self._patient = mode == "wait"  # what may never be granted is given up at its deadline, and says so
        self.withheld: dict[int, Verdict] = {}  # what was not sent, by the adaptation's id
        self._known: set[str] = set()  # situations that an adaptation has named
        self._unread: list[Adaptation] = []
        self._reactions: dict[int, Reaction] = {}
        self._under_way: dict[int, tuple[Adaptation, tuple[Reaction, ...]]] = {}  # with what it removes

    def meet(self, environment: Environment) -> None:
        """What is known of the basic processes from now on: bounds are numbers, and what has none is withheld."""
        self.verifier.environment = environment

    def examine(self, adaptation: Adaptation) -> Verdict:
        """May it be sent? If so it is taken to be under way."""
        named = {change.situation for change in adaptation.changes}
        fresh = all(change.fresh for change in adaptation.changes) and not named & self._known
        if fresh and not adaptation.kills and not adaptation.removed:
            self._unread.append(adaptation)
            self._known |= named
            self._under_way[adaptation.id] = adaptation, ()
            return NOTHING_WAS
        self._read()
        try:
            new = _reactions(adaptation)
        except RSError as problem:
            return self._withhold(adaptation, Verdict(safe=False, why=str(problem)))
        verdict = self.verifier.verify(self._reactions.values(), new, surgery(adaptation))
        if self._patient:
            verdict = replace(verdict, bounded=True)
        if not verdict.holds:
            return self._withhold(adaptation, verdict)
        self._known |= named
        gone = tuple(self._reactions.pop(n) for n in adaptation.kills if n in self._reactions)
        self._under_way[adaptation.id] = adaptation, gone
        self._reactions |= {reaction.label: reaction for reaction in new}
        return verdict

    def perceive(self, perception: Perception) -> None:
        """What became of those that were sent."""
        match perception.kind:
            case "adaptation_applied":
                self._under_way.pop(int(perception.subject), None)
            case "adaptation_refused" | "adaptation_timed_out":
                self._not_applied(int(perception.subject))

    def _not_applied(self, number: int) -> None:
        self._read()
        if number in self._under_way:
            adaptation, gone = self._under_way.pop(number)
            for label in adaptation.adds:
                self._reactions.pop(label, None)
            self._reactions |= {reaction.label: reaction for reaction in gone}

    def _withhold(self, adaptation: Adaptation, verdict: Verdict) -> Verdict:
        self.withheld[adaptation.id] = verdict
        return verdict

    def _read(self) -> None:
        for adaptation in self._unread:
            self._reactions |= {reaction.label: reaction for reaction in _reactions(adaptation)}
        self._unread.clear()


def _reactions(adaptation: Adaptation) -> list[Reaction]:
    """The reactions that it adds, in the order of its adds."""
    schemas = parse_program(adaptation.definitions, file=f"<adaptation {adaptation.id}>").schemas
    found = {r.label: r for r in map(reaction_of, schemas) if r is not None}
    return [found[label] for label in adaptation.adds if label in found]


def reason(adaptation: Adaptation, verdict: Verdict) -> str:
    """Why an adaptation is withheld, with the steps that show it."""
    situations = ", ".join(dict.fromkeys([*(c.situation for c in adaptation.changes), *adaptation.removed]))
    broken = [law for law in ("safe", "consistent", "atomic", "local", "bounded") if not getattr(verdict, law)]
    steps = "; ".join(show_label(label) for label in verdict.counterexample)
    return f"{situations or 'monitors'}: not {', '.join(broken)}: {verdict.why}" + (f" ({steps})" if steps else "")

