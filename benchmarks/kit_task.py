"""The task on which planners are compared: a kit of N kinds of parts, with a camera, an arm, a belt and a tray.

Find the tray (camera, 2 s), place it (arm, 3 s); for each kind find a part (camera, 2 s), pick it (arm, 1 s) and
insert it (arm, 2 s); finish (2 s). Without the assumption that parts are good each is tested (camera, 3 s), and what
fails is dropped and looked for again. Perceiving the next part while this one is placed it takes 3N + 7 s at best.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from planner_reactor.experiments.loop import Loop
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner
from planner_reactor.runtime import Aborted, Host, Scheduler, Signal

DOMAIN = """
atp_assumption AQ() likelihood 0.1 monitor reaction;
atp_goal Kit forall t: Tray(t) => Finished(t);
atp_fact Tray(t0);
atp_fact Free(arm);
atp_rule forall x, i, j: Held(x) @ i and Free(arm) @ j => ITL(i, disjunct, j);
atp_rule forall x, i, j: AQ() @ j => Good(x) @ i;
{contents}

atp_actionschema FindTray <t><>  senses
    duration: 2000;
    effects: Located(t);
endactionschema

atp_actionschema PlaceTray <t><>
    duration: 3000;
    executability: Located(t); Free(arm);
    effects: Ready(t);
endactionschema

atp_actionschema Fill <k, t><>
intervals i1, i2, i3;
    executability: Ready(t) @ i1 and ITL(i1, encompasses, Fill);
                   Free(arm) @ i3 and ITL(i3, [m o si e di fi], Fill);
    effects: Exists x: Instance(k, x) @ i2 and In(t, x) @ i2 and ITL(Fill, meets, i2);
    expansions: Exists x: Instance(k, x) @ i1 and Good(x) @ i1 and In(t, x) @ i2 and Free(arm) @ i3;
endactionschema

atp_actionschema Find <k><x>
    duration: 2000;
    effects: Instance(k, x) and Seen(x);
endactionschema

atp_actionschema Test <x><>  senses
    duration: 3000;
    executability: Seen(x);
    effects: Good(x);
endactionschema

atp_actionschema Pick <x><>
    duration: 1000;
    executability: Seen(x); Free(arm); Good(x);
    effects: Held(x);
endactionschema

atp_actionschema Insert <x, t><>
intervals i1, i2, i3;
    duration: 2000;
    executability: Held(x) @ i1 and ITL(i1, [m o si e di fi], Insert);
                   Ready(t) @ i2 and ITL(i2, encompasses, Insert);
    effects: In(t, x) @ i3 and Free(arm) @ i3 and ITL(Insert, meets, i3);
endactionschema

atp_actionschema Finish <t><>
    duration: 2000;
    executability: Full(t);
    effects: Finished(t);
endactionschema
"""

FILL = DOMAIN[DOMAIN.index("atp_actionschema Fill ") : DOMAIN.index("atp_actionschema Find <k>")]
AHEAD = """atp_actionschema Fetch <k><x>
intervals i2;
    duration: 2000;
    uses: camera;
    effects: Instance(k, x) @ i2 and Seen(x) @ i2 and Good(x) @ i2 and ITL(Fetch, meets, i2);
    expansions: Instance(k, x) @ i2 and Seen(x) @ i2 and Good(x) @ i2;
endactionschema

atp_actionschema Place <x, t><>
intervals i1, i2, i3, i4;
    duration: 3000;
    uses: arm;
    executability: Seen(x) @ i4 and Good(x) @ i4 and ITL(i4, encompasses, Place);
                   Ready(t) @ i1 and ITL(i1, encompasses, Place);
                   Free(arm) @ i3 and ITL(i3, [m o si e di fi], Place);
    effects: In(t, x) @ i2 and ITL(Place, meets, i2);
    expansions: In(t, x) @ i2 and Free(arm) @ i3;
endactionschema

