"""One case of the matrix: the reactor is lost at every step of an adaptation, or its link is cut there.

A step is every event of the reactor's trace and every moment of its disk, from the adaptation's arrival until all is
quiet. What a crash leaves of a reactor is its disk: so the adaptation runs once, the disk is remembered as it stands at
each step, and a reactor is started on whatever a crash there would have left. The process is killed: all that was
written is there. The power goes: of what was not synced some beginning is there. Each reactor that comes back must have
the old structure or the new one, what the planner had been told by then, nothing inhibited, and must act.

The link is cut at every frame that one end sends, and mended long after the adaptation is over.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

from planner_reactor.link.channels import PerceptionChannel
from planner_reactor.link.codec import decode, encode
from planner_reactor.link.messages import Adaptation, Perception
from planner_reactor.link.session import Session, Timing
from planner_reactor.reactor.committed import Committed
from planner_reactor.reactor.journal import Journal, State
from planner_reactor.reactor.reactor import Reactor
from planner_reactor.runtime import Host, Scheduler, VirtualClock
from planner_reactor.simulation.disks import Mount, SimulatedDisk
from planner_reactor.trace import Trace
from tests.crashes.shapes import ARRIVES, SECONDS, Case, before, change, situations

OUTCOMES = {"adaptation_applied": "new", "adaptation_refused": "old", "adaptation_timed_out": "old"}
QUIET = ARRIVES + 8 * SECONDS
"""Seconds after which every adaptation of a case is over, and old and new have acted."""

ROUND = 7 * SECONDS + 0.1
"""Seconds in which a reactor that comes back has served every situation once."""

TIMING = Timing(resend=0.5, beat=2.0, lease=5.0)
TURN, DELAY, CUT = 0.1, 0.01, 6.0
"""Seconds between two turns of an end, that a frame takes, and for which the link is cut."""

OTHER = {"planner": "reactor", "reactor": "planner"}


class Sight(NamedTuple):
    """What a crash at this step would leave."""

    step: str
    durable: bytes
    pending: bytes
    told: str  # what the planner has been told: old, new, or "" if nothing yet


class Finding(NamedTuple):
    """What came of a case: how many crashes and cuts were tried, and what was wrong."""

    steps: int
    crashes: int
    powers: int
    cuts: int
    recovered: int  # reactors that were started anew
    wrong: list[str]


class Rig:
    """A reactor on a disk, whose deeds are known by the label of the reaction that did them."""

    def __init__(self, disk: SimulatedDisk, at: Callable[[str], object] = lambda moment: None) -> None:
        self.did: set[int] = set()
        host = Host("matrix")

        @host.process(window=(0.0, 10.0))
        def Do(label: float, seconds: float) -> Iterator[float]:
            self.did.add(int(label))
            yield seconds

        self.scheduler = Scheduler(VirtualClock(), seed=1)
        self.trace = Trace(lambda: self.scheduler.now, keep=False)
        journal = Journal(Mount(disk, at))
        self.reactor = Reactor(
            self.scheduler, host=host, perceptions=PerceptionChannel(), trace=self.trace, journal=journal
        )
        self.reactor.start()

    def run(self, until: float) -> None:
        self.reactor.executer.run(until=until)


class Structures(NamedTuple):
    """The old structure and the new one."""

    old: Committed
    new: Committed

    def which(self, found: Committed) -> str:
        for name, wanted in self._asdict().items():
            if (found.clauses, found.versions, found.rests_on) == (wanted.clauses, wanted.versions, wanted.rests_on):
                return str(name)
        return "half"


def looked_at(case: Case, *, cuts: bool) -> Finding:
    """Try everything on one case."""
    first, second = before(case.forest), change(case)
    structures = _structures(first, second)
    sights, outcome = _watched(first, second)
    wrong = [f"{case}: comes to {outcome}"] if outcome not in _expected(case) else []
    counts, recovered = {"crash": 0, "power": 0}, dict[bytes, tuple[str, str]]()
    states: list[tuple[State, tuple[str, str]]] = []
    for sight in sights:
        for kind, image in _images(sight):
            counts[kind] += 1
            if image not in recovered:
                recovered[image] = _recovered(image, structures, states)
            which, problem = recovered[image]
            if which == "half" or (sight.told and which != sight.told) or problem:
                told = f", told {sight.told}" if sight.told else ""
                wrong.append(f"{case}: {kind} at {sight.step}{told}: {which} {problem}")
    tried = 0
    for problem in _cuts(first, second, structures, _expected(case)) if cuts else ():
        tried += 1
        wrong += [f"{case}: {problem}"] if problem else []
    return Finding(len(sights), counts["crash"], counts["power"], tried, len(states), wrong)


def _expected(case: Case) -> tuple[str, ...]:
    """What the adaptation may come to when nothing strikes."""
    tops = [what for what, _, _, top in situations(case.forest) if top]
    if case.way in ("versions", "wait") and "d" in tops:
        return ("old",)  # a root goes: refused
    return ("old", "new") if case.way == "late" else ("new",)


def _structures(first: Adaptation, second: Adaptation) -> Structures:
    """As the journal says that they are, by nothing but the records."""
    old = Committed().begun(first).after(first)
    return Structures(old, old.begun(second).after(second))


def _watched(first: Adaptation, second: Adaptation) -> tuple[list[Sight], str]:
    """Every step of the adaptation, and what it came to."""
    disk, sights, told = SimulatedDisk(), list[Sight](), [""]
    watching = [False]

    def seen(step: str) -> None:
        if watching[0]:
            for perception in rig.reactor.perceptions.take():
                if perception.subject == "2":
                    told[0] = OUTCOMES.get(perception.kind, told[0])
            sights.append(Sight(step, disk.durable, disk.pending, told[0]))

    rig = Rig(disk, seen)
    rig.reactor.receive(first)
    rig.run(ARRIVES)
    rig.reactor.perceptions.take()
    rig.trace.sinks.append(lambda event: seen(event.kind))
    watching[0] = True
    rig.reactor.receive(second)
    rig.run(QUIET)
    seen("quiet")
    broken = "; ".join(map(str, rig.reactor.laws.violations))
    return sights, broken or told[0]


def _images(sight: Sight) -> Iterator[tuple[str, bytes]]:
    yield "crash", sight.durable + sight.pending
    for kept in sorted({0, len(sight.pending) // 2, len(sight.pending)}):
        yield "power", sight.durable + sight.pending[:kept]


def _recovered(
    image: bytes, structures: Structures, states: list[tuple[State, tuple[str, str]]]
) -> tuple[str, str]:
    """Which structure a reactor that is started on this has, and what is wrong with it. Same state, same reactor."""
    journal = Journal(SimulatedDisk(image))
    if (recovery := journal.recover()).damaged:
        return "half", "damage"
    for state, found in states:
        if state == recovery.state:
            return found
    found = _acts(SimulatedDisk(image), structures)
    states.append((recovery.state, found))
    return found


def _acts(disk: SimulatedDisk, structures: Structures) -> tuple[str, str]:
    rig = Rig(disk)
    reactor = rig.reactor
    which = structures.which(reactor.journal.state.committed)
    if which == "half":
        return which, str(sorted(reactor.journal.state.committed.clauses))
    rig.run(ROUND)
    return which, _strange(rig, getattr(structures, which))


def _strange(rig: Rig, wanted: Committed) -> str:
    """What is not as it must be with this structure."""
    reactor, labels = rig.reactor, set(wanted.clauses)
    if set(reactor.reactions) != labels:
        return f"runs {sorted(reactor.reactions)}"
    if held := [s.name for s in reactor.situations.held]:
        return f"{held} are held back"
    serving = {label for label, reaction in reactor.reactions.items() if reaction.situation is not None}
    if rig.did != serving:
        return f"acts by {sorted(rig.did)}, not by {sorted(serving)}"
    return "; ".join(map(str, reactor.laws.violations))


# -- the link


class Linked:
    """A planner's end and a reactor on a link, which is cut as the frame with a certain number leaves."""

    def __init__(self, first: Adaptation, cut_at: int | None) -> None:
        self.rig = Rig(SimulatedDisk())
        self.scheduler = self.rig.scheduler
        self.ends = {name: Session(1, timing=TIMING) for name in ("planner", "reactor")}
        self.frames, self.cut_at, self.open, self.counting = 0, cut_at, True, False
        self.heard: list[Perception] = []
        self.rig.reactor.receive(first)
        self.rig.run(SECONDS / 2)
        self.rig.reactor.perceptions.take()
        self.rig.did.clear()
        self._turn("planner")
        self._turn("reactor")

    def _turn(self, name: str) -> None:
        """An end says what is due, now and from now on."""
        if name == "reactor":
            for perception in self.rig.reactor.perceptions.take():
                self.ends[name].send(encode(perception))
        for frame in self.ends[name].due(self.scheduler.now):
            if self.counting:
                self.frames += 1
                if self.frames == self.cut_at:
                    self.open = False
                    self.scheduler.call_after(CUT, self._mend)
            if self.open:
                self.scheduler.call_after(DELAY, partial(self._comes, OTHER[name], frame))
        self.scheduler.call_after(TURN, lambda: self._turn(name))

    def _mend(self) -> None:
        self.open = True

    def _comes(self, name: str, frame: bytes) -> None:
        for message in self.ends[name].receive(frame, self.scheduler.now):
            match decode(message):
                case Adaptation() as adaptation:
                    self.rig.reactor.receive(adaptation)
                case Perception() as perception:
                    self.heard.append(perception)

    def send(self, adaptation: Adaptation) -> None:
        self.counting = True
        self.ends["planner"].send(encode(adaptation))


