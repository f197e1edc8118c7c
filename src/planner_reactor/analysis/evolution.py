"""How a process evolves: `poss`, `poss*` and path conditions (X §4.3.1 equations (1) to (3), App. B).

Nothing here says what an operator means: the rules of `rs.evolves` and `rs.leaves` run on unknowns, once for each
answer that the unknowns leave open, and the answers are the condition of the step. Time is exact: a delay of unknown
length ends next if no other can end before it, so `Delay[t0]` beside `Delay[t1]` ends under `t0 <= t1`. A name that
stands for a duration is taken as greater than 0.

A process of the host ends in every way that it declares and returns fresh unknowns. A port that is open is one at
which the world outside reads and writes when it likes.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from functools import partial
from math import inf
from typing import Any, TypeVar

import msgspec
from msgspec.structs import replace

from planner_reactor.analysis.conditions import Atom, Condition, Event, constraints_of, mentioned, shortened, weaker
from planner_reactor.analysis.explore import canonical
from planner_reactor.analysis.renaming import renamed, unknowns_of
from planner_reactor.rs.configurations import Config, Ending, Label, World
from planner_reactor.rs.constraints import consistent, projected
from planner_reactor.rs.evolves import settle, started
from planner_reactor.rs.leaves import MEETINGS, PASSIVE, Offer, elapsed, offers_of, urgent, window
from planner_reactor.rs.serving import RULES
from planner_reactor.rs.states import Ended, Leaf, Spot
from planner_reactor.rs.terms import Process, Value
from planner_reactor.rs.unknowns import Compared, Constraint, Symbolic, Unknown, courses
from planner_reactor.rs.vocabulary import BOTH

T = TypeVar("T")

MARKER = Leaf("NIL", results=("marker",))
"""A leaf as no text has one: what becomes of it is what would become of the leaf in whose place it stands."""

DURATIONS = ("Delay", "Term", "SUSPEND")
"""Leaves whose argument is how long they take."""


class State(msgspec.Struct, frozen=True):
    """A configuration, what is known of its unknowns, and the serial of the next one."""

    config: Config
    known: tuple[Constraint, ...] = ()
    serial: int = 1


class Evolution(msgspec.Struct, frozen=True):
    """`P -condition-> after` in one step. `label` is what an observer sees; `passed` the time before it."""

    condition: Condition
    after: State
    label: Label
    urgent: bool = True
    passed: Value = 0


def beginnings(process: Process, world: World, known: Sequence[Constraint] = ()) -> Iterator[State]:
    """The process as it begins: one state, unless its beginning depends on what is not known."""
    for config, supposed in courses(lambda: started(process, world), known, consistent):
        yield State(config, (*known, *supposed))


def poss(state: State, world: World, *, open_ports: Collection[Value] = ()) -> list[Evolution]:
    """Equation (1): every step that is possible next, with its condition. Time may pass before it."""
    state = replace(state, known=(*state.known, *_presumed(state)))
    now = [*immediate(state, world), *outside(state, world, open_ports)]
    found = [replace(e, condition=_stated(e, state.known)) for e in now]
    for patient in _patient(state, world, now):
        found += _later(patient, world)
    return _distinct(found)


def _presumed(state: State) -> tuple[Constraint, ...]:
    """That the names in it that stand for durations are greater than 0."""
    leaves = (spot.leaf for spot in state.config.spots())
    durations = (i.arguments[0] for i in leaves if isinstance(i, Leaf) and i.name in DURATIONS and i.arguments)
    positive = (Compared(-d, "<") for d in durations if isinstance(d, Unknown) and d.serial <= 0)
    return tuple(dict.fromkeys(c for c in positive if c not in state.known))


def reachable(
    start: State, world: World, *, open_ports: Collection[Value] = (), limit: int = 1_000
) -> tuple[list[tuple[tuple[Condition, ...], State]], bool]:
    """Equation (3), poss*: the (path, state) pairs, breadth first; has every one been found?

    A path is the condition of each of its steps, in their order: equation (2), c = c1.c2.….
    A path is followed no further where its configuration and what is known have been met before.
    """
    found: list[tuple[tuple[Condition, ...], State]] = [((), start)]
    seen = {_apart(start)}
    for path, state in found:  # grows while it is read
        for evolution in poss(state, world, open_ports=open_ports):
            if len(found) > limit:
                return found, False
            key = _apart(evolution.after)
            if key not in seen:
                seen.add(key)
                found.append(((*path, evolution.condition), evolution.after))
    return found, True


def _apart(state: State) -> tuple[Config, tuple[Constraint, ...]]:
    """What tells states apart: not the names of fresh unknowns, nor what was known of those that are gone."""
    live = {*unknowns_of(state.config), *(u for u in mentioned(state.known) if u.serial <= 0)}
    known = projected(state.known, live)
    return renamed((canonical(state.config), tuple(sorted(known, key=repr))))


def extended_abort(
    state: State, spot: Spot, world: World, *, open_ports: Collection[Value] = ()
) -> tuple[Condition, ...]:
    """Equation (B.1): every condition under which one live leaf aborts in one step, by itself or because it is forced.

    `℧̄A = ℧A ∨ ⋁ (℧Pi ∨ ΩPi)` for the other parts of a `#`. Which steps force it is asked of the rules: in its place
    stands a process that nothing ends and that nothing begins anew, and steps after which it is gone have aborted it.
    """
    assert isinstance(spot.leaf, Leaf)
    spots = list(state.config.spots())
    own = [e for e in of_spot(state, spot, spot.leaf, spots, world) if e.label[2] == "ab"]
    marked = replace(state, config=state.config.put(spot, MARKER))
    forced = [
        e
        for e in poss(marked, world, open_ports=open_ports)
        if all(after.leaf != MARKER for after in e.after.config.spots())
    ]
    return tuple(e.condition for e in (*own, *forced))


# ------------------------------------------------------------------------------------------------ without delay


def immediate(state: State, world: World) -> Iterator[Evolution]:
    """The steps that the network itself takes at this very instant."""
    spots = list(state.config.spots())
    for spot in spots:
        if isinstance(spot.leaf, Leaf) and spot.leaf.name not in PASSIVE:
            yield from of_spot(state, spot, spot.leaf, spots, world)


def outside(state: State, world: World, ports: Collection[Value]) -> Iterator[Evolution]:
    """The meetings with the world outside that may happen at this instant, at the open ports."""
    for spot in state.config.spots() if ports else ():
        if isinstance(spot.leaf, Leaf) and spot.leaf.arguments and spot.leaf.arguments[0] in ports:
            yield from _met_outside(state, spot, spot.leaf, world)


def of_spot(state: State, spot: Spot, leaf: Leaf, spots: list[Spot], world: World) -> Iterator[Evolution]:
    """The steps that one leaf begins now, each as far as the conditions of its rule and of settling differ."""
    reading = replace(world, endings=partial(_endings, leaf, world, state.serial))
    offered = _in_courses(lambda: list(offers_of(spot, leaf, spots, state.config, reading)), state.known)
    for offers, supposed in offered:
        for offer in offers:
            atoms, fresh = _made_known(offer, leaf, state.serial)
            known = (*state.known, *supposed, *constraints_of(atoms))
            for after, further in _in_courses(partial(offer.taken, state.config, reading), known):
                condition = (*atoms, *supposed, *further)
                reached = State(after, (*known, *further), state.serial + fresh)
                yield Evolution(condition, reached, offer.label, offer.urgent)


def _in_courses(run: Callable[[], T], known: Sequence[Constraint]) -> Iterator[tuple[T, tuple[Constraint, ...]]]:
    return courses(run, known, consistent)


def _endings(leaf: Leaf, world: World, serial: int, name: str, arguments: tuple[Value, ...]) -> Iterator[Ending]:
    """Every way in which a process of the host may end; what it returns is unknown."""
    signature = world.signatures.get(name)
    names = leaf.results or (signature.results if signature is not None else ())
    outcomes = signature.outcomes if signature is not None else BOTH
    if "stop" in outcomes:
        yield True, tuple(Unknown(result, serial + i) for i, result in enumerate(names))
    if "abort" in outcomes:
        yield False, ()


def _made_known(offer: Offer, leaf: Leaf, serial: int) -> tuple[tuple[Atom, ...], int]:
    """What the step itself tells, and how many unknowns it brings."""
    name, arguments, status, values = offer.label
    fresh = sum(isinstance(v, Unknown) and v.serial >= serial for v in values)
    if name == "Ran" and values and isinstance(values[0], Symbolic):
        low, high = arguments
        return tuple(at_most(a, b) for a, b in ((low, values[0]), (values[0], high))), fresh
    if name in ("GTR", "LST", "Equal") and any(isinstance(a, Symbolic) for a in arguments):
        return (), fresh
    kind = "meeting" if name in MEETINGS or name == "COM" else "process"
    return (Event(name, arguments, status != "ab", values, kind),), fresh  # type: ignore[arg-type]


def at_most(low: Any, high: Any) -> Constraint:
    """`low <= high`, of which at least one is unknown."""
    return Compared(low - high, "<=")


def _met_outside(state: State, spot: Spot, leaf: Leaf, world: World) -> Iterator[Evolution]:
    """The world outside reads at an open port, or writes what nobody knows."""
    if leaf.name == "IN":
        value = Unknown(leaf.results[0] if leaf.results else "value", state.serial)
        ended = Ended(True, tuple((result, value) for result in leaf.results))
        event = Event("IN", leaf.arguments, True, (value,), "outside")
    elif leaf.name == "OUT":
        ended, event = Ended(True), Event("OUT", leaf.arguments, True, (), "outside")
    else:
        return
    serial = state.serial + len(event.results)
    for after, further in _in_courses(lambda: settle(state.config.put(spot, ended), world), state.known):
        label = (event.name, event.arguments, "ok", event.results)
        reached = State(after, (*state.known, *further), serial)
        yield Evolution((event, *further), reached, label, urgent=False)


# -------------------------------------------------------------------------------------------------- after a while


def _patient(state: State, world: World, now: list[Evolution]) -> Iterator[State]:
    """The state as far as nothing in it is urgent, so that time may pass (TIME)."""
    if any(e.urgent and not constraints_of(e.condition) for e in now):
        return
    reading = replace(world, endings=lambda name, arguments: [(True, ())])
    for hurries, supposed in _in_courses(lambda: urgent(state.config, reading), state.known):
        if not hurries:
            yield replace(state, known=(*state.known, *supposed))


def _later(state: State, world: World) -> Iterator[Evolution]:
    """The steps after some time: what ends then has reached its window, and nothing has left its own."""
    for position, spot in enumerate(state.config.spots()):
        leaf = spot.leaf
        if not isinstance(leaf, Leaf) or leaf.name in RULES or leaf.name in PASSIVE or leaf.name in MEETINGS:
            continue
        for pause, passed in _after(state, leaf, world):
            spots = list(passed.config.spots())
            older = spots[position].leaf
            assert isinstance(older, Leaf)
            for e in of_spot(passed, spots[position], older, spots, world):
                yield _waited(e, state, passed, pause)


def _after(state: State, leaf: Leaf, world: World) -> Iterator[tuple[Any, State]]:
    """A pause after which the leaf may end, longer than nothing, in which no window closes; and the state after it."""
    leaves = [spot.leaf for spot in state.config.spots() if isinstance(spot.leaf, Leaf)]
    any_pause: Any = Unknown("pause", state.serial)

    def passed() -> tuple[Any, Config] | None:
        low, high = window(leaf, world)
        pause = low - leaf.age if low == high else any_pause
        if low == inf or not (pause > 0 and all(pause <= window(i, world)[1] - i.age for i in leaves)):
            return None
        return pause, elapsed(state.config, pause, world)

    for result, supposed in _in_courses(passed, state.known):
        if result is not None:
            pause, older = result
            yield pause, State(older, (*state.known, *supposed), state.serial + (pause is any_pause))


def _waited(e: Evolution, before: State, passed: State, pause: Value) -> Evolution:
    """The step with the pause before it: what is asked of the pause is asked of everything else instead."""
    asked = (*passed.known[len(before.known) :], *constraints_of(e.condition))
    fresh = isinstance(pause, Unknown) and pause.serial == before.serial
    keep = set(mentioned((*before.known, *asked))) - ({pause} if isinstance(pause, Unknown) else set())
    events = tuple(atom for atom in e.condition if isinstance(atom, Event))
    stated = shortened(projected(asked, keep) if fresh else asked, before.known)
    return replace(e, condition=(*events, *stated), passed=pause)


def _stated(e: Evolution, known: Sequence[Constraint]) -> Condition:
    events = tuple(atom for atom in e.condition if isinstance(atom, Event))
    return (*events, *shortened(constraints_of(e.condition), known))


def _distinct(found: list[Evolution]) -> list[Evolution]:
    """Without steps that are possible after a while as they are now."""
    now = [e for e in found if e.passed == 0]

    def again(e: Evolution) -> bool:
        return any(n.label == e.label and weaker(n.condition, e.condition) for n in now)

    return [e for e in found if e.passed == 0 or not again(e)]
