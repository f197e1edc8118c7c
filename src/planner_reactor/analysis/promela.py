"""Promela: automata as a model for SPIN, with one SPIN state for each of ours.

Each cell is a process whose control states are the cell's states; a rendezvous is a channel without a buffer, its
values numbered. A state of a cell that is over is a valid end; SPIN's "invalid end state" is our deadlock.

G. J. Holzmann, The SPIN Model Checker, 2004.
"""

from __future__ import annotations

from collections.abc import Iterator

from planner_reactor.analysis.automata import Automata, Automaton
from planner_reactor.analysis.labels import show_label
from planner_reactor.rs.terms import Value

GOES_ON = "true"
STAYS = "(_pid >= 0)"
"""Always so as well; SPIN refuses an unconditional loop at one state."""


def promela(automata: Automata, *, title: str = "") -> str:
    """The text of a model."""
    ports, values = _numbered(automata)
    head = title or "A network of RS processes"
    lines = [f"/* {_comment(head)}: {len(automata.cells)} cells", " * made by planner-reactor lts"]
    lines += [f" * port {n}: {port}" for port, n in ports.items()]
    lines += [f" * value {n}: {value}" for value, n in values.items()]
    lines += [" */"]
    kind = "byte" if len(values) < 256 else "int"
    lines += [f"chan port_{n} = [0] of {{ {kind} }};" for n in ports.values()]
    for number, cell in enumerate(automata.cells, 1):
        lines += ["", f"active proctype cell_{number}() {{", *_states(cell, ports, values), "}"]
    return "\n".join(lines) + "\n"


def _numbered(automata: Automata) -> tuple[dict[Value, int], dict[Value, int]]:
    ports: dict[Value, int] = {}
    values: dict[Value, int] = {}
    for cell in automata.cells:
        for row in (*cell.writes, *cell.reads):
            for port, value, _ in row:
                ports.setdefault(port, len(ports))
                values.setdefault(value, len(values))
    return ports, values


def _states(cell: Automaton, ports: dict[Value, int], values: dict[Value, int]) -> Iterator[str]:
    names = [f"end_{s}" if over else f"at_{s}" for s, over in enumerate(cell.over)]
    for s in range(len(cell)):
        options = [
            f"{GOES_ON if after != s else STAYS} -> goto {names[after]} /* {_comment(show_label(label))} */"
            for label, after in cell.own[s]
        ]
        options += [f"port_{ports[p]}!{values[v]} -> goto {names[after]}" for p, v, after in cell.writes[s]]
        options += [f"port_{ports[p]}?{values[v]} -> goto {names[after]}" for p, v, after in cell.reads[s]]
        yield f"{names[s]}:"
        if options:
            yield from ("  if", *(f"  :: {option}" for option in options), "  fi;")
        else:
            yield "  false;"


def _comment(text: str) -> str:
    return text.replace("*/", "* /")
