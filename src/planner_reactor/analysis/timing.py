"""Does a reaction keep up with its environment? (X §4.4.2)

A reaction reads a port of the environment, which is (γe, τe)-dense, and writes another; from the one to the other it is
itself (γr, τr)-dense. Checked, each with both sides in seconds and the process that contributes most where it fails:

    reads         τr + γr < τe + γe: it takes values faster than the environment makes them
    writes        γr < γe: it has a new value before the environment is ready for one
    corrects      one time around the loop is shorter than the environment takes to change: a deviation is undone in
                  one correction step, which is what the paper calls stable
    covers        what the environment can change while the loop goes round once is less than what the sensor covers:
                  the paper assumes this (saturation and lost coverage are excluded)

The paper's constraints look at the reaction alone. A sensor that a write begins anew (X §5.1, at `angle`) needs
its time undisturbed, `restart`; γe of a port that is written is this time, and the loop is as long as the reaction and
the restart together. The longest loop counts the values that a STREAM hands over more than once: each is written too.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import ceil, inf
from typing import Any

import msgspec

from planner_reactor.analysis.denseness import Denseness, Failure, Netlist, Stage
from planner_reactor.analysis.durations import at_most, greatest, least, less
from planner_reactor.analysis.interface import parameters
from planner_reactor.analysis.meanings import meaning
from planner_reactor.analysis.rounds import Irreducible
from planner_reactor.errors import InputError
from planner_reactor.rs.configurations import World
from planner_reactor.rs.constraints import instance
from planner_reactor.rs.prelude import QUANTUM
from planner_reactor.rs.terms import Process, Value
from planner_reactor.rs.unknowns import Applied, Compared, Sum, Symbolic, Unknown, split, unknowns


class Check(msgspec.Struct, frozen=True):
    """`left < right`, in seconds (in units of the quantity for `covers`); `holds` is None if names leave it open.

    `offender` is the process that contributes most to the side that is too large.
    """

    name: str
    port: Value
    left: Any
    right: Any
    holds: bool | None
    offender: str = ""

    def __str__(self) -> str:
        verdict = {True: "holds", False: "fails", None: "is open"}[self.holds]
        blame = f": {self.offender} contributes most" if self.holds is False and self.offender else ""
        sign = "<=" if self.name == "covers" else "<"
        return f"{self.name} {self.port}: {shown(self.left)} {sign} {shown(self.right)} {verdict}{blame}"


class Stability(msgspec.Struct, frozen=True):
    """All checks of one way from a sensor to a motor and back. `loop` is the least and greatest time around.

    `failures` are ports that are not dense, so that nothing could be checked.
    """

    checks: tuple[Check, ...] = ()
    failures: tuple[Failure, ...] = ()
    loop: tuple[Any, Any] = (0, inf)

    @property
    def stable(self) -> bool | None:
        """Do all checks hold? None: it depends on what open names stand for."""
        if self.failures or any(c.holds is False for c in self.checks):
            return False
        return None if any(c.holds is None for c in self.checks) else bool(self.checks)


def sufficiently_dense(
    environment: Denseness, reaction: Denseness, *, writes: bool = False, ready: Any = None
) -> tuple[Check, ...]:
    """X §4.4.2 as printed: the period of the reaction below that of the environment; of a writer also its γ.

    `ready` is the γe of the port that is written, if it is not that of the environment's signal.
    """
    period = _check("reads", environment.port, reaction.period, environment.period, reaction.stages)
    if not writes:
        return (period,)
    gap = environment.delay if ready is None else ready
    return period, _check("writes", reaction.port, reaction.delay, gap, reaction.stages, delays=True)


def stability(environment: Process, reaction: Sequence[Process], world: World) -> Stability:
    """Does a reaction (with the interface processes that it uses) keep up with an environment?

    Every port that the environment writes and the reaction reads is paired with every one that goes the other way.
    InputError if there is no such pair.
    """
    outer = Netlist(environment, world)
    inner = Netlist(reaction[0], world, *reaction[1:]) if reaction else outer
    read = [p for p in outer.ports if outer.writers(p) and inner.readers(p)]
    written = [p for p in inner.ports if inner.writers(p) and outer.readers(p)]
    if not read or not written:
        missing = "reads no port that the environment writes" if not read else "writes no port that it reads"
        raise InputError(f"the reaction {missing}")
    answers = [_way(outer, inner, source, sink) for source in read for sink in written]
    checks = tuple(dict.fromkeys(c for answer in answers for c in answer.checks))
    failures = tuple(dict.fromkeys(f for answer in answers for f in answer.failures))
    around = [answer.loop for answer in answers]
    return Stability(checks, failures, (least(*(a for a, _ in around)), greatest(*(b for _, b in around))))


def _way(outer: Netlist, inner: Netlist, source: str, sink: str) -> Stability:
    signal = outer.dense(source, {})
    reaction = inner.dense(sink, {source: (0, 0)})
    failures = tuple(f for f in (signal, reaction) if isinstance(f, Failure))
    if isinstance(signal, Failure) or isinstance(reaction, Failure):
        return Stability((), failures)
    cut = sink in signal.cut_by
    ready = signal.restart if cut else signal.delay
    checks = list(sufficiently_dense(signal, reaction, writes=True, ready=ready))
    loop = _loop(signal, reaction, cut)
    changes = _first(signal).delay + _first(signal).resolution
    checks.append(_check("corrects", source, loop[1], changes, (*reaction.stages, _as_stage(signal))))
    checks += _coverage(outer, signal, sink, loop[1], changes)
    return Stability(tuple(checks), (), loop)


def _first(signal: Denseness) -> Stage:
    """The source of a signal."""
    return signal.stages[0] if signal.stages else _as_stage(signal)


def _as_stage(signal: Denseness) -> Stage:
    return Stage(signal.process, signal.port, signal.restart, 0, signal.form)


def _loop(signal: Denseness, reaction: Denseness, cut: bool) -> tuple[Any, Any]:
    """From one value at the sensor's port to the next that tells of the correction.

    Each value that is handed over once more (by a STREAM, or held by a process on the way) is written once more.
    """
    last = reaction.stages[-1] if reaction.stages else Stage(reaction.process, reaction.port, 0, 0, "")
    burst = 0 if last.once else last.resolution
    again = signal.restart if cut else signal.period
    least_time = reaction.delay + burst + again
    streams = [s for s in reaction.stages[:-1] if not s.once and s.form != "on demand"]
    held = sum(s.form == "on demand" for s in reaction.stages)
    one = last.delay + burst
    repeats: Any = 0
    for stage in streams:
        repeats = repeats + _repeated(stage.resolution, one, held)
    return least_time, least_time + repeats


def _repeated(offered: Any, one: Any, held: int) -> Any:
    """The time that values take which a STREAM offers again: as many as are held on the way, and as it has time for."""
    if isinstance(offered, Symbolic) or isinstance(one, Symbolic):
        return offered + one * (held + 1) if not at_most(offered, QUANTUM) else 0
    if offered <= QUANTUM or one <= 0:
        return 0
    return one * (held + int(offered / one + 1e-9))


# -------------------------------------------------------------------------------------------------------- coverage


def _coverage(outer: Netlist, signal: Denseness, sink: str, loop: Any, changes: Any) -> Iterator[Check]:
    """Is what the source changes while the loop goes round less than what the condition of the signal leaves free?"""
    source = outer.local(_first(signal).port)
    margin = _margin(outer, signal, sink)
    if isinstance(source, Failure) or source.most is None or margin is None:
        return
    reach = source.most * _steps(loop, changes)
    yield _check("covers", signal.port, reach, margin, (), closed=True, offender=_first(signal).process)


def _steps(loop: Any, changes: Any) -> Any:
    """How often the source changes while the loop goes round once."""
    if loop == inf or isinstance(loop, Symbolic) or isinstance(changes, Symbolic):
        return 1 if at_most(loop, changes) else Applied("steps", (loop, changes))
    return ceil(loop / changes - 1e-9)


def _margin(outer: Netlist, signal: Denseness, sink: str) -> Any:
    """How far the signal's quantity may be from where a write at `sink` has set the sensor to."""
    (writer,) = outer.writers(signal.port)
    found = outer.rounds(writer)
    if isinstance(found, Irreducible):
        return None
    sets = [(u, new) for rounds in found for way in rounds.ways for phase in way.phases for p, got in phase.takes
            if p == sink for (_, u), new in zip(rounds.entry, way.again, strict=False) if new == got]  # fmt: skip
    own = {u for u, _ in parameters(outer.components[writer], outer.world)}
    told = [c for atom in signal.given for c in meaning(atom, outer.world) or () if isinstance(c, Compared)]
    named = {u for c in told for u in unknowns(c.value)}
    quantity = [u for u in named if u.serial > 0 and u not in own]
    aimed = [u for u, _ in sets if isinstance(u, Unknown) and u in named]
    return _slack(told, aimed[0], quantity[0]) if len(quantity) == len(aimed) == 1 else None


def _slack(told: Sequence[Compared], aimed: Unknown, quantity: Unknown) -> Any:
    room = []
    for constraint in told:
        factors, _ = split(constraint.value)
        left = instance(constraint.value, {aimed: quantity})
        if isinstance(left, Unknown | Sum) and quantity in split(left)[0]:
            return None
        room.append(-left / abs(factors[quantity]) if quantity in factors else inf)
    return least(*room) if room else None


def _check(
    name: str, port: Value, left: Any, right: Any, stages: Sequence[Stage], *, delays: bool = False,
    closed: bool = False, offender: str = "",
) -> Check:  # fmt: skip
    holds = True if closed and at_most(left, right) else less(left, right)
    most = max((s for s in stages if not isinstance(s.delay + s.resolution, Symbolic)), default=None,
               key=lambda s: s.delay + (0 if delays or s.form == "on demand" else s.resolution))  # fmt: skip
    return Check(name, port, left, right, holds, offender or (most.process if most is not None else ""))


def shown(value: Any) -> str:
    """A duration for people: numbers to six digits."""
    return f"{value:.6g}" if isinstance(value, int | float) else str(value)
