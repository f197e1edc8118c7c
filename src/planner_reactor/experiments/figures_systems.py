"""Small transition systems as drawings: states in columns by their distance from the first, moves as arrows.

Two robots that need the same two tools, whole and reduced, and a patient visitor: the pictures of docs/analysis.md.
`python -m planner_reactor.experiments.figures_systems DIRECTORY` draws them.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path

import matplotlib
from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch

from planner_reactor.analysis.equivalence import at_ports, reduced, seen
from planner_reactor.analysis.exports import Graph, graph
from planner_reactor.analysis.labels import show_label
from planner_reactor.analysis.transitions import Transitions, build
from planner_reactor.experiments import figures_style as style
from planner_reactor.rs.configurations import World
from planner_reactor.rs.evolves import started
from planner_reactor.rs.loading import load, load_process
from planner_reactor.rs.vocabulary import Signature

SIZE = (9.2, 4.6)
"""Inches."""

AT_ANY_TIME = (0.0, float("inf"))

TOOLS = """
Careless = (Robot[left, drop_left, right, drop_right] & Robot[right, drop_right, left, drop_left]) # Tools
Careful = (Robot[left, drop_left, right, drop_right] & Robot[left, drop_left, right, drop_right]) # Tools
Robot[one, drop_one, other, drop_other] = OUT[one, 1] : OUT[other, 1] : Work : OUT[drop_other, 1] : OUT[drop_one, 1]
Tools = Tool[left, drop_left] | Tool[right, drop_right]
Tool[take, drop] = IN[take]<x> :; IN[drop]<y>
"""
"""Two robots need two tools. If they reach for them in opposite order, each may come to wait for the other."""


def tools(name: str) -> Transitions:
    """The transition system of `Careless` or of `Careful`."""
    signatures = {"Work": Signature("Work", window=AT_ANY_TIME)}
    program = load(TOOLS, signatures=signatures)
    world = World(program, signatures, endings=lambda name, arguments: [(True, ())])
    return build(started(load_process(name, given=program, signatures=signatures), world), world)


def draw_systems(directory: Path) -> list[Path]:
    """Write `transition-systems.png` and `.svg`."""
    careless, careful = tools("Careless"), tools("Careful")
    hidden = at_ports("left", "right", "drop_left", "drop_right")
    panels = {
        "opposite order": graph(careless),
        "opposite order, tools hidden": graph(reduced(seen(careless), hidden=hidden)),
        "same order, tools hidden": graph(reduced(seen(careful), hidden=hidden)),
    }
    with matplotlib.rc_context(style.STYLE):
        figure = style.canvas(*SIZE)
        draw(figure.add_axes((0.01, 0.36, 0.98, 0.58)), panels["opposite order"], "opposite order: every state")
        for n, name in enumerate(list(panels)[1:]):
            draw(figure.add_axes((0.01 + 0.5 * n, 0.02, 0.48, 0.24)), panels[name], name)
    return style.save(figure, directory, "transition-systems")


def draw(axes: Axes, found: Graph, title: str) -> None:
    """One system: the first state is at the left, deadlocks are red, ends have a ring."""
    places = laid_out(found)
    axes.set_axis_off()
    axes.set_title(title, fontsize=9, loc="left")
    axes.set_aspect("auto")
    for here, moves in enumerate(found.moves):
        together: dict[int, list[str]] = {}
        for label, after in moves:
            together.setdefault(after, []).append(show_label(label))
        for after, labels in together.items():
            _arrow(axes, places, here, after, "\n".join(labels))
    for state, (x, y) in places.items():
        colour = style.VERMILLION if state in found.deadlocks else "white" if state else style.SKY
        ring = 2.2 if state in found.over else 0.9
        axes.plot([x], [y], "o", markersize=8, markerfacecolor=colour, markeredgecolor="black", markeredgewidth=ring,
                  zorder=3)  # fmt: skip
    axes.margins(0.05, 0.12)


def laid_out(found: Graph) -> Mapping[int, tuple[float, float]]:
    """A place for each state: its column is its distance, its row that of the states before it, in order."""
    distance = {0: 0}
    waiting = [0]
    for here in waiting:  # grows while it is read
        for _, after in found.moves[here]:
            if after not in distance:
                distance[after] = distance[here] + 1
                waiting.append(after)
    columns: dict[int, list[int]] = {}
    for state in waiting:
        columns.setdefault(distance[state], []).append(state)
    return {
        state: (float(column), (len(states) - 1) / 2 - row)
        for column, states in columns.items()
        for row, state in enumerate(states)
    }


def _arrow(axes: Axes, places: Mapping[int, tuple[float, float]], here: int, after: int, text: str) -> None:
    (x, y), (to_x, to_y) = places[here], places[after]
    back = to_x <= x
    bend = 0.35 if back else 0.0
    if here == after:
        axes.annotate(text, (x, y), xytext=(0, 12), textcoords="offset points", fontsize=6, ha="center")
        return
    axes.add_patch(FancyArrowPatch(
        (x, y), (to_x, to_y), arrowstyle="-|>", mutation_scale=7, shrinkA=5, shrinkB=5, linewidth=0.7, color="0.35",
        connectionstyle=f"arc3,rad={bend}", zorder=1,
    ))  # fmt: skip
    middle = ((x + to_x) / 2, (y + to_y) / 2 - (0.25 * abs(to_x - x) * bend * 2 if back else 0.0))
    axes.text(*middle, text, fontsize=6, ha="center", va="center", zorder=2,
              bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.85})  # fmt: skip


if __name__ == "__main__":
    for path in draw_systems(Path(sys.argv[1])):
        print(path)
