"""The steps of the leaves: tests, delays, ports, situations, guards (docs/language.md, Transitions).

Each built-in process has one function here, named after its rule; `steps` offers every step of a
configuration and `elapsed` lets time pass (TIME: all sides together, and only when nothing is urgent). A step
gives the label that an observer sees and the configuration afterwards, settled; who needs only some of them asks for
`offers` and takes those.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import inf
from typing import TypeAlias

import msgspec
from msgspec.structs import replace

from planner_reactor.errors import Place
from planner_reactor.rs.comparisons import TESTS
from planner_reactor.rs.configurations import AB, OK, Config, Label, World
from planner_reactor.rs.evolves import abort, settle
from planner_reactor.rs.expressions import is_number
from planner_reactor.rs.serving import RULES
from planner_reactor.rs.states import (
    Await,
    Ended,
    Group,
    Leaf,
    Path,
    Queued,
    Round,
    Run,
    Serve,
    Spawning,
    Spot,
    Testing,
    Waiting,
    parts_of,
    results_of,
    with_parts,
)
from planner_reactor.rs.store import Store
from planner_reactor.rs.terms import Value
from planner_reactor.rs.unknowns import Symbolic


class Step(msgspec.Struct, frozen=True):
    """One transition. `urgent` steps do not let time pass (maximal progress)."""

    label: Label
    after: Config
    urgent: bool = True


Meeting: TypeAlias = "Callable[[Spot, Leaf, list[Spot], Config], Iterator[Offer]]"

TIE = 1e-8
"""Seconds within which two instants are one: ages are rounded to nine places."""


class Offer(msgspec.Struct, frozen=True):
    """A step that could be taken: which leaves become what, and the store as they leave it."""

    label: Label
    changes: tuple[tuple[Spot, Run], ...]
    store: Store
    urgent: bool = True

    @property
    def sites(self) -> tuple[Place | None, ...]:
        """Where in the text the leaves stand that take it, a writer before its reader."""
        return tuple(spot.leaf.site for spot, _ in self.changes if isinstance(spot.leaf, Leaf))

    def taken(self, config: Config, world: World) -> Config:
        """The configuration after the step, settled."""
        for spot, term in self.changes:
            config = config.put(spot, term)
        return settle(Config(config.roots, self.store), world)


def steps(config: Config, world: World) -> Iterator[Step]:
    """PAR, SEQ: every step of every component, one single change each; COM pairs included."""
    for offer in offers(config, world):
        yield Step(offer.label, offer.taken(config, world), offer.urgent)


def offers(config: Config, world: World, *, seen: Label | None = None) -> Iterator[Offer]:
    """Every step, not yet taken; with `seen`, only those that show this label."""
    spots = list(config.spots())
    for spot in spots:
        leaf = spot.leaf
        if not isinstance(leaf, Leaf) or leaf.name in PASSIVE:
            continue
        if seen is None:
            yield from offers_of(spot, leaf, spots, config, world)
        elif leaf.name == (seen[0] if seen[0] != "COM" else "OUT") and leaf.arguments == seen[1]:
            yield from (o for o in offers_of(spot, leaf, spots, config, world) if o.label == seen)


def offers_of(spot: Spot, leaf: Leaf, spots: list[Spot], config: Config, world: World) -> Iterator[Offer]:
    """The steps that one leaf begins; `spots` are all of the configuration."""
    store = config.store
    if leaf.problem:
        yield Offer((leaf.name, (), AB, ()), ((spot, Ended(False, cause="error")),), store)
    elif (meeting := MEETINGS.get(leaf.name)) is not None:
        yield from meeting(spot, leaf, spots, config)
    elif (rule := RULES.get(leaf.name)) is None:
        yield from _ended(spot, leaf, store, world)
    elif (result := rule(leaf, spot, store, world)) is not None:
        status, values, term, store = result
        yield Offer((leaf.name, leaf.arguments, status, values), ((spot, term),), store)


# ------------------------------------------------------------------------------------------------------- ports


def _communicated(writer: Spot, leaf: Leaf, spots: list[Spot], config: Config) -> Iterator[Offer]:
    """COM. `p!v` meets `p?v`: one reader per write; any ready pair may meet."""
    port, value = leaf.arguments
    for reader, wanted in _named(spots, "IN", (port,)):
        changes = ((writer, Ended(True)), (reader, Ended(True, results_of(wanted, (value,)))))
        yield Offer(("COM", (port, value), OK, ()), changes, config.store)


# ----------------------------------------------------------------------------------- basic processes and time


def window(leaf: Leaf, world: World) -> tuple[float, float]:
    """The ages, in seconds, at which this process may end; (inf, inf) if only another process can end it."""
    match leaf.name:
        case name if name in RULES or name in PASSIVE or name in MEETINGS:
            return inf, inf
        case "Delay":
            return _seconds(leaf), _seconds(leaf)
        case "SUSPEND":
            return _seconds(leaf) / 1000, _seconds(leaf) / 1000
        case "Term":
            return 0.0, _seconds(leaf)
    signature = world.signatures.get(leaf.name)
    if signature is None or signature.window is None or _mistaken(leaf, world):
        return 0.0, 0.0
    return signature.window


def _mistaken(leaf: Leaf, world: World) -> bool:
    """Is an argument not what the basic process declares? Then it aborts at once."""
    if not leaf.arguments:
        return False
    signature = world.signatures.get(leaf.name)
    kinds = [signature.kind(n) for n in range(len(leaf.arguments))] if signature is not None else []
    return any(
        (kind == "number" and not is_number(value)) or (kind == "symbol" and not isinstance(value, str))
        for kind, value in zip(kinds, leaf.arguments, strict=False)
    )


def _seconds(leaf: Leaf) -> float:
    value = leaf.arguments[0] if leaf.arguments else None
    if isinstance(value, Symbolic):
        return value if value > 0 else 0.0  # type: ignore[return-value]  # arithmetic and order are those of a float
    return max(0.0, float(value)) if is_number(value) else 0.0  # type: ignore[arg-type]


def _ended(spot: Spot, leaf: Leaf, store: Store, world: World) -> Iterator[Offer]:
    """`tau:ΩB`, `tau:℧B` inside the window; urgent only at its end."""
    low, high = window(leaf, world)
    if not (_reached(leaf.age, low) and _reached(high, leaf.age)):
        return
    for ok, values in _endings(leaf, world):
        term = Ended(ok, results_of(leaf, values), "" if ok else "error" if _mistaken(leaf, world) else "failed")
        label = (leaf.name, leaf.arguments, OK if ok else AB, values)
        yield Offer(label, ((spot, term),), store, _reached(leaf.age, high))


def _reached(later: float, sooner: float) -> bool:
    """Is the one not before the other? Known instants within a TIE are one."""
    if isinstance(later, Symbolic) or isinstance(sooner, Symbolic):
        return bool(later >= sooner)
    return later >= sooner - TIE


def _endings(leaf: Leaf, world: World) -> Iterator[tuple[bool, tuple[Value, ...]]]:
    if leaf.name in ("Delay", "SUSPEND", "Term"):
        yield (True, ()) if leaf.arguments and is_number(leaf.arguments[0]) else (False, ())
    elif leaf.name in TESTS:
        yield TESTS[leaf.name](*leaf.arguments), ()
    elif _mistaken(leaf, world):
        yield False, ()
    else:
        yield from world.endings(leaf.name, leaf.arguments)


def slack(config: Config, world: World) -> float:
    """The longest time that may pass before an age window closes: inf if nothing will end by itself.

    None may pass while a step is urgent (maximal progress): ask `urgent`.
    """
    leaves = (spot.leaf for spot in config.spots())
    return min((window(i, world)[1] - i.age for i in leaves if isinstance(i, Leaf)), default=inf)


def urgent(config: Config, world: World) -> bool:
    """Is there a step that does not let time pass?"""
    return any(offer.urgent for offer in offers(config, world))


def elapsed(config: Config, seconds: float, world: World) -> Config:
    """TIME: the same configuration, `seconds` later."""
    return replace(config, roots=tuple((n, _older(t, seconds, world)) for n, t in config.roots))


def _older(term: Run, seconds: float, world: World) -> Run:
    if isinstance(term, Leaf):
        low, high = window(term, world)
        age = round(term.age + seconds, 9)
        # past its beginning, an endless window is the same at every age
        age = age if high < inf else min(age, low) if low < inf else 0.0
        return term if age == term.age else replace(term, age=age)
    parts = parts_of(term)
    older = tuple(_older(p, seconds, world) for p in parts)
    return term if all(new is old for new, old in zip(older, parts, strict=True)) else with_parts(term, older)


# ------------------------------------------------------------------------------------------------------ guards


def _posted(poster: Spot, leaf: Leaf, spots: list[Spot], config: Config) -> Iterator[Offer]:
    """`POST[n]` meets `ADD<m>`: m becomes n. A label in use is refused."""
    (label,) = leaf.arguments
    if _guards(label, spots, config):
        yield Offer(("POST", (label,), AB, ()), ((poster, Ended(False, cause="error")),), config.store)
        return
    for adder, wanted in _named(spots, "ADD", ()):
        changes = ((poster, Ended(True)), (adder, Ended(True, results_of(wanted, (label,)))))
        yield Offer(("POST", (label,), OK, ()), changes, config.store.posted(label))


def _named(spots: list[Spot], name: str, arguments: tuple[Value, ...]) -> list[tuple[Spot, Leaf]]:
    return [
        (s, s.leaf) for s in spots
        if isinstance(s.leaf, Leaf) and s.leaf.name == name and not s.leaf.problem and s.leaf.arguments == arguments
    ]  # fmt: skip


def _guards(label: Value, spots: list[Spot], config: Config) -> list[tuple[Spot, Group]]:
    """Every `E[label]` that guards something, with the `#` in which it stands."""
    found = ((guard, _above(guard, config)) for guard, _ in _named(spots, "E", (label,)))
    return [(guard, group) for guard, group in found if isinstance(group, Group) and group.operator == "#"]


def _above(spot: Spot, config: Config) -> Run | None:
    """The term of which this is a part."""
    term = config.root(spot.root)
    for index in spot.path[:-1]:
        term = parts_of(term)[index]
    return term if spot.path else None


def _killed(killer: Spot, leaf: Leaf, spots: list[Spot], config: Config) -> Iterator[Offer]:
    """`KILL[n]` meets `E[n]`, when no body of n's reaction is in service; an absent guard is an error."""
    (label,) = leaf.arguments
    found = _guards(label, spots, config)
    if not found:
        yield Offer(("KILL", (label,), AB, ()), ((killer, Ended(False, cause="error")),), config.store)
    for guard, group in found:
        if all(resting(p) for i, p in enumerate(parts_of(group)) if i != guard.path[-1]):
            yield Offer(("KILL", (label,), OK, ()), ((killer, Ended(True)), (guard, Ended(True))), config.store)


