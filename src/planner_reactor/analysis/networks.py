"""Networks: a configuration taken apart into cells that meet at ports and in time only.

The parts that stand side by side at the top of every root (below `|` and `&`) are grouped into cells by what their
texts can touch (`footprints`). A state of the network is a vector of integers, one for each cell; its steps are those
of one cell, a rendezvous of two, or time, which passes for all together when nothing is urgent (COM, PAR, TIME). So
what `rs.evolves` works out for a cell is used in every state of the others.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import inf
from typing import Any, TypeAlias

import msgspec
from msgspec.structs import replace

from planner_reactor.analysis.cells import Cell, kept_alive
from planner_reactor.analysis.explore import canonical, renumbered
from planner_reactor.analysis.footprints import ANY, Footprint, footprint
from planner_reactor.rs.configurations import Config, Label, World
from planner_reactor.rs.evolves import terminate
from planner_reactor.rs.states import Bindings, Ended, Export, Group, InstanceNumber, Keep, Path, Run, parts_of, put
from planner_reactor.rs.store import Store
from planner_reactor.rs.terms import Value

Vector: TypeAlias = tuple[int, ...]
Step: TypeAlias = tuple[Label, Vector, bool]

STORE_KINDS = ("situation", "label", "pool")


class Part(msgspec.Struct, frozen=True):
    """A part of a root: where it stands, what it is, what it can touch."""

    root: int
    path: Path
    term: Run
    footprint: Footprint


class Network:
    """The cells of a configuration. `start` is the vector of their first states.

    `elsewhere` are roots that have parts which belong to none of the groups.
    """

    def __init__(
        self,
        config: Config,
        world: World,
        groups: Sequence[Sequence[Part]],
        *,
        elsewhere: frozenset[int] = frozenset(),
        limit: int,
    ) -> None:
        homes: dict[int, set[int]] = {}
        for number, group in enumerate(groups):
            for part in group:
                homes.setdefault(part.root, set()).add(number)
        split = frozenset(root for root, cells in homes.items() if len(cells) > 1) | elsewhere
        self.config = config
        self.world = world
        self.groups = groups
        self.cells = [_cell(config, world, group, split, limit) for group in groups]
        self.split = {root: [(c, p) for c, g in enumerate(groups) for p in g if p.root == root] for root in split}
        self._home = {root: min(cells) for root, cells in homes.items()}
        self.start: Vector = (0,) * len(self.cells)

    def steps(self, vector: Vector) -> Iterator[Step]:
        """Every step from here, time included."""
        cells = self.cells
        urgent = False
        for n, state in enumerate(vector):
            for label, after, hurries in cells[n].steps(state):
                urgent = urgent or hurries
                yield label, (*vector[:n], after, *vector[n + 1 :]), hurries
        for label, _, _, met in self.meetings(vector):
            urgent = True
            yield label, met, True
        if not urgent and (pause := min(map(Cell.pause, cells, vector), default=inf)) < inf:
            yield time_label(pause), self.later(vector, pause), False

    def meetings(self, vector: Vector) -> Iterator[tuple[Label, int, int, Vector]]:
        """Every rendezvous of two cells: label, writer, reader, vector afterwards."""
        for w, state in enumerate(vector):
            for port, value, written in self.cells[w].offered(state):
                for r, other in enumerate(vector):
                    if r != w and port in self.cells[r].ports_read(other):
                        for read in self.cells[r].taken(other, port, value):
                            after = list(vector)
                            after[w], after[r] = written, read
                            yield met_label(port, value), w, r, tuple(after)

    def later(self, vector: Vector, seconds: float) -> Vector:
        return tuple(cell.later(state, seconds) for cell, state in zip(self.cells, vector, strict=True))

    def over(self, vector: Vector) -> bool:
        """Has every root ended?"""
        return all(map(Cell.over, self.cells, vector))

    def active(self, vector: Vector, situation: str) -> bool:
        """Has this situation an instance on or in service, descendants included?"""
        pairs = zip(self.cells, vector, strict=True)
        return not all(cell.configs[state].store.quiescent(situation) for cell, state in pairs)

    def outcome(self, vector: Vector, root: int) -> tuple[bool, Bindings] | None:
        """How a root has ended, with which results; None while it runs."""
        if root in self.split:
            homes = {cell for cell, _ in self.split[root]}
            if any(not self.cells[cell].is_over(vector[cell], root) for cell in homes):
                return None
        configs = [cell.configs[state] for cell, state in zip(self.cells, vector, strict=True)]
        term = self._root(root, self.config.root(root), configs)
        return (term.ok, term.bindings) if isinstance(term, Ended) else None

    # -- back to configurations

    def decoded(self, vector: Vector) -> Config:
        """The configuration that a vector stands for, with its instances numbered anew."""
        configs = [self._numbered_apart(n, state) for n, state in enumerate(vector)]
        roots = tuple((root, self._root(root, term, configs)) for root, term in self.config.roots)
        store = Store()
        for config in configs:
            store = _joined(store, config.store)
        return canonical(Config(roots, store))

    def _numbered_apart(self, cell: int, state: int) -> Config:
        """The configuration of one cell, with numbers that no other cell has."""
        config, count = self.cells[cell].configs[state], len(self.cells)
        names = {i.number: InstanceNumber(i.number * count + cell) for i in config.store.instances}
        names |= {q.ticket: InstanceNumber(q.ticket * count - cell) for q in config.store.queue}
        apart: Config = renumbered(config, names)
        return apart

    def _root(self, root: int, term: Run, configs: Sequence[Config]) -> Run:
        if root not in self.split:
            return configs[self._home[root]].root(root)
        taken: dict[int, int] = {}
        for cell, part in self.split[root]:
            index = taken[cell] = taken.get(cell, -1) + 1
            term = put(term, part.path, parts_of(configs[cell].root(root))[index])
        return terminate(term, Store(), self.world, root)[0]


def networked(config: Config, world: World, *, limit: int) -> Network:
    """The configuration as a network of as many cells as its texts allow."""
    config = canonical(config)
    return Network(config, world, grouped(parts_of_roots(config, world), STORE_KINDS), limit=limit)


def whole(config: Config, world: World, *, limit: int) -> Network:
    """The configuration as a network of one cell."""
    config = canonical(config)
    return Network(config, world, [parts_of_roots(config, world)], limit=limit)


def parts_of_roots(config: Config, world: World) -> list[Part]:
    """What stands side by side at the top of the roots."""
    return [
        Part(root, path, term, footprint(term, world))
        for root, whole_term in config.roots
        for path, term in _side_by_side(whole_term, ())
    ]


def _side_by_side(term: Run, path: Path) -> Iterator[tuple[Path, Run]]:
    match term:
        case Export() | Keep() | Group("|" | "&"):
            for index, part in enumerate(parts_of(term)):
                yield from _side_by_side(part, (*path, index))
        case _:
            yield path, term


def grouped(parts: Sequence[Part], kinds: Sequence[str]) -> list[list[Part]]:
    """Parts that are connected by things of these kinds, in order of their first part."""
    homes = list(range(len(parts)))

    def home(n: int) -> int:
        while homes[n] != n:
            homes[n] = n = homes[homes[n]]
        return n

    def join(these: Sequence[int]) -> None:
        for n in these:
            one, other = sorted((home(n), home(these[0])))
            homes[other] = one

    for kind in kinds:
        users: dict[Value, list[int]] = {}
        for n, part in enumerate(parts):
            for thing, name in part.footprint.things:
                if thing == kind:
                    users.setdefault(name, []).append(n)
        for these in [sorted({n for u in users.values() for n in u})] if ANY in users else users.values():
            join(these)
    groups: dict[int, list[Part]] = {}
    for n, part in enumerate(parts):
        groups.setdefault(home(n), []).append(part)
    return list(groups.values())


def met_label(port: Value, value: Value) -> Label:
    return "COM", (port, value), "ok", ()


def time_label(seconds: float) -> Label:
    return "TIME", (seconds,), "ok", ()


def _cell(config: Config, world: World, group: Sequence[Part], split: frozenset[int], limit: int) -> Cell:
    roots = []
    for root, term in config.roots:
        own = tuple(part.term for part in group if part.root == root)
        if own:
            roots.append((root, kept_alive(own) if root in split else term))
    here = frozenset(root for root, _ in roots)
    return Cell(Config(tuple(roots), _store_of(config.store, group)), world, split=split & here, limit=limit)


def _store_of(store: Store, group: Sequence[Part]) -> Store:
    """What a store holds of the situations and labels of these parts."""
    things = {thing for part in group for thing in part.footprint.things}
    situations = {name for kind, name in things if kind == "situation"}
    labels = {name for kind, name in things if kind == "label"}
    numbers = {i.number for i in store.instances if i.situation in situations}
    if ANY in situations or ANY in labels:  # then nobody else has any
        return store
    kept: dict[str, Callable[[Any], bool]] = {
        "instances": lambda i: i.number in numbers,
        "inhibitions": lambda h: h.situation in situations,
        "drains": lambda d: d[0] in situations,
        "queue": lambda q: q.situation in situations,
        "run": lambda r: r[0] in numbers,
        "served": lambda s: s[1] in numbers,
        "versions": lambda v: v[0] in situations,
        "born": lambda b: b[0] in labels,
        "retired": lambda r: r[0] in labels,
    }
    return replace(store, **{f: tuple(filter(kept[f], getattr(store, f))) for f in kept if hasattr(store, f)})


def _joined(one: Store, other: Store) -> Store:
    """Stores of different cells as one."""
    pairs = ((field, getattr(one, field), getattr(other, field)) for field in one.__struct_fields__)
    both = {field: (*left, *right) for field, left, right in pairs if isinstance(left, tuple)}
    return replace(one, **both, cut=one.cut + other.cut)
