"""How each kind of fault strikes a stage, and which row of the fault table it counts for (docs/reliability.md)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import msgspec

from planner_reactor.errors import InputError
from planner_reactor.link.messages import Adaptation
from planner_reactor.link.session import VERSION, Frame
from planner_reactor.simulation.cases import HELD, Fault, Kind
from planner_reactor.simulation.improviser import CROWD
from planner_reactor.simulation.lives import Crash
from planner_reactor.simulation.sensors import NOTICED

if TYPE_CHECKING:
    from planner_reactor.simulation.stage import Stage

DAY = 86_400.0
UNSEEN = ("jump", "nothing")
"""What must not be seen in the trace (law 16)."""

OUTSIDE_REACTOR = ("told",)


def strike(stage: Stage, fault: Fault) -> None:
    """Let it happen now; what is raised unwinds the reactor."""
    if fault.kind not in UNSEEN and stage.is_inside(fault):
        stage.inside[f"{fault.kind} at {fault.point or 'any time'}"] += 1
    stage.rows[f"struck: {fault.kind}"] += 1
    if fault.kind not in UNSEEN:
        stage.trace.record("struck", fault=fault.kind, point=fault.point)
    STRIKES[fault.kind](stage, fault)


def _crash(stage: Stage, fault: Fault) -> None:
    if stage.side is None:
        return
    if fault.what == HELD:
        stage.when_holding(lambda: stage.down(power=False))
        return
    power = fault.kind == "power"
    stage.rows["2 crashes between KILL and ADD"] += stage.counting.half
    if fault.point is not None and fault.point not in OUTSIDE_REACTOR:
        raise Crash(power=power)
    stage.down(power=power)


def _storm(stage: Stage, fault: Fault) -> None:
    """The process ends again and again, as soon as it has begun."""

    def again(left: int) -> None:
        if not stage.calm and left:
            stage.down(power=False)
            stage.begin_reactor()
            stage.scheduler.call_after(0.3, lambda: again(left - 1))

    again(6)


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
        if stage.side is not None:
            keys = {(t.adaptation.epoch, t.adaptation.id) for t in stage.side.reactor.transactions.under_way}
            mine = not keys.isdisjoint(stage.book.pending)
            stage.rows["1 planners killed while their adaptation was under way"] += mine
        stage.end_planner()


def _leader(stage: Stage, fault: Fault) -> None:
    """Another planner takes over; the first does not know, and goes on talking for a while."""
    if (old := stage.planner) is None:
        return
    stage.take_over()
    stage.end_planner()

    def talks(left: int) -> None:
        for frame in old.session.due(stage.scheduler.now):
            stage.wire.carry("planner", frame, over=True)
        if left and not stage.calm:
            stage.scheduler.call_after(1.0, lambda: talks(left - 1))

    stage.scheduler.call_after(fault.seconds, lambda: talks(10))


def _stale(stage: Stage, fault: Fault) -> None:
    """An adaptation that would be sound, of a planner whose time is over, by the session that is open."""
    if stage.side is not None and stage.planner is not None and stage.side.reactor.journal.state.committed.epoch:
        epoch = stage.side.reactor.journal.state.committed.epoch - 1
        number = 10**6 + stage.rows["struck: stale"]
        sound = f"P[{number}] = Delay[1] :; Beat"
        stage.planner.send(Adaptation(id=number, epoch=epoch, definitions=sound, adds=(number,)))


def _replay(stage: Stage, fault: Fault) -> None:
    """Somebody sends again what was sent before, by the session that is open, and something of his own beside it."""
    answered = [a for key, a in stage.book.issued.items() if key in stage.book.outcomes]
    if stage.side is None or stage.side.session is None or not answered:
        return
    applied = [a for a in answered if stage.book.outcomes[a.epoch, a.id] == "applied"]
    refused = [a for a in answered if stage.book.outcomes[a.epoch, a.id] == "refused" and a.purpose != "wrong"]
    reactor = stage.side.reactor
    for adaptation in (stage.draw.choice(answered), *refused[-3:]):
        reactor.receive(adaptation)
    spent = stage.draw.choice(applied[-30:] or answered)
    told = reactor.counts["refused"]
    reactor.receive(spent)
    if spent in applied and spent.epoch == reactor.journal.state.committed.epoch and reactor.counts["refused"] > told:
        stage.watch.breach(6, f"adaptation {spent.id} was applied, comes once more, and is refused")
    before = reactor.counts["refused"]
    reactor.receive(msgspec.structs.replace(spent, definitions="", adds=(), purpose="another"))
    stage.rows["21 replays under another content refused"] += reactor.counts["refused"] - before
    stage.side.session.receive(stage.draw.randbytes(40), stage.scheduler.now)


def _version(stage: Stage, fault: Fault) -> None:
    """A frame of the next version of the link."""
    if stage.side is None or (session := stage.side.session) is None:
        return
    frame = Frame(VERSION + 1, session.peer, session.incarnation, 1, 0, b"")
    try:
        taken = session.receive(msgspec.msgpack.encode(frame), stage.scheduler.now)
    except InputError as refusal:
        names = f"version {VERSION + 1}" in str(refusal) and str(VERSION) in str(refusal)
        stage.rows["31 other versions of the link refused"] += names
    else:
        stage.watch.breach(10, f"a frame of another version was taken: {taken}")


def _watchdog(stage: Stage, fault: Fault) -> None:
    """The device stops the machine for a reason of its own."""
    stage.shop.dog.trip(stage.scheduler.now)


def _disk(stage: Stage, fault: Fault) -> None:
    if fault.kind == "full":
        stage.disk.fill(spare=stage.draw.choice((0, 9, 200)))
    else:
        stage.disk.sync_fails = True
    done, before = stage.watch.totals["beats"], stage.disk.refused

    def mend() -> None:
        refused = stage.disk.refused - before
        stage.rows["27 writes refused by the disk"] += refused
        if refused:
            stage.rows["27 beats while the disk took nothing"] += stage.watch.totals["beats"] - done
        stage.disk.mend()

    stage.scheduler.call_after(fault.seconds, mend)


def _halt(stage: Stage, fault: Fault) -> None:
    """The stop button, pressed by somebody else than the reactor; the reset comes later."""

    def press() -> None:
        if stage.side is not None and stage.side.session is not None and not stage.side.reactor.halted:
            stage.side.reactor.halt()
            stage.rows["halts"] += 1

    stage.scheduler.soon(press)


def _sensor(stage: Stage, fault: Fault) -> None:
    """A sensor goes wrong for a while: it knows nothing, sticks, slips, or is late; or it is right, and there is no."""
    sensors, name = stage.shop.sensors, fault.what or "A1"
    match fault.kind:
        case "fails":
            sensors.truth[name] = False
        case "unknown":
            sensors.truth[name] = None
        case "stuck":
            sensors.stuck[name] = (stage.draw.random() < 0.7, stage.draw.randrange(10**9))
        case "late":
            sensors.late["A1"] = 10.0 + fault.seconds
        case _:
            sensors.noisy.add(name)
    before = stage.shop.counts[f"nothing of {name}"]

    def over() -> None:
        sensors.truth[name] = True
        sensors.stuck.pop(name, None)
        sensors.late.pop("A1", None)
        sensors.noisy.discard(name)
        stage.rows["25 times that a sensor knew nothing"] += stage.shop.counts[f"nothing of {name}"] > before

    stage.scheduler.call_after(fault.seconds + 15.0, over)


def _noticed(stage: Stage, fault: Fault) -> None:
    """A process notices, and no sensor reads it: it holds again, and that is noticed too, after a while or at the end.
    """
    stage.shop.flips(NOTICED, holds=False)
    if stage.draw.random() < 0.5:
        stage.scheduler.call_after(5.0 * fault.seconds, stage.shop.relent)


def _flap(stage: Stage, fault: Fault) -> None:
    """A square wave of ten a second, noticed by a process, and it holds in the end."""
    shop, name = stage.shop, fault.what or "A0"

    def turn(left: int) -> None:
        going_on = left > 0 and not stage.calm
        shop.flips(name, holds=not going_on or left % 2 == 0)
        stage.rows["26 flips that were noticed"] += stage.side is not None
        if going_on:
            stage.scheduler.call_after(0.1, lambda: turn(left - 1))

    turn(40)


def _deeds(stage: Stage, fault: Fault) -> None:
    if fault.kind == "hang":
        stage.shop.hanging += 1
    else:
        stage.shop.raising += 3 if fault.kind == "raise" else 300


def _drive(stage: Stage, fault: Fault) -> None:
    """The drive's link drops in the middle of a move."""
    if stage.shop.axis.busy:
        stage.shop.link_drive(False)
        stage.scheduler.call_after(fault.seconds, lambda: stage.shop.link_drive(True))
    elif not stage.calm:
        stage.scheduler.call_after(0.7, lambda: _drive(stage, fault))


