"""Random nets: a few processes side by side that meet at ports, choose, loop, and now and then assert situations."""

from __future__ import annotations

import random

from planner_reactor.rs.configurations import Config, World, spawned_situations
from planner_reactor.rs.evolves import started
from planner_reactor.rs.parser import parse_process
from planner_reactor.rs.terms import Program
from planner_reactor.rs.vocabulary import BUILT_IN, Signature

OPEN = (0.0, float("inf"))
SIGNATURES = {**BUILT_IN, **{name: Signature(name, window=OPEN) for name in "ab"}}


def endings(name: str, arguments: tuple[object, ...]) -> list[tuple[bool, tuple[object, ...]]]:
    return [(True, ()), (False, ())] if name == "b" else [(True, ())]


class Nets:
    """The text of the net with this number."""

    def __init__(self, seed: int, *, delays: bool = False) -> None:
        self.draw = random.Random(f"net {seed}")
        self.delays = delays
        self.names = 0

    def text(self) -> str:
        count = self.draw.choice([2, 2, 3, 3, 4])
        parts = [self.process(self.draw.choice([1, 2, 2])) for _ in range(count)]
        if self.draw.random() < 0.3:
            parts += self.situation()
        return self.draw.choice([" | ", " & "]).join(f"({part})" for part in parts)

    def situation(self) -> list[str]:
        k = self.fresh()
        body = self.draw.choice(["a", "b", f"IN[p]<{self.fresh()}>", "OUT[q, 1]"])
        driver = self.draw.choice(["ASSERT[s]", "ASSERT[s] ; ASSERT[s]"])
        return [f"SIT[s]<{k}> :; (({body}) ; SUCCEED[s, {k}])", driver]

    def fresh(self) -> str:
        self.names += 1
        return f"x{self.names}"

    def process(self, depth: int) -> str:
        if depth == 0:
            return self.leaf()
        left, right = f"({self.process(depth - 1)})", f"({self.process(depth - 1)})"
        kind = self.draw.choice([";", ";", ":", ":", "|", "&", "#", "loop", "~", "pass", "if"])
        if kind == "~":
            return f"~{left}"
        if kind == "if":
            return f"if {self.leaf()} then {left} else {right}"
        if kind == "loop":
            x = self.fresh()
            condition = self.draw.choice([f"IN[{self.port()}]<{x}>", "a", "b", f"OUT[{self.port()}, 1]"])
            return f"{condition} :; {left}"
        if kind == "pass":
            x = self.fresh()
            return f"IN[{self.port()}]<{x}> : (if GTR[{x}, 1] then OUT[{self.port()}, {x}] else {right})"
        return f"{left} {kind} {right}"

    def port(self) -> str:
        return self.draw.choice("pqr")

    def leaf(self) -> str:
        kinds = ["a", "b", "IN", "OUT", "IN", "OUT", "STOP", "ABORT"] + ["Delay[1]", "Delay[2]"] * self.delays
        kind = self.draw.choice(kinds)
        if kind == "IN":
            return f"IN[{self.port()}]<{self.fresh()}>"
        return f"OUT[{self.port()}, {self.draw.choice('12')}]" if kind == "OUT" else kind


def begun(text: str) -> tuple[Config, World]:
    process = parse_process(text)
    world = World(signatures=SIGNATURES, endings=endings, spawned=spawned_situations(Program(), process))
    return started(process, world), world
