"""Transition systems as texts that others read: AUT (Aldebaran, read by CADP and mCRL2), DOT (Graphviz), Promela."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

import msgspec

from planner_reactor.analysis.equivalence import Behaviour
from planner_reactor.analysis.labels import show_label
from planner_reactor.analysis.transitions import Move, Transitions


class Graph(msgspec.Struct, frozen=True):
    """What is written: moves, and which of the states that nothing leaves are deadlocks."""

    moves: Sequence[Sequence[Move]]
    deadlocks: frozenset[int]

    @property
    def size(self) -> int:
        return sum(map(len, self.moves))

    @property
    def over(self) -> frozenset[int]:
        """The states in which everything has ended."""
        return frozenset(n for n, moves in enumerate(self.moves) if not moves) - self.deadlocks


def graph(found: Transitions | Behaviour) -> Graph:
    """A transition system, or a reduced one, to be written."""
    if isinstance(found, Transitions):
        return Graph(found.moves, frozenset(found.deadlocks))
    stuck = (n for n, (moves, end) in enumerate(zip(found.moves, found.ends, strict=True)) if not moves and end is None)
    return Graph(found.moves, frozenset(stuck))


def aut(found: Graph) -> str:
    """`des (first, transitions, states)` and a line for each transition."""
    lines = [f"des (0, {found.size}, {len(found.moves)})"]
    lines += [
        f"({here}, {json.dumps(show_label(label), ensure_ascii=False)}, {after})"
        for here, moves in enumerate(found.moves)
        for label, after in moves
    ]
    return "\n".join(lines) + "\n"


def dot(found: Graph, *, name: str = "transitions") -> str:
    """A drawing: deadlocks are filled, states in which all has ended have a double line."""
    lines = [f"digraph {json.dumps(name)} {{", '  rankdir=LR; node [shape=circle, label="", width=0.25];']
    lines += _states(found)
    for here, moves in enumerate(found.moves):
        together: dict[int, list[str]] = {}
        for label, after in moves:
            together.setdefault(after, []).append(show_label(label))
        for after, labels in together.items():
            lines.append(f"  {here} -> {after} [label={json.dumps(chr(10).join(labels), ensure_ascii=False)}];")
    return "\n".join([*lines, "}"]) + "\n"


def _states(found: Graph) -> Iterator[str]:
    for state in sorted(found.deadlocks):
        yield f'  {state} [style=filled, fillcolor="#c0392b"];'
    for state in sorted(found.over):
        yield f"  {state} [shape=doublecircle];"
    yield "  start [shape=point]; start -> 0;"


def one_process(found: Graph, *, title: str) -> str:
    """Promela with the whole system as one process: what there is where time passes for all cells together."""
    names = [f"end_{n}" if n in found.over else f"at_{n}" for n in range(len(found.moves))]
    lines = [f"/* {title}: {len(names)} states, as one process; made by planner-reactor lts */", ""]
    lines += ["active proctype system() {"]
    for here, moves in enumerate(found.moves):
        options = [
            f"  :: {'true' if after != here else '(_pid >= 0)'} -> goto {names[after]} "
            f"/* {show_label(label).replace('*/', '* /')} */"
            for label, after in moves
        ]
        lines += [f"{names[here]}:", *(["  if", *options, "  fi;"] if options else ["  false;"])]
    return "\n".join([*lines, "}"]) + "\n"
