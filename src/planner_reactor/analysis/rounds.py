"""What a process does over and over: its rounds, with local processing hidden as time (X §4.1.2, §4.4.1).

A *round* of a recursive process, or of a loop, is a row of phases: it takes values from ports, lets time pass, offers
values. Whatever is not a port is hidden: a delay is time, a test that lets the round go on is a condition, a value
that is drawn is an unknown with bounds. The definitions of denseness (Definitions 1, 2 and 4, Lemma 5, Theorem 6)
are claims about rounds, so that a shape is recognised by what it does, however it is written.

A round may hold a process that never ends by itself and is cut when the round goes on, such as a Monitor
that runs beside a reading: its rounds are `inner` ones, cut by what the phase waits for. What `::` spawns stands in
`spawned`.

Legend: low, high: least and greatest seconds of a phase, waiting for partners left out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import count
from math import inf
from typing import TypeAlias

import msgspec
from msgspec.structs import replace

from planner_reactor.analysis.conditions import Atom, Event
from planner_reactor.analysis.durations import greatest, least
from planner_reactor.errors import PlannerReactorError
from planner_reactor.rs.comparisons import TESTS
from planner_reactor.rs.configurations import World
from planner_reactor.rs.constraints import consistent
from planner_reactor.rs.expressions import EvaluationError, evaluate
from planner_reactor.rs.terms import (
    All,
    Call,
    Cond,
    Disable,
    If,
    Loop,
    Not,
    Par,
    Parameter,
    Process,
    Schema,
    Seq,
    Spawn,
    Value,
)
from planner_reactor.rs.unknowns import Compared, Constraint, Symbolic, Unknown, courses

Scope: TypeAlias = Mapping[str, Value]

MOST_PATHS = 64
"""Ways through one round: beyond, the round counts as irreducible."""


class Irreducible(PlannerReactorError, ValueError):
    """A process whose rounds cannot be told: `process` is the part of it that is to blame."""

    def __init__(self, process: Process, why: str) -> None:
        self.process = process
        self.why = why
        super().__init__(why)


class Phase(msgspec.Struct, frozen=True):
    """A part of a round: it ends when all `takes` have got a value and all `gives` were taken, and its time is up.

    `offers` are written again and again while it lasts (a STREAM), `behind` are processes that run beside it and are
    cut at its end. A phase with `gives` and a finite `high` offers them no longer than that.
    """

    low: Value = 0
    high: Value = 0
    takes: tuple[tuple[Value, Value], ...] = ()
    gives: tuple[tuple[Value, Value], ...] = ()
    offers: tuple[tuple[Value, Value], ...] = ()
    behind: tuple[tuple[Process, tuple[tuple[str, Value], ...]], ...] = ()

    @property
    def waits(self) -> bool:
        return bool(self.takes or (self.gives and self.high == inf))


class Path(msgspec.Struct, frozen=True):
    """One way through a process. `end`: how it ended, never, or the call that it goes on as."""

    phases: tuple[Phase, ...] = ()
    end: str | Call = "ok"
    scope: tuple[tuple[str, Value], ...] = ()
    given: tuple[Atom, ...] = ()
    again: tuple[Value, ...] = ()
    spawned: tuple[Path, ...] = ()

    def then(self, other: Path) -> Path:
        return replace(
            other, phases=(*self.phases, *other.phases), given=(*self.given, *other.given),
            spawned=(*self.spawned, *other.spawned),
        )  # fmt: skip


class Rounds(msgspec.Struct, frozen=True):
    """A process that goes round: each way of going round, and each way of ending.

    `entry` holds the parameters as a round begins, in their order (`again` of a way has those of the next round),
    `cut_by` the ports at which a value begins it anew, `inner` what runs beside its phases.
    """

    process: Process
    name: str
    entry: tuple[tuple[str, Value], ...]
    ways: tuple[Path, ...]
    ends: tuple[Path, ...] = ()
    cut_by: tuple[Value, ...] = ()
    inner: tuple[Rounds, ...] = ()

    def all(self) -> Iterator[Rounds]:
        """This and every inner one."""
        yield self
        for rounds in self.inner:
            yield from rounds.all()


def rounds_of(process: Process, world: World) -> tuple[Rounds, ...]:
    """The rounds of a process, in whichever part of it they are. `Irreducible` if they cannot be told."""
    return _Reader(world).process(process, {}, (), ())


def ways_through(process: Process, world: World, scope: Scope) -> list[Path]:
    """Every way through a process that goes round nowhere, such as a test."""
    return _Reader(world).ways(process, scope)


class _Reader:
    def __init__(self, world: World) -> None:
        self._world = world
        self._serials = count(1)

    def ways(self, process: Process, scope: Scope) -> list[Path]:
        return self._paths(process, scope, ())

    # --------------------------------------------------------------------------------------------- what goes round

    def process(
        self, process: Process, scope: Scope, cut_by: tuple[Value, ...], seen: tuple[str, ...]
    ) -> tuple[Rounds, ...]:
        """The rounds of a process that is no part of a round itself."""
        match process:
            case Loop() | Spawn():
                return (self._recurrent(process, scope, cut_by),)
            case Call(name) if name not in seen and (schema := self._definition(process, scope)) is not None:
                ways = self._paths(schema.body, own := self._entry(schema, process, scope), (name,))
                if any(isinstance(way.end, Call) for way in ways):
                    entry = tuple(own.items())
                    return (self._made(process, name, entry, ways, cut_by),)
                return self._nested(ways, process, cut_by, (*seen, name))
            case _:
                return self._nested(self._paths(process, scope, ()), process, cut_by, seen)

    def _nested(
        self, ways: list[Path], process: Process, cut_by: tuple[Value, ...], seen: tuple[str, ...]
    ) -> tuple[Rounds, ...]:
        """What goes round within a process that does not, or what it does once."""
        phases = [phase for way in ways for phase in way.phases]
        inner = [r for phase in phases for r in self._behind(phase, cut_by, seen)]
        if any(p.offers or p.gives or p.takes for p in phases):
            name = process.name if isinstance(process, Call) else "a process"
            inner.insert(0, Rounds(process, name, (), (), tuple(ways), cut_by))
        return tuple(inner)

    def _behind(self, phase: Phase, cut_by: tuple[Value, ...], seen: tuple[str, ...] = ()) -> Iterator[Rounds]:
        cuts = (*cut_by, *(port for port, _ in phase.takes))
        for process, scope in phase.behind:
            yield from self.process(process, dict(scope), cuts, seen)

    def _recurrent(self, loop: Loop | Spawn, scope: Scope, cut_by: tuple[Value, ...]) -> Rounds:
        """`A:;B` and `A::B`: a round for each way through A, and B after it or beside what follows."""
        ways: list[Path] = []
        for way in self._paths(loop.condition, scope, ()):
            if way.end != "ok":
                ways.append(way)
                continue
            bodies = self._paths(loop.body, {**scope, **dict(way.scope)}, ())
            if isinstance(loop, Spawn):
                ways.append(replace(way, end=Call("::"), spawned=tuple(bodies)))
            else:
                ways += [_going_on(way.then(body)) for body in bodies]
        return self._made(loop, "a loop", (), ways, cut_by)

    def _made(
        self, process: Process, name: str, entry: tuple[tuple[str, Value], ...], ways: list[Path],
        cut_by: tuple[Value, ...],
    ) -> Rounds:  # fmt: skip
        going = tuple(way for way in ways if isinstance(way.end, Call))
        ending = tuple(way for way in ways if not isinstance(way.end, Call))
        found = [r for way in ways for phase in way.phases for r in self._behind(phase, cut_by)]
        return Rounds(process, name, entry, going, ending, cut_by, tuple(dict.fromkeys(found)))

    # ------------------------------------------------------------------------------------------ ways through a term

    def _paths(self, process: Process, scope: Scope, stack: tuple[str, ...]) -> list[Path]:
        match process:
            case Call():
                found = self._call(process, scope, stack)
            case Seq(parts):
                found = self._chained(parts, scope, stack, ("ok", "ab"))
            case Cond(parts):
                found = self._chained(parts, scope, stack, ("ok",))
            case Not(body):
                swapped: dict[object, str] = {"ok": "ab", "ab": "ok"}
                found = [replace(p, end=swapped.get(p.end, p.end)) for p in self._paths(body, scope, stack)]
            case If(test, then, otherwise):
                found = []
                for way in self._paths(test, scope, stack):
                    after = {"ok": then, "ab": otherwise}.get(str(way.end))
                    found += self._after(way, after, scope, stack) if after is not None else [way]
            case Par(parts) | All(parts):
                found = self._side_by_side(process, [self._paths(p, scope, stack) for p in parts], scope)
            case Disable(parts):
                found = self._first_to_end(process, parts, scope, stack)
            case Loop() | Spawn():
                found = [Path((Phase(0, inf, behind=((process, tuple(scope.items())),)),), "never")]
        if len(found) > MOST_PATHS:
            raise Irreducible(process, f"more than {MOST_PATHS} ways through one round")
        return found

    def _chained(
        self, parts: tuple[Process, ...], scope: Scope, stack: tuple[str, ...], goes_on: tuple[str, ...]
    ) -> list[Path]:
        found = [Path()]
        for n, part in enumerate(parts):
            found = [
                new
                for way in found
                for new in (self._after(way, part, scope, stack) if n == 0 or way.end in goes_on else [way])
            ]
        return found

    def _after(self, way: Path, process: Process, scope: Scope, stack: tuple[str, ...]) -> list[Path]:
        known = {**scope, **dict(way.scope)}
        return [
            replace(way.then(new), scope=(*way.scope, *new.scope)) for new in self._paths(process, known, stack)
        ]

    def _side_by_side(self, process: Process, parts: list[list[Path]], scope: Scope) -> list[Path]:
        """All of them: parts that only take, give or wait are one phase; what never ends runs behind the others."""
        endless = [ways[0].phases[0] for ways in parts if len(ways) == 1 and ways[0].end == "never"]
        ending = [ways for ways in parts if not (len(ways) == 1 and ways[0].end == "never")]
        if endless:
            return [Path((_with(Phase(0, inf), endless),), "never")] if not ending else [
                Path((Phase(0, inf, behind=((process, tuple(scope.items())),)),), "never")
            ]  # fmt: skip
        if any(len(ways) != 1 or len(ways[0].phases) > 1 or ways[0].end != "ok" for ways in ending):
            raise Irreducible(process, "its parts do more than one thing side by side")
        phases = [phase for ways in ending for phase in ways[0].phases]
        if not phases:
            return [Path()]
        merged = Phase(
            greatest(*(p.low for p in phases)), greatest(*(p.high for p in phases)),
            tuple(t for p in phases for t in p.takes), tuple(g for p in phases for g in p.gives),
        )  # fmt: skip
        return [Path((merged,), "ok", tuple(s for ways in ending for s in ways[0].scope))]

    def _first_to_end(
        self, process: Process, parts: tuple[Process, ...], scope: Scope, stack: tuple[str, ...]
    ) -> list[Path]:
        """The first to end decides: what never ends goes on as long as the others do."""
        ways = [(part, self._paths(part, scope, stack)) for part in parts]
        endless = [w[0].phases[0] for _, w in ways if len(w) == 1 and w[0].end == "never"]
        ending = [(part, w) for part, w in ways if not (len(w) == 1 and w[0].end == "never")]
        if not ending:
            return [Path((_with(Phase(0, inf), endless),), "never")]
        if len(ending) == 1:
            return [replace(w, phases=tuple(_with(p, endless) for p in w.phases)) for w in ending[0][1]]
        if any(len(w.phases) > 1 for _, found in ending for w in found):
            raise Irreducible(process, "it is open which of several that do more than one thing ends first")
        return _raced([w for _, found in ending for w in found], endless)

    # --------------------------------------------------------------------------------------------------- the leaves

    def _call(self, call: Call, scope: Scope, stack: tuple[str, ...]) -> list[Path]:
        values = self._values(call, scope)
        if call.name in stack:
            return [Path((), call, again=values)]
        match call.name, values:
            case ("STOP" | "NIL" | "ABORT" as name), _:
                ends = {"STOP": Path(), "ABORT": Path((), "ab"), "NIL": Path((Phase(0, inf),), "never")}
                return [ends[name]]
            case "IN", (port,):
                got = self._fresh(call.results[0] if call.results else "x")
                return [Path((Phase(takes=((port, got),)),), "ok", _bound(call, (got,)))]
            case "OUT", (port, value):
                return [Path((Phase(0, inf, gives=((port, value),)),))]
            case "STREAM", (port, value):
                return [Path((Phase(0, inf, offers=((port, value),)),), "never")]
            case ("Delay" | "Term" | "SUSPEND" as name), (time,):
                seconds = time / 1000 if name == "SUSPEND" else time  # type: ignore[operator]
                return [Path((Phase(0 if name == "Term" else seconds, seconds),))]
            case "Ran", (low, high):
                drawn = self._fresh(call.results[0] if call.results else "x")
                bounds = tuple(c for c in (_at_most(low, drawn), _at_most(drawn, high)) if c is not None)
                return [Path((), "ok", _bound(call, (drawn,)), bounds)]
        if call.name in TESTS:
            asked = courses(lambda: TESTS[call.name](*values), (), consistent)
            return [Path((), "ok" if yes else "ab", given=supposed) for yes, supposed in asked]
        return self._defined(call, values, scope, stack)

    def _defined(self, call: Call, values: tuple[Value, ...], scope: Scope, stack: tuple[str, ...]) -> list[Path]:
        schema = self._definition(call, scope)
        if schema is None:
            return self._basic(call, values)
        own = _parameters(schema, values)
        ways = self._paths(schema.body, own, (*stack, call.name))
        if any(isinstance(way.end, Call) and way.end.name == call.name for way in ways):
            return [Path((Phase(0, inf, behind=((call, tuple(scope.items())),)),), "never")]
        return [replace(way, scope=_returned(call, schema, dict(way.scope))) for way in ways]

    def _basic(self, call: Call, values: tuple[Value, ...]) -> list[Path]:
        """A process of the host: it takes its time, and its outcome is a condition."""
        signature = self._world.signatures.get(call.name)
        if signature is None or signature.window is None:
            raise Irreducible(call, f"nothing is known of how long {call.name} takes")
        names = call.results or signature.results
        got = tuple(self._fresh(name) for name in names)
        took = (Phase(*signature.window),) if signature.window != (0.0, 0.0) else ()
        ways = {"stop": Path(took, "ok", _bound(call, got), (Event(call.name, values, True, got),)),
                "abort": Path(took, "ab", (), (Event(call.name, values, False),))}  # fmt: skip
        return [way for outcome, way in ways.items() if outcome in signature.outcomes]

    # ---------------------------------------------------------------------------------------------------- values

    def _values(self, call: Call, scope: Scope) -> tuple[Value, ...]:
        """The arguments; names of which nothing is known are unknowns."""
        try:
            return tuple(evaluate(a, scope, self._world.functions) for a in call.arguments)
        except EvaluationError as error:
            raise Irreducible(call, str(error)) from error

    def _definition(self, call: Call, scope: Scope) -> Schema | None:
        found = self._world.program.clauses(call.name)
        return self._world.program.select(call.name, self._values(call, scope)) if found else None

    def _entry(self, schema: Schema, call: Call, scope: Scope) -> dict[str, Value]:
        """The parameters at the beginning of any round: names stay what they are, numbers are unknown."""
        given = _parameters(schema, self._values(call, scope))
        return {name: value if isinstance(value, str) else Unknown(name, -1) for name, value in given.items()}

    def _fresh(self, name: str) -> Unknown:
        return Unknown(name, next(self._serials))


def _parameters(schema: Schema, values: tuple[Value, ...]) -> dict[str, Value]:
    return {h.name: v for h, v in zip(schema.head, values, strict=True) if isinstance(h, Parameter)}


def _bound(call: Call, values: tuple[Value, ...]) -> tuple[tuple[str, Value], ...]:
    return tuple(zip(call.results, values, strict=False))


def _returned(call: Call, schema: Schema, scope: Scope) -> tuple[tuple[str, Value], ...]:
    named = [(out, scope[own]) for out, own in zip(call.results, schema.results, strict=False) if own in scope]
    return tuple(named)


def _going_on(way: Path) -> Path:
    """The end of a body is where the loop goes on."""
    return way if way.end == "never" or isinstance(way.end, Call) else replace(way, end=Call(":;"))


def _with(phase: Phase, endless: list[Phase]) -> Phase:
    """The phase with what never ends beside it."""
    offers = tuple(o for other in endless for o in other.offers)
    behind = tuple(b for other in endless for b in other.behind)
    return replace(phase, offers=(*phase.offers, *offers), behind=(*phase.behind, *behind))


def _raced(ways: list[Path], endless: list[Phase]) -> list[Path]:
    """Each may end first, and none lasts longer than the others let it."""
    timed = [p.high for way in ways for p in way.phases if not p.waits and not p.gives]
    most = least(*timed) if timed else inf
    found = []
    for way in ways:
        phase = way.phases[0] if way.phases else Phase()
        if phase.takes or phase.gives:
            phase = replace(phase, low=0, high=least(phase.high, most) if timed else phase.high)
            found.append(replace(way, phases=(_with(phase, endless),)))
    offered = [p for way in found for p in way.phases if p.gives]
    if not (offered and timed):
        found += [replace(w, phases=tuple(_with(p, endless) for p in w.phases)) for w in ways
                  if not any(p.takes or p.gives for p in w.phases)]  # fmt: skip
    return found


def _at_most(low: Value, high: Value) -> Constraint | None:
    if isinstance(low, Symbolic) or isinstance(high, Symbolic):
        return Compared(low - high, "<=")  # type: ignore[operator]
    return None
