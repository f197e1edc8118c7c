"""Transition systems as texts that others read: AUT (Aldebaran, read by CADP and mCRL2) and DOT (Graphviz)."""

from __future__ import annotations

import json
from collections.abc import Iterator

from planner_reactor.analysis.transitions import Transitions
from planner_reactor.rs.configurations import Label
from planner_reactor.rs.terms import Value


def readable(label: Label) -> str:
    """A label as people write it: `SIT[order] stop 1`, `p!3`, `2 s`."""
    name, arguments, status, values = label
    if name == "TIME":
        return f"{_value(arguments[0])} s"
    if name == "COM":
        return f"{_value(arguments[0])}!{_value(arguments[1])}"
    called = name + (f"[{', '.join(map(_value, arguments))}]" if arguments else "")
    how = {"ok": "stop", "ab": "abort", "wait": "waits"}[status]
    return " ".join((called, how, *map(_value, values)))


def _value(value: Value) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def aut(transitions: Transitions) -> str:
    """`des (first, transitions, states)` and a line for each transition."""
    lines = [f"des (0, {transitions.size}, {len(transitions)})"]
    lines += [
        f"({here}, {json.dumps(readable(label), ensure_ascii=False)}, {after})"
        for here, moves in enumerate(transitions.moves)
        for label, after in moves
    ]
    return "\n".join(lines) + "\n"


def dot(transitions: Transitions, *, name: str = "transitions") -> str:
    """A drawing: deadlocks are filled, states in which all has ended have a double line."""
    lines = [f"digraph {json.dumps(name)} {{", "  rankdir=LR; node [shape=circle, label=\"\", width=0.25];"]
    lines += [*_states(transitions)]
    for here, moves in enumerate(transitions.moves):
        together: dict[int, list[str]] = {}
        for label, after in moves:
            together.setdefault(after, []).append(readable(label))
        for after, labels in together.items():
            text = json.dumps("\n".join(labels), ensure_ascii=False)
            lines.append(f"  {here} -> {after} [label={text}];")
    return "\n".join([*lines, "}"]) + "\n"


def _states(transitions: Transitions) -> Iterator[str]:
    stuck = set(transitions.deadlocks)
    for state in transitions.ends:
        look = 'style=filled, fillcolor="#c0392b"' if state in stuck else "shape=doublecircle"
        yield f"  {state} [{look}];"
    yield "  start [shape=point]; start -> 0;"
