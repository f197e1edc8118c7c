"""How each kind of fault strikes a stage, and which row of the fault table it counts for (docs/reliability.md)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from planner_reactor.link.messages import Adaptation
from planner_reactor.simulation.cases import Fault, Kind
from planner_reactor.simulation.lives import Crash

if TYPE_CHECKING:
    from planner_reactor.simulation.stage import Stage

DAY = 86_400.0
AFTER_COMMIT = ("synced", "removed", "retired", "renewed", "added", "uninhibited")
UNSEEN = ("jump", "nothing")
"""What must not be seen in the trace (law 16)."""

OUTSIDE_REACTOR = ("told",)


def strike(stage: Stage, fault: Fault) -> None:
    """Let it happen now; what is raised unwinds the reactor."""
    if fault.kind not in UNSEEN and (fault.point is not None or stage.under_way):
        stage.inside[f"{fault.kind} at {fault.point or 'any time'}"] += 1
    stage.rows[f"struck: {fault.kind}"] += 1
    if fault.kind not in UNSEEN:
        stage.trace.record("struck", fault=fault.kind, point=fault.point)
    STRIKES[fault.kind](stage, fault)


def _crash(stage: Stage, fault: Fault) -> None:
    if stage.side is None:
        return
    power = fault.kind == "power"
    if any(t.state == "committed" for t in stage.side.reactor.transactions.under_way):
        stage.rows["2 crash between KILL and ADD"] += 1
    if fault.point is not None and fault.point not in OUTSIDE_REACTOR:
        raise Crash(power=power)
    stage.down(power=power)


def _storm(stage: Stage, fault: Fault) -> None:
    """The process ends again and again, as soon as it has begun."""
    stage.rows["32 restart storms"] += 1

    def again(left: int) -> None:
        if not stage.calm and left:
            stage.down(power=False)
            stage.scheduler.call_after(0.3, lambda: again(left - 1))

    again(5)


def _cut(stage: Stage, fault: Fault) -> None:
    ends = {"silent_reactor": ("reactor",), "silent_planner": ("planner",)}.get(fault.kind, ("reactor", "planner"))
    for end in ends:
        stage.wire.open[end] = False  # type: ignore[index]  # the names of ends

    def mend() -> None:
        if len(ends) == 1 and stage.planner is not None and stage.side is not None and stage.side.session is not None:
            listener = stage.planner.session if ends == ("reactor",) else stage.side.session
            stage.rows["5 half-open: the silent end is absent"] += not listener.present(stage.scheduler.now)
        for end in ends:
            stage.wire.open[end] = True  # type: ignore[index]

    stage.scheduler.call_after(fault.seconds, mend)


def _planner(stage: Stage, fault: Fault) -> None:
    if stage.planner is not None:
        stage.rows["1 planner ends with adaptations unanswered"] += bool(stage.book.pending)
        stage.end_planner()


def _leader(stage: Stage, fault: Fault) -> None:
    """Another planner takes over; the first does not know, and goes on talking for a while."""
    if (old := stage.planner) is None:
        return
    stage.book.take_over()
    stage.end_planner()

    def talks(left: int) -> None:
        for frame in old.session.due(stage.scheduler.now):
            stage.wire.carry("planner", frame)
            stage.rows["7 frames of a planner whose time is over"] += 1
        if left and not stage.calm:
            stage.scheduler.call_after(1.0, lambda: talks(left - 1))

    stage.scheduler.call_after(fault.seconds, lambda: talks(10))


def _stale(stage: Stage, fault: Fault) -> None:
    """An adaptation that would be sound, from a planner whose time is over, by a door of its own."""
    if stage.side is None or stage.side.session is None or stage.side.reactor.halted:
        return
    epoch = stage.side.reactor.journal.state.committed.epoch
    if epoch:
        late = Adaptation(id=10**6, epoch=epoch - 1, definitions=f"P[{10**6}] = Delay[1] :; Beat", adds=(10**6,))
        stage.side.reactor.receive(late)
        stage.rows["7 adaptations of a planner whose time is over"] += 1


def _replay(stage: Stage, fault: Fault) -> None:
    """Somebody sends again what was sent before, as it was or under another id with the same content."""
    answered = [a for key, a in stage.book.issued.items() if key not in stage.book.pending]
    if stage.side is None or stage.side.session is None or not answered:
        return
    stage.side.reactor.receive(stage.draw.choice(answered[-20:]))
    stage.side.reactor.receive(stage.draw.choice(answered))
    stage.side.session.receive(stage.draw.randbytes(40), stage.scheduler.now)
    stage.rows["21 adaptations replayed"] += 2


def _disk(stage: Stage, fault: Fault) -> None:
    if fault.kind == "full":
        stage.disk.fill(spare=stage.draw.choice((0, 9, 200)))
    else:
        stage.disk.sync_fails = True
    done = stage.watch.totals["beats"]
    before = stage.disk.refused

    def mend() -> None:
        stage.rows["27 writes refused by the disk"] += stage.disk.refused - before
        stage.rows["27 and the reactor went on"] += stage.watch.totals["beats"] > done
        stage.disk.mend()

    stage.scheduler.call_after(fault.seconds, mend)


def _halt(stage: Stage, fault: Fault) -> None:
    """The stop button, pressed by somebody else than the reactor; the reset comes later."""

    def press() -> None:
        if stage.side is not None and stage.side.session is not None and not stage.side.reactor.halted:
            stage.side.reactor.halt()
            stage.watch.pause()
            stage.rows["halts"] += 1
            stage.scheduler.call_after(max(1.0, fault.seconds), stage.release)

    stage.scheduler.soon(press)


def _sensor(stage: Stage, fault: Fault) -> None:
    shop, name = stage.shop, fault.what or "A0"
    if fault.kind == "unknown":
        shop.flags[name] = None
    elif fault.kind == "stuck":
        shop.stuck[name] = bool(stage.draw.random() < 0.5)
    else:
        shop.noise = 0.2

    def over() -> None:
        shop.flags[name], shop.noise = True, 0.0
        shop.stuck.pop(name, None)
        stage.rows["25 sensors that failed"] += 1

    stage.scheduler.call_after(fault.seconds + 5.0, over)


def _flap(stage: Stage, fault: Fault) -> None:
    """A square wave of ten a second, and it holds in the end."""
    shop, name = stage.shop, fault.what or "A0"

    def turn(left: int) -> None:
        shop.flags[name] = left % 2 == 0
        stage.rows["26 times that an assumption flapped"] += 1
        if left and not stage.calm:
            stage.scheduler.call_after(0.1, lambda: turn(left - 1))
        else:
            shop.flags[name] = True

    turn(40)


def _deeds(stage: Stage, fault: Fault) -> None:
    if fault.kind == "raise":
        stage.shop.raising += 3
    else:
        stage.shop.hanging += 1


def _drive(stage: Stage, fault: Fault) -> None:
    stage.shop.link_drive(False)
    stage.scheduler.call_after(fault.seconds, lambda: stage.shop.link_drive(True))


def _jump(stage: Stage, fault: Fault) -> None:
    stage.clock.offset += stage.scheduler.random("clock").choice((-DAY, DAY))
    stage.rows["24 jumps of the time of day"] += 1


def _crowd(stage: Stage, fault: Fault) -> None:
    if stage.side is None or stage.planner is None or (crowd := stage.brain.crowd()) is None:
        return
    stage.send(crowd)

    def disperse() -> None:
        if stage.side is not None:
            live = len(stage.side.reactor.situations.instances)
            stage.rows["29 crowds of 500 or more"] += live >= 500
        if (away := stage.brain.disperse()) is not None:
            stage.send(away)
        elif stage.brain.book.nodes.get("s7") is not None:
            stage.scheduler.call_after(5.0, disperse)

    stage.scheduler.call_after(fault.seconds, disperse)


def _world(stage: Stage, fault: Fault) -> None:
    """A fault of the world's own, now or as soon as it can strike."""
    world = stage.shop.world

    def attempt() -> bool:
        return bool(world.strike(fault.what))

    if not attempt():
        world.attempts.append(attempt)


STRIKES: Mapping[Kind, Callable[[Stage, Fault], object]] = {
    "crash": _crash, "power": _crash, "storm": _storm, "cut": _cut, "silent_reactor": _cut, "silent_planner": _cut,
    "planner": _planner, "leader": _leader, "stale": _stale, "full": _disk, "sync": _disk, "halt": _halt,
    "flap": _flap, "unknown": _sensor, "stuck": _sensor, "noise": _sensor, "raise": _deeds, "hang": _deeds,
    "drive": _drive, "jump": _jump, "crowd": _crowd, "replay": _replay, "world": _world,
    "nothing": lambda stage, fault: None,
}  # fmt: skip