"""
"""Instead of `Fill`: a part can be looked for before there is a tray to put it in."""
USED = {
    FILL: AHEAD,
    "atp_fact Tray(t0);": "atp_resource camera;\natp_resource arm;\natp_fact Tray(t0);",
    "duration: 2000;\n    effects: Located": "duration: 2000;\n    uses: camera;\n    effects: Located",
    "duration: 3000;\n    executability: Located": "duration: 3000;\n    uses: arm;\n    executability: Located",
}
"""What changes in the text when it is said who uses the camera and the arm."""


def domain(kinds: int, *, ahead: bool = False) -> str:
    """The task as a text `*.itl`; `ahead`: with the camera and the arm as resources, so that the camera looks ahead."""
    parts = " and ".join(f"Instance(k{n}, x{n}) @ i and In(t, x{n}) @ i" for n in range(kinds))
    names = ", ".join(f"x{n}" for n in range(kinds))
    text = DOMAIN
    for plain, used in USED.items() if ahead else ():
        text = text.replace(plain, used)
    return text.format(contents=f"atp_rule forall t, {names}, i: {parts} => Full(t) @ i;")


def best(kinds: int) -> float:
    """Seconds that it takes if the camera works while the arm does."""
    return 3.0 * kinds + 7.0


class Cell:
    """The truth: who has the camera and the arm, what is in the tray, when the kit was finished."""

    def __init__(self, kinds: int, *, spoilt: bool) -> None:
        self.kinds = kinds
        self.spoilt = spoilt  # the first part of every odd kind is bad
        self.took: float | None = None
        self.placed: set[str] = set()
        self.tried: set[str] = set()

    def start(self, scheduler: Scheduler) -> None:
        pass

    def strike(self, kind: str, **parameters: Any) -> bool:
        return False

    def ledger(self) -> dict[str, int]:
        return {"placed": len(self.placed)}

    def balanced(self) -> bool:
        return len(self.placed) <= self.kinds

    def finished(self) -> bool:
        return self.took is not None

    def report(self) -> dict[str, object]:
        return {"took_s": self.took}


class _Only:
    """Something that one process has at a time, in the order of asking."""

    def __init__(self, name: str) -> None:
        self.queue: list[object] = []
        self._freed = Signal(f"{name} is free")

    def taken(self, by: object) -> Iterator[Signal]:
        self.queue.append(by)
        while self.queue[0] is not by:
            yield self._freed

    def free(self, by: object) -> None:
        self.queue.remove(by)
        self._freed.fire()


def host(scheduler: Scheduler, cell: Cell) -> Host:
    """The basic processes; camera and arm are had by one at a time."""
    made = Host("kit")
    made.world = cell
    camera, arm = _Only("camera"), _Only("arm")

    def looking(seconds: float) -> Iterator[Any]:
        me = object()
        yield from camera.taken(me)
        yield seconds
        camera.free(me)

    @made.process(window=(2.0, 1e6))
    def FindTray(tray: str) -> Iterator[Any]:
        yield from looking(2.0)

    @made.process(window=(3.0, 1e6))
    def PlaceTray(tray: str) -> Iterator[Any]:
        yield from arm.taken(tray)
        yield 3.0
        arm.free(tray)

    @made.process(results=("part",), window=(2.0, 1e6))
    def Find(kind: str) -> Iterator[Any]:
        yield from looking(2.0)
        bad = cell.spoilt and int(kind[1:]) % 2 == 1 and kind not in cell.tried
        cell.tried.add(kind)
        return f"{kind}{'-bad' if bad else ''}"

    @made.process(window=(3.0, 1e6))
    def Test(part: str) -> Iterator[Any]:
        yield from looking(3.0)
        if part.endswith("-bad"):
            yield 2.0
            raise Aborted("bad")

    @made.process(window=(1.0, 1e6))
    def Pick(part: str) -> Iterator[Any]:
        yield from arm.taken(part)
        yield 1.0

    @made.process(window=(2.0, 2.0))
    def Insert(part: str, tray: str) -> Iterator[float]:
        yield 2.0
        cell.placed.add(part)
        arm.free(part)

    @made.process(window=(2.0, 2.0))
    def Finish(tray: str) -> Iterator[float]:
        yield 2.0
        if len(cell.placed) == cell.kinds:
            cell.took = scheduler.now

    made.assumption("AQ")(lambda: None)
    return made


def executed(kinds: int, *, relaxed: bool = False, ahead: bool = False, seconds_a_step: float = 0.001) -> float:
    """Seconds from the start of planner and reactor, both knowing nothing, to the finished kit."""
    from planner_reactor.experiments.timing import Fixed

    cell = Cell(kinds, spoilt=relaxed)
    planner = Planner(read_domain(domain(kinds, ahead=ahead)), relax=("AQ",) if relaxed else "none")
    loop = Loop(
        planner, lambda scheduler, trace: host(scheduler, cell), planner_time=Fixed(seconds_a_step), keep_trace=False
    )
    loop.run(until=100.0 * kinds + 100.0)
    if cell.took is None or loop.reactor.laws.violations:
        raise RuntimeError(f"the kit was not finished: {planner.impossible} {loop.reactor.laws.violations}")
    return cell.took


if __name__ == "__main__":
    for kinds in (3, 25, 100):
        for ahead in (False, True):
            took, relaxed = executed(kinds, ahead=ahead), executed(kinds, relaxed=True, ahead=ahead)
            share = took / best(kinds)
            print(f"{kinds} kinds, {ahead=}: {took:.3f} s, {share:.3f} of the best, {relaxed:.3f} s relaxed")