def _cuts(
    first: Adaptation, second: Adaptation, structures: Structures, expected: tuple[str, ...]
) -> Iterator[str]:
    """What is wrong if the link is cut at the first frame, the second, … that is sent until all is quiet."""
    number = 0
    while True:
        number += 1
        linked = Linked(first, number)
        linked.rig.run(ARRIVES)
        linked.send(second)
        linked.rig.run(QUIET)
        if linked.frames < number:
            return
        linked.rig.run(QUIET + CUT + TIMING.beat + ROUND)
        problem = _cut_wrong(linked, structures, expected)
        yield problem and f"cut at frame {number}: {problem}"


def _cut_wrong(linked: Linked, structures: Structures, expected: tuple[str, ...]) -> str:
    reactor, heard = linked.rig.reactor, linked.heard
    outcomes = [OUTCOMES[p.kind] for p in heard if p.kind in OUTCOMES]
    if len(outcomes) != 1 or outcomes[0] not in expected:
        return f"the planner hears {outcomes}"
    if [p.number for p in heard] != list(range(heard[0].number, heard[0].number + len(heard))):
        return f"perceptions {[p.number for p in heard]}"
    if reactor.counts["applied"] != 1 + (outcomes == ["new"]):
        return f"applied {reactor.counts['applied'] - 1} times"
    linked.rig.did.clear()
    linked.rig.run(linked.scheduler.now + ROUND)
    return _strange(linked.rig, getattr(structures, outcomes[0]))
