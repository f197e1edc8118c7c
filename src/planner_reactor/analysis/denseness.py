"""When a port can be reasoned about as if it carried a continuous signal (X §4.4, App. A).

A port is (γ, τ)-dense if a value is offered on it again and again: no silence is longer than γ, and no value is offered
longer than τ. What a component does in a round (`rounds`) decides it:

    Definition 1    a round takes nothing and offers the port: a source, γ its silence, τ its offer
    Definition 2    a round takes a value at x, then offers f(value): locally dense with x
    Lemma 5, ST     the same as a loop: `(IN[x]<v> ; Delay) :; (STREAM[y, f(v)] # Delay)`
    Theorem 6, AT   the same with `::`, where a delay keeps the reading off until the offer has ended
    Definition 3    x is (γi, τi)-dense, y locally (γo, τo)-dense with x: y is (γi + γo, max(τi, τo))-dense
    Definition 4    a source whose value changes by δ in each round is densely increasing or decreasing

`age` is a bound that the paper does not have: resolutions add up in it, so that it says how old what is read may be;
γ + max(τi, τo) does not say that (docs/decisions/0042).

More than the paper has: waiting at another port is local processing that takes as long as that port is silent, so that
several ports reduce to one (values taken side by side: the longest wait; one after the other: their sum). Delays that
are upper bounds (Term) keep every claim; only AT then pays for what `::` no longer keeps apart: its silence grows by
what the delay may be longer than the offer, and old and new may be offered together for `overlap` seconds. A port that
is offered once per round until somebody takes it (OUT) is as silent as its reader is busy.

Where a component waits within its round for an answer to what it asks another, `hiding` looks at every state instead.

A silence is what a reader may have to wait; the pause of a STREAM (rs.prelude.QUANTUM) after each value that it hands
over comes on top of it. Durations may be names.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from math import inf
from typing import Any, Literal, TypeAlias

import msgspec
from msgspec.structs import replace

from planner_reactor.analysis.conditions import Condition
from planner_reactor.analysis.durations import greatest, least
from planner_reactor.analysis.hiding import silence
from planner_reactor.analysis.offering import Local, Refusal, local
from planner_reactor.analysis.rounds import Irreducible, Phase, Rounds, rounds_of
from planner_reactor.analysis.subnets import network, traffic
from planner_reactor.errors import InputError, nearest
from planner_reactor.rs.configurations import World
from planner_reactor.rs.given import process_with_values, with_values
from planner_reactor.rs.linking import Linked
from planner_reactor.rs.open_names import open_names
from planner_reactor.rs.parser import parse_process
from planner_reactor.rs.prelude import QUANTUM
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import Call, Par, Process, Program, Schema, Value
from planner_reactor.rs.unknowns import Undecided, Unknown, split
from planner_reactor.rs.vocabulary import BUILT_IN, Signature

Supplied: TypeAlias = Mapping[str, tuple[Any, Any]]
"""What the world outside gives at open ports: port to (γ, τ)."""


class Stage(msgspec.Struct, frozen=True):
    """One component on the way: what it adds. `form` names the definition that it has the shape of."""

    process: str
    port: Value
    delay: Any
    resolution: Any
    form: str
    once: bool = False


class Denseness(msgspec.Struct, frozen=True):
    """The port is (delay, resolution)-dense, γ and τ in seconds, while `given` holds.

    `inputs` are the ports that its writer takes values from, `stages` every component on the way, sources first.
    `value` is what is offered, `change` δ of Definition 4, `most` a bound of |δ|, `trend` its sign. `cut_by`: a value
    at one of these ports begins the writer anew, which then needs `restart` seconds.
    """

    port: Value
    process: str
    form: str
    delay: Any
    resolution: Any
    stages: tuple[Stage, ...] = ()
    inputs: tuple[Value, ...] = ()
    value: Value = None
    change: Value = None
    trend: Trend = "open"
    given: Condition = ()
    cut_by: tuple[Value, ...] = ()
    restart: Any = 0
    overlap: Any = 0
    most: Any = None
    age: Any = 0

    @property
    def period(self) -> Any:
        """γ + τ: the bounding period of Fig. 4."""
        return self.delay + self.resolution


Trend: TypeAlias = Literal["increasing", "decreasing", "constant", "either", "open"]


class Failure(msgspec.Struct, frozen=True):
    """The port is not dense, or nobody can tell: `process` is to blame, `why` says what would be expected.

    `undecided`: its rounds alone do not tell.
    """

    port: Value
    process: str
    why: str
    undecided: bool = False

    def __str__(self) -> str:
        return f"{self.port} is not dense: {self.process} {self.why}"


def dense(
    program: Program | World, process: Process | str, port: str, *, supplied: Supplied | None = None,
    given: Mapping[str, float] | None = None,
) -> Denseness | Failure:  # fmt: skip
    """Is a port of a process dense, and with which timing? `process` is a network, `|` of components, or one of them.

    `supplied` says what comes in at open ports; `given` what open names are (the others stay names). InputError for a
    port that nobody uses.
    """
    world = program if isinstance(program, World) else opened(program, given=given)
    nets = Netlist(asked(process, world, given or {}), world)
    found = nets.dense(port, supplied or {})
    return _looked_at(nets, found, supplied or {}) if isinstance(found, Failure) and found.undecided else found


def _looked_at(nets: Netlist, failure: Failure, supplied: Supplied) -> Denseness | Failure:
    """What rounds cannot tell is told by all states, if all delays are numbers."""
    network = Par(nets.components) if len(nets.components) > 1 else nets.components[0]
    open_inputs = [p for p in nets.ports if nets.readers(p) and not nets.writers(p)]
    try:
        waited = silence(network, nets.world, str(failure.port), open_inputs)
    except (Irreducible, Undecided, TypeError):
        return failure
    given = [supplied.get(p, (inf, inf)) for p in open_inputs]
    delay = waited - QUANTUM + sum(pair[0] for pair in given)
    if delay == inf:
        return failure
    held = [s.high for n in nets.writers(failure.port) for s in _offers(nets, n, failure.port)]
    resolution = greatest(*held, *(pair[1] for pair in given)) if held else inf
    return Denseness(failure.port, failure.process, "every state", max(delay, 0), resolution, inputs=tuple(open_inputs))


def _offers(nets: Netlist, number: int, port: Value) -> Iterator[Phase]:
    found = nets.rounds(number)
    for rounds in () if isinstance(found, Irreducible) else found:
        for way in rounds.ways:
            yield from (phase for phase in way.phases if any(p == port for p, _ in phase.offers))


def asked(process: Process | str, world: World, given: Mapping[str, float]) -> Process:
    """The process of a question: names in it that stand for numbers are unknowns, or what they are given to be."""
    found = parse_process(process) if isinstance(process, str) else process
    together = world.program.with_schemas([Schema("<asked>", (), (), found)])
    own = open_names(Linked(together, world.signatures, world.functions))
    return process_with_values(found, {**{name: Unknown(name, -1) for name in own}, **given})


def opened(
    program: Program, signatures: Mapping[str, Signature] | None = None, *, given: Mapping[str, float] | None = None
) -> World:
    """The world of a program whose open names are unknowns, or what they are given to be."""
    known = {**BUILT_IN, **(signatures or {})}
    values: dict[str, Value] = {n: Unknown(n) for n in open_names(Linked(program, known, ()))}
    return World(with_values(program, {**values, **(given or {})}), known)


class Netlist:
    """The components of a network and their rounds: who writes which port, and who takes from it."""

    def __init__(self, process: Process, world: World, *more: Process) -> None:
        self.world = world
        self.components: tuple[Process, ...] = (*network(process, world).components, *more)
        self._rounds: dict[int, tuple[Rounds, ...] | Irreducible] = {}
        self._traffic = [traffic(c, world) for c in self.components]
        self._locals: dict[Value, Local | Failure] = {}

    @property
    def ports(self) -> tuple[str, ...]:
        return tuple(sorted({str(p) for t in self._traffic for p in t.ports if p is not None}))

    def rounds(self, number: int) -> tuple[Rounds, ...] | Irreducible:
        """The rounds of a component, every inner one too."""
        if number not in self._rounds:
            try:
                found = rounds_of(self.components[number], self.world)
                self._rounds[number] = tuple(x for r in found for x in r.all())
            except Irreducible as error:
                self._rounds[number] = error
        return self._rounds[number]

    def writers(self, port: Value) -> tuple[int, ...]:
        return tuple(n for n, t in enumerate(self._traffic) if port in t.writes | t.streams)

    def readers(self, port: Value) -> tuple[int, ...]:
        return tuple(n for n, t in enumerate(self._traffic) if port in t.reads)

    def name(self, number: int) -> str:
        component = self.components[number]
        return component.name if isinstance(component, Call) else show(component)

    # -------------------------------------------------------------------------------------------------- questions

    def local(self, port: Value) -> Local | Failure:
        """What the writer of a port does by itself: Definitions 1 and 2, Lemma 5, Theorem 6."""
        if port not in self._locals:
            self._locals[port] = self._local(port)
        return self._locals[port]

    def _local(self, port: Value) -> Local | Failure:
        writers = self.writers(port)
        if len(writers) != 1:
            names = ", ".join(map(self.name, writers))
            why = "all write it, expected one writer (X §4.2)" if writers else "does not write it: nobody writes it"
            return Failure(port, names or "the world outside", why)
        found = self.rounds(writers[0])
        if isinstance(found, Irreducible):
            why = f"has rounds that cannot be told: {found.why}: {show(found.process)}"
            return Failure(port, self.name(writers[0]), why, undecided=True)
        answer = local(port, found)
        return Failure(port, self.name(writers[0]), answer.why) if isinstance(answer, Refusal) else answer

    def dense(self, port: str, supplied: Supplied, seen: Collection[Value] = ()) -> Denseness | Failure:
        """Definition 3, from the sources on."""
        if not seen and port not in self.ports:
            hint = nearest(port, self.ports) or f"there are: {', '.join(self.ports)}"
            raise InputError(f"no component uses port {port}, {hint}")
        if port in supplied and not self.writers(port):
            delay, resolution = supplied[port]
            return Denseness(port, "the world outside", "supplied", delay, resolution)
        own = self.local(port)
        if isinstance(own, Failure):
            return own
        if port in seen:
            why = "waits for itself, through what it feeds"
            return Failure(port, self.name(self.writers(port)[0]), why, undecided=True)
        return self._composed(port, own, supplied, (*seen, port))

    def _composed(self, port: Value, own: Local, supplied: Supplied, seen: tuple[Value, ...]) -> Denseness | Failure:
        process = self.name(self.writers(port)[0])
        stages: dict[Stage, None] = {}
        delay, held, given, age = own.delay, [], list(own.given), 0
        before = False
        trends: dict[Unknown, Trend] = {}
        for takes in own.takes:
            waits, ages = [], []
            for taken, got in takes:
                found = self.dense(str(taken), supplied, seen)
                if isinstance(found, Failure):
                    return replace(found, port=port) if found.undecided else found
                waits.append(found.delay)
                ages.append(found.age)
                held.append(found.resolution)
                given += found.given
                trends[got] = found.trend
                stages.update(dict.fromkeys(found.stages))
            delay = delay + greatest(*waits)
            kept = [a + greatest(0, *waits[:n], *waits[n + 1 :]) for n, a in enumerate(ages)]
            age = greatest(*kept, *((age + greatest(*waits),) if before else ()))
            before = True
        for asked in own.gives:
            delay = delay + self.busy(asked, supplied)
        resolution = own.resolution if own.resolution is not None else self.busy(port, supplied)
        stages[Stage(process, port, own.delay, resolution, own.form, own.once)] = None
        return Denseness(
            port, process, own.form, delay, greatest(resolution, least(*held)) if held else resolution,
            tuple(stages), tuple(p for takes in own.takes for p, _ in takes), own.value, own.change,
            _transferred(own, trends), tuple(dict.fromkeys(given)), own.cut_by, own.restart + (delay - own.delay),
            own.overlap, own.most, age + own.lag + resolution if own.takes else 0,
        )  # fmt: skip

    def busy(self, port: Value, supplied: Supplied) -> Any:
        """How long a reader of the port may be busy before it takes the next value; `inf` if nobody reads it."""
        times = [t for n in self.readers(port) for t in self._between(n, port, supplied)]
        return least(*times) if times else inf

    def _between(self, number: int, port: Value, supplied: Supplied) -> Iterator[Any]:
        found = self.rounds(number)
        for rounds in () if isinstance(found, Irreducible) else found:
            for way in rounds.ways:
                if not any(p == port for phase in way.phases for p, _ in phase.takes):
                    continue
                time: Any = 0
                for phase in way.phases:
                    others = [p for p, _ in phase.takes if p != port]
                    waits = [self.dense(str(p), supplied, (port,)) for p in others]
                    time = time + (0 if phase.waits else phase.high)
                    time = time + greatest(0, *(w.delay if isinstance(w, Denseness) else inf for w in waits))
                yield time


def _transferred(own: Local, trends: Mapping[Unknown, Trend]) -> Trend:
    """Definition 4, carried through Definitions 2 and 3: f rises, falls, or neither, with what it takes."""
    if not trends:
        return own.trend
    factors, _ = split(own.value)
    found: dict[Trend, None] = {}
    for part, factor in factors.items():
        trend: Trend = trends.get(part, "open") if isinstance(part, Unknown) else "open"
        if trend != "constant":
            found[OPPOSITE[trend] if factor < 0 else trend] = None
    return next(iter(found), "constant") if len(found) <= 1 else "either"


OPPOSITE: Mapping[Trend, Trend] = {
    "increasing": "decreasing", "decreasing": "increasing", "constant": "constant", "either": "either", "open": "open",
}  # fmt: skip