def _retired(leaver: Spot, leaf: Leaf, spots: list[Spot], config: Config) -> Iterator[Offer]:
    """`RETIRE[n]` names `E[n]`: its reaction serves nothing that is asserted after the next RENEW."""
    (label,) = leaf.arguments
    if _guards(label, spots, config):
        yield Offer(("RETIRE", (label,), OK, ()), ((leaver, Ended(True)),), config.store.retire(label))
    else:
        yield Offer(("RETIRE", (label,), AB, ()), ((leaver, Ended(False, cause="error")),), config.store)


def _guarding(guard: Spot, leaf: Leaf, spots: list[Spot], config: Config) -> Iterator[Offer]:
    """E[n] guards what stands beside it in a `#`; one that guards nothing is refused, and one of two with one label."""
    mine = _guards(leaf.arguments[0], spots, config) if leaf.arguments else []
    if len(mine) > 1 or all(other is not guard for other, _ in mine):
        yield Offer(("E", leaf.arguments, AB, ()), ((guard, Ended(False, cause="error")),), config.store)


def resting(term: Run, *, sensing: bool | None = None) -> bool:
    """Is nothing of this reaction in service? It waits for a situation, or senses in the condition of a loop.

    `sensing` is decided by the outermost loop around the term: its condition (True) or its body (False).
    """
    inside = (True, False) if sensing is None else (sensing, sensing)
    match term:
        case Serve():
            return False
        case Ended() | Queued():
            return True
        case Leaf():
            return bool(sensing) or term.name in RESTING
        case Await() | Waiting():
            return bool(sensing)
        case Testing():
            return resting(term.condition, sensing=inside[0])
        case Round():
            return resting(term.body, sensing=inside[1])
        case Spawning():
            return resting(term.condition, sensing=inside[0]) and all(
                resting(body, sensing=inside[1]) for body in term.bodies
            )
        case _:
            return all(resting(p, sensing=sensing) for p in parts_of(term))