def _jump(stage: Stage, fault: Fault) -> None:
    stage.clock.offset += stage.scheduler.random("clock").choice((-DAY, DAY))
    stage.rows["24 jumps of the time of day"] += 1


def _crowd(stage: Stage, fault: Fault) -> None:
    """Ten thousand situations at once; then they go."""

    def gather() -> None:
        crowd = stage.brain.crowd() if stage.side is not None and stage.planner is not None else None
        if crowd is not None:
            stage.send(crowd)
            stage.scheduler.call_after(fault.seconds, disperse)
        elif not stage.calm and CROWD not in stage.book.nodes:
            stage.scheduler.call_after(3.0, gather)

    def disperse() -> None:
        if stage.side is not None:
            stage.rows["29 crowds of 10,000"] += len(stage.side.reactor.situations.instances) >= 10_000
        if (away := stage.brain.disperse()) is not None:
            stage.send(away)
        if CROWD in stage.book.nodes or CROWD in stage.book.touched:
            stage.scheduler.call_after(5.0, disperse)

    gather()


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
    "fails": _sensor, "noticed": _noticed, "flap": _flap, "unknown": _sensor, "stuck": _sensor,
    "noise": _sensor, "late": _sensor, "raise": _deeds, "hang": _deeds, "failing": _deeds,
    "drive": _drive, "jump": _jump, "crowd": _crowd,
    "replay": _replay, "version": _version, "watchdog": _watchdog, "world": _world,
    "nothing": lambda stage, fault: None,
}  # fmt: skip
