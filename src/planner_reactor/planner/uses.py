"""Facts about an environment, and ways to use its dynamics: what the derivation of actions works with (X §6.2, §6.3).

A `Use` is one way in which an agent can exploit an entry of a limit set; `exploiting` finds them, `exploiting_text`
writes them as actions. A fact holds over the interval of the action, or has to hold over one that encompasses it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any, Literal, TypeAlias

import msgspec

from planner_reactor.analysis.conditions import Atom, Event, text
from planner_reactor.analysis.denseness import Netlist
from planner_reactor.analysis.interface import Connector, carried, parameters
from planner_reactor.analysis.limits import Limit
from planner_reactor.analysis.meanings import distance, meaning
from planner_reactor.analysis.subnets import traffic
from planner_reactor.rs.configurations import World
from planner_reactor.rs.terms import Process
from planner_reactor.rs.unknowns import Compared, Unknown, unknowns

Role: TypeAlias = Literal["report", "signal", "contact", "set", "rise", "fall", "approach", "retreat", "drift"]

class Fact(msgspec.Struct, frozen=True):
    """What holds: of a subject, or (`carries`) of the value at a port. `holds` is a comparison, written out.

    `about` are the quantities of which it is said, where the subject alone does not tell (two sensors, two axes).
    """

    predicate: str
    subject: str = ""
    port: str = ""
    carries: bool = False
    holds: str = ""
    about: tuple[str, ...] = ()


class Effect(Fact, frozen=True):
    """A fact that an action brings about: as long as it goes on, or (`meets`) from its end on."""

    meets: bool = False


class Use(msgspec.Struct, frozen=True):
    """One way to exploit a dynamic.

    `sends` says what goes to each motor port, in terms of the quantities `takes` (they come in) and `knows` (the
    component's own, that the agent has to keep track of). `stem` is what the paper's prototype names it after.
    `needed` and `effects` are for the planner, `printed` the executability as the prototype would write it.
    """

    role: Role
    subject: str
    stem: str
    limit: Limit | None
    connectors: tuple[Connector, ...]
    needed: tuple[Fact, ...]
    effects: tuple[Effect, ...]
    printed: tuple[Fact, ...]
    delay: Any
    resolution: Any
    takes: tuple[Unknown, ...] = ()
    knows: tuple[Unknown, ...] = ()
    sends: tuple[Any, ...] = ()
    signal: Any = None
    presumes: tuple[str, ...] = ()


class Owner(msgspec.Struct, frozen=True):
    """The component whose parameter a quantity is."""

    component: int
    parameter: str


class Model(msgspec.Struct, frozen=True, dict=True):
    """An environment with its interface, and its limit set."""

    process: Process
    world: World
    nets: Netlist
    interface: tuple[Connector, ...]
    limits: tuple[Limit, ...]

    @cached_property
    def owners(self) -> Mapping[Unknown, Owner]:
        """The quantities of the network: the unknowns that components have as parameters."""
        found: dict[Unknown, Owner] = {}
        for number, component in enumerate(self.nets.components):
            for entry, value in parameters(component, self.world):
                if isinstance(value, Unknown):
                    found.setdefault(value, Owner(number, entry.name))
        return found

    @cached_property
    def subjects(self) -> tuple[str, ...]:
        """What each component is about: the last word of its name (BeltObject is an Object), or all if two share it."""
        full = [self.nets.name(n) for n in range(len(self.nets.components))]
        short = [(re.findall(r"[A-Z][a-z0-9_]*|[a-z0-9_]+", name) or [name])[-1] for name in full]
        return tuple(f if short.count(s) > 1 and len(set(full)) > 1 else s for f, s in zip(full, short, strict=True))

    def number(self, component: Process | None) -> int:
        return next(n for n, c in enumerate(self.nets.components) if c == component)

    def subject(self, quantity: Unknown) -> str:
        return self.subjects[self.owners[quantity].component]

    def position(self, quantity: Unknown) -> str:
        """What a quantity is called: the position of its subject, with the parameter if there are several."""
        owner = self.owners[quantity]
        several = sum(o.component == owner.component for o in self.owners.values()) > 1
        return f"{owner.parameter.title()}Position" if several else "Position"

    @cached_property
    def ambiguous(self) -> frozenset[tuple[str, str]]:
        """What is said of one subject in several ways: by two sensors, or on two axes."""
        found: dict[tuple[str, str], set[tuple[Any, ...]]] = {}
        for limit, condition in self.sensory():
            for atom in condition:
                if isinstance(atom, Event):
                    component = self.number(limit.component)
                    own = (u for u in atom.arguments if isinstance(u, Unknown) and u in self.owners)
                    others = [u for u in own if self.owners[u].component != component]
                    subject = self.subject(others[0]) if others else ""
                    found.setdefault((atom.name, subject), set()).add(atom.arguments)
        return frozenset(key for key, ways in found.items() if len(ways) > 1)

    def sensory(self) -> Iterator[tuple[Limit, tuple[Atom, ...]]]:
        """The entries that end in a sensor, each with its condition."""
        return ((limit, limit.condition) for limit in self.limits if limit.kind == "bound")


def fact_of(atom: Atom, limit: Limit | None, model: Model) -> Fact:
    """An atom of a condition as a fact about what it speaks of, with the port by which that came (housekeeping)."""
    component = model.number(limit.component) if limit is not None and limit.component is not None else -1
    reads = traffic(model.nets.components[component], model.world).reads if component >= 0 else frozenset()
    if isinstance(atom, Event):
        others = [u for u in atom.arguments if isinstance(u, Unknown) and u in model.owners]
        others = [u for u in others if model.owners[u].component != component] or others
        ports = [str(p) for p in sorted(map(str, reads)) if carried(p, model.nets) in others]
        subject = model.subject(others[0]) if others else ""
        name = atom.name if atom.ok else f"Not{atom.name}"
        about = tuple(map(str, map(repr, atom.arguments))) if (name, subject) in model.ambiguous else ()
        return Fact(name, subject, ports[0] if ports else "", about=about)
    gap = distance((atom,))
    ports = [p for p in sorted(map(str, reads)) if gap is not None and carried(p, model.nets) in (gap, -gap)]
    return Fact("Equal" if ports else "Holds", port=ports[0] if ports else "", holds=text((atom,)))


def gap_of(condition: Sequence[Atom], model: Model) -> Any:
    """D, if the condition asks that D be 0."""
    known = [c for atom in condition for c in meaning(atom, model.world) or ()]
    gap = distance(known)
    return gap if gap is not None and set(unknowns(gap)) & set(model.owners) else None


def target_of(gap: Any, limit: Limit | None, model: Model) -> Unknown:
    """The quantity of a distance that nothing of the agent's moves, or the first."""
    moved = {c for c in range(len(model.nets.components)) if _is_moved(c, model)}
    found = [u for u in unknowns(gap) if u in model.owners]
    return next((u for u in found if model.owners[u].component not in moved), found[0])


def _is_moved(component: int, model: Model) -> bool:
    ports = {c.outer for c in model.interface if c.kind == "motor"}
    return bool(traffic(model.nets.components[component], model.world).reads & ports)


def unknowns_in(atom: Atom) -> Iterator[Unknown]:
    values: Sequence[Any] = atom.arguments if isinstance(atom, Event) else (
        (atom.value,) if isinstance(atom, Compared) else (atom.left, atom.right)
    )  # fmt: skip
    for value in values:
        yield from unknowns(value)
