"""No adaptation leaves the planner before it is verified (R §5.5): consistent, safe, bounded, atomic, local.

A `Gate` stands between what the planner writes and what it sends. It keeps the reactions that the reactor will have, as
far as the planner knows, and asks `analysis.adaptations` about each change of them. What does not hold is not sent: the
planner takes it as refused, with the reason. What adds only situations that never were needs no look, so the first
adaptation goes out at once; texts are read when a later one needs them. What is of a shape that came before is known
at once; another is looked at a few states at a time, and held meanwhile.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from importlib import import_module
from typing import TYPE_CHECKING, TypeAlias

from msgspec.structs import replace

from planner_reactor.analysis.looking import Looking, finish
from planner_reactor.analysis.permission import Environment, Verdict
from planner_reactor.errors import RSError
from planner_reactor.link.messages import Adaptation, Perception
from planner_reactor.link.surgeries import surgery
from planner_reactor.planner.steps import Step
from planner_reactor.planner.thinking import advance

if TYPE_CHECKING:  # loaded when they are needed: not for the first adaptation
    from planner_reactor.analysis.adaptations import Verifier
    from planner_reactor.analysis.forms import Forms, Known
    from planner_reactor.analysis.standing import Standing

NOTHING_WAS = Verdict(bound_s=0.0)
"""Of what adds to nothing: nobody can be in its way, and it waits for nobody."""


PARTS = tuple(
    f"planner_reactor.{name}"
    for name in ("rs.states", "rs.vocabulary", "rs.configurations", "rs.leaves", "rs.arguments", "rs.parser",
                 "analysis.forms", "analysis.explore", "analysis.protocols", "analysis.adaptations")
)  # fmt: skip
"""What looking needs, in the order in which it is loaded: a millisecond or two each."""

STATES = 4
"""So many states are looked at in one step of the planner: about two milliseconds."""

LONG = 2_000
"""To write so many characters, and to look at them, are steps of their own."""

Verdicts: TypeAlias = list[tuple[Adaptation, Verdict]]


class Gate:
    """Verifies the adaptations of one planner, in the order in which they are issued."""

    def __init__(self, environment: Environment | None = None, *, mode: str = "drain") -> None:
        self._environment = environment
        self._mode = mode
        self._parts = iter(PARTS)
        self._patient = mode == "wait"  # what may never be granted is given up at its deadline, and says so
        self.withheld: dict[int, Verdict] = {}  # what was not sent, by the adaptation's id
        self._known: set[str] = set()  # situations that an adaptation has named
        self._unread: list[Adaptation] = []
        self._under_way: dict[int, tuple[Adaptation, tuple[Known, ...]]] = {}  # with what it removes
        self._held: tuple[Step, Looking[Verdicts]] | None = None

    def meet(self, environment: Environment) -> None:
        """What is known of the basic processes from now on: bounds are numbers, and what has none is withheld."""
        self._environment = environment
        if "verifier" in self.__dict__:
            self.verifier.environment = environment

    @cached_property
    def verifier(self) -> Verifier:
        """What looks at adaptations, and remembers the shapes that it has seen."""
        from planner_reactor.analysis.adaptations import Verifier

        return Verifier(self._environment, mode=self._mode, proven=True)

    @cached_property
    def _forms(self) -> Forms:
        from planner_reactor.analysis.forms import Forms

        return Forms()

    @cached_property
    def _standing(self) -> Standing:
        from planner_reactor.analysis.standing import Standing

        return Standing()

    def _loading(self) -> Looking[None]:
        """Load what looking needs, one module in a step."""
        for name in self._parts:
            import_module(name)
            for _ in range(STATES):
                yield

    def examine(self, adaptation: Adaptation) -> Verdict:
        """May it be sent? If so it is taken to be under way."""
        return finish(self.examining(adaptation))

    def examining(self, adaptation: Adaptation) -> Looking[Verdict]:
        """The same, with a pause after every state that is looked at: none if the shape is known."""
        named = {change.situation for change in adaptation.changes}
        fresh = all(change.fresh for change in adaptation.changes) and not named & self._known
        if fresh and not adaptation.kills and not adaptation.removed:
            self._unread.append(adaptation)
            self._known |= named
            self._under_way[adaptation.id] = adaptation, ()
            return NOTHING_WAS
        yield from self._loading()
        yield from self._reading()
        try:
            new = yield from self._reactions(adaptation)
            yield
        except RSError as problem:
            return self._withhold(adaptation, Verdict(safe=False, why=str(problem)))
        seen = None
        while seen != (now := (self._standing, self._standing.changes)):  # what stands may change meanwhile
            seen = now
            verdict = yield from self.verifier.looking(self._standing, new, surgery(adaptation))
        if self._patient and verdict.cycle:  # overtaken again and again, but not for ever by itself
            verdict = replace(verdict, bounded=True)
        if not verdict.holds:
            return self._withhold(adaptation, verdict)
        self._known |= named
        gone = tuple(r for r in map(self._standing.remove, adaptation.kills) if r is not None)
        self._under_way[adaptation.id] = adaptation, gone
        for reaction in new:
            self._standing.add(reaction)
        return verdict

    def stand(self, clauses: Iterable[str]) -> None:
        """Another planner's reactions stand in the reactor."""
        self.__dict__.pop("_standing", None)
        self._known = set()
        for reaction in self._forms.read("\n".join(clauses), file="<standing>"):
            self._standing.add(reaction)
            self._known |= set() if reaction.situation is None else {reaction.situation}
        self._unread.clear()
        self._under_way.clear()
        self._held = None

    # ------------------------------------------------------------------------------------- held until the verdict

    def look(self, step: Step) -> tuple[Step, Verdicts] | None:
        """Look at what a step issues: the step with the verdicts, or None if it is held, as that takes longer."""
        self._held = step, self._all_of(step.adaptations)
        if sum(len(adaptation.definitions) for adaptation in step.adaptations) > LONG:
            return None
        return self.look_on()

    @property
    def held(self) -> Step | None:
        """The step that is held until its verdicts are known."""
        return None if self._held is None else self._held[0]

    def waiting(self) -> Step:
        """What the planner does meanwhile: it looks."""
        assert self.held is not None
        return Step("verify", self.held.situation, purpose=f"verify: {self.held.purpose}")

    def look_on(self) -> tuple[Step, Verdicts] | None:
        """Go on with what is held, for at most so many states."""
        assert self._held is not None
        step, work = self._held
        verdicts, _ = advance(work, STATES)
        if verdicts is None:
            return None
        self._held = None
        return step, verdicts

    def _all_of(self, adaptations: tuple[Adaptation, ...]) -> Looking[Verdicts]:
        found = []
        for adaptation in adaptations:
            found.append((adaptation, (yield from self.examining(adaptation))))
        return found

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
                self._standing.remove(label)
            for reaction in gone:
                self._standing.add(reaction)

    def _withhold(self, adaptation: Adaptation, verdict: Verdict) -> Verdict:
        self.withheld[adaptation.id] = verdict
        return verdict

    def _read(self) -> None:
        finish(self._reading())

    def _reading(self) -> Looking[None]:
        """Read what was not looked at, with a pause after every adaptation."""
        while self._unread:
            for reaction in (yield from self._reactions(self._unread[0])):
                self._standing.add(reaction)
            del self._unread[0]
            yield

    def _reactions(self, adaptation: Adaptation) -> Looking[list[Known]]:
        """The reactions that it adds, in the order of its adds."""
        read = yield from self._forms.reading(adaptation.definitions, file=f"<adaptation {adaptation.id}>")
        found = {reaction.label: reaction for reaction in read}
        return [found[label] for label in adaptation.adds if label in found]


def without_unsound(step: Step, verdicts: Verdicts) -> tuple[Step, dict[int, str]]:
    """The step without the adaptations that do not hold; and of these, by their numbers, why."""
    why = {adaptation.id: reason(adaptation, verdict) for adaptation, verdict in verdicts if not verdict.holds}
    sound = tuple(adaptation for adaptation, verdict in verdicts if verdict.holds)
    return (replace(step, adaptations=sound, withheld=list(why.values())[-1]) if why else step), why


def reason(adaptation: Adaptation, verdict: Verdict) -> str:
    """Why an adaptation is withheld, with the steps that show it."""
    from planner_reactor.analysis.labels import show_label

    situations = ", ".join(dict.fromkeys([*(c.situation for c in adaptation.changes), *adaptation.removed]))
    broken = [law for law in ("safe", "consistent", "atomic", "local", "bounded") if not getattr(verdict, law)]
    steps = "; ".join(show_label(label) for label in verdict.counterexample)
    return f"{situations or 'monitors'}: not {', '.join(broken)}: {verdict.why}" + (f" ({steps})" if steps else "")