def _frozen(freezer: Spot, leaf: Leaf, spots: list[Spot], config: Config) -> Iterator[Offer]:
    """`FREEZE[s]`: INHIBIT[s], and the bodies in service of s and below it abort; their instances stay on.

    It aborts itself if it stands in one of them.
    """
    (situation,) = leaf.arguments
    store = config.store.inhibit(str(situation), freezer.root, "inhibit")
    changes: list[tuple[Spot, Run]] = [(freezer, Ended(True))]
    for spot in _in_service(config, str(situation)):
        if spot.root == freezer.root and freezer.path[: len(spot.path)] == spot.path:
            yield Offer(("FREEZE", leaf.arguments, AB, ()), ((freezer, Ended(False, cause="error")),), config.store)
            return
        store = abort(parts_of(spot.leaf)[0], store, spot.root)
        changes.append((spot, with_parts(spot.leaf, (Ended(False, cause="frozen"),))))
    yield Offer(("FREEZE", leaf.arguments, OK, ()), tuple(changes), store)


def _in_service(config: Config, situation: str) -> Iterator[Spot]:
    """FREEZE: the outermost bodies in service of instances of the situation, or below them."""
    waiting: list[tuple[int, Path, Run]] = [(number, (), term) for number, term in reversed(config.roots)]
    while waiting:
        root, path, term = waiting.pop()
        if isinstance(term, Serve) and config.store.above(term.instance, situation):
            yield Spot(root, path, term)
        else:
            waiting += reversed([(root, (*path, n), part) for n, part in enumerate(parts_of(term))])


MEETINGS: dict[str, Meeting] = {
    "OUT": _communicated,
    "POST": _posted,
    "KILL": _killed,
    "RETIRE": _retired,
    "E": _guarding,
    "FREEZE": _frozen,
}

PASSIVE = frozenset({"NIL", "IN", "ADD"})
"""Leaves that have no step of their own."""

RESTING = frozenset({"NIL", "E", "ADD", "SIT", "DISABLED", "ENABLED", "ASSUMONITOR", "HOLDMONITOR"})
"""Leaves at which a reaction may be removed: nothing has begun."""
