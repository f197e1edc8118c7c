"""The networks of the second paper, drawn from the texts of the models: X Figs 3, 5, 6, 7 and 8.

Reactions above, the sensory-motor interface between, the environment below, as in the paper. Components, processes of
the interface and actions are boxes, ports are arrows from whoever writes to whoever reads; nothing is listed here but
which actions a figure shows. `python -m planner_reactor.experiments.figures_networks DIRECTORY` draws them.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import matplotlib
from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

from planner_reactor.analysis.denseness import Netlist, asked, opened
from planner_reactor.analysis.subnets import traffic
from planner_reactor.experiments import figures_style as style
from planner_reactor.planner.dynamics import Dynamics, derive
from planner_reactor.planner.exploiting_text import DerivedAction
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.printer import show
from planner_reactor.workcell.environments.dynamics import host, model

Point = tuple[float, float]
WIDTH, HEIGHT = 1.7, 0.55
"""Of a box, in units of the drawing; a column is 2.6 wide, a row 1.5 high."""
COLUMN, ROW, LEAST = 2.6, 1.5, 4.6


class Picture(NamedTuple):
    """A figure: the model, its process, the actions above (none: the interface stands alone), and its title."""

    model: str
    process: str
    actions: tuple[str, ...]
    title: str


PICTURES: Mapping[str, Picture] = {
    "x-fig3": Picture("tracking", "TEM[p, a]", (), "Fig. 3  the tracking environment, and the interface to it"),
    "x-fig5": Picture("tracking", "TEM[p, a]", ("LOOK", "MOVECAMERA"), "Fig. 5  the tracking reaction"),
    "x-fig6": Picture("guarded_move", "GEM[p, a, pr]", (), "Fig. 6  the guarded motion environment"),
    "x-fig7": Picture("guarded_move", "GEM[p, a, pr]", ("LOOK", "MOVETOWARDS", "CONTACT"),
                      "Fig. 7  the guarded motion reaction"),
    "x-fig8": Picture("belt", "BEM[p, a, pr]", ("WAITFOROBJECT", "CONTACT"),
                      "Fig. 8  the belt environment, and the guarded wait"),
}  # fmt: skip


class Box(NamedTuple):
    """What is drawn: its text, its ports, and where."""

    text: str
    reads: frozenset[str]
    writes: frozenset[str]
    at: Point
    colour: str


def draw_networks(directory: Path) -> list[Path]:
    """Write all of them as PNG and SVG."""
    return [path for name, picture in PICTURES.items() for path in _drawn(name, picture, directory)]


def boxes(picture: Picture) -> list[Box]:
    """The boxes of a figure, from the model's text alone."""
    found = derive(parse_program(model(picture.model)), picture.process, signatures=host.signatures)
    world = opened(parse_program(model(picture.model)), host.signatures)
    nets = Netlist(asked(picture.process, world, {}), world)
    outside = {c.outer for c in found.interface}
    own = [_of_component(n, nets) for n in range(len(nets.components))]
    near = [n for n, (_, reads, writes) in enumerate(own) if (reads | writes) & outside]
    inner = [n for n in range(len(own)) if n not in near]
    at = {n: (COLUMN * i, ROW) for i, n in enumerate(near)}
    at |= {n: (COLUMN * (i + 0.5), 0.0) for i, n in enumerate(inner)}
    environment = [Box(*own[n], at[n], style.SKY) for n in range(len(own))]
    return [*environment, *_interface(found, environment), *_actions(found, picture.actions, environment)]


def _of_component(number: int, nets: Netlist) -> tuple[str, frozenset[str], frozenset[str]]:
    ports = traffic(nets.components[number], nets.world)
    reads = frozenset(map(str, ports.reads))
    return show(nets.components[number]), reads, frozenset(map(str, ports.writes | ports.streams))


def _interface(found: Dynamics, environment: Sequence[Box]) -> list[Box]:
    """Each process above the component that it is connected to; two of one component side by side."""
    made: list[Box] = []
    taken: dict[float, int] = {}
    beside: dict[float, int] = {}
    below = [next(b for b in environment if c.outer in b.reads | b.writes and b.at[1] == ROW) for c in found.interface]
    for box in below:
        beside[box.at[0]] = beside.get(box.at[0], 0) + 1
    for connector, box in zip(found.interface, below, strict=True):
        column = box.at[0]
        place = taken[column] = taken.get(column, 0) + 1
        shift = 0.0 if beside[column] == 1 else (place - 1.5) * 1.25
        ports = frozenset([connector.outer]), frozenset([connector.inner])
        reads, writes = ports if connector.kind == "sensory" else (ports[1], ports[0])
        made.append(Box(connector.process.name, reads, writes, (column + shift, 2 * ROW), style.ORANGE))
    return made


def _actions(found: Dynamics, names: Sequence[str], environment: Sequence[Box]) -> list[Box]:
    """The actions of a reaction; an output of one is connected with the inputs of the others."""
    shown = [a for name in names for a in found.actions if a.name == name]
    width = max((b.at[0] for b in environment), default=0.0)
    gap = width / max(1, len(shown) - 1) if len(shown) > 1 else 0.0
    return [_action(a, (max(gap, 2.2) * n, 3.15 * ROW)) for n, a in enumerate(shown)]


def _action(action: DerivedAction, at: Point) -> Box:
    senses = action.role in ("report", "contact", "signal")
    reads = frozenset([*(action.ports if senses else ()), *("p" for _ in action.inputs)])
    writes = frozenset([*(() if senses else action.ports), *("p" for _ in action.outputs)])
    return Box(action.name, reads, writes, at, style.GREEN)


# ------------------------------------------------------------------------------------------------------- drawing


def _drawn(name: str, picture: Picture, directory: Path) -> list[Path]:
    found = boxes(picture)
    right = max(b.at[0] for b in found)
    top = max(b.at[1] for b in found)
    with matplotlib.rc_context(style.STYLE):
        right = max(right, LEAST)
        figure = style.canvas(0.72 * (right + 3.2), 0.72 * (top + 2.0))
        axes = figure.add_axes((0.0, 0.0, 1.0, 0.93))
        axes.set_axis_off()
        axes.set_xlim(-1.6, right + 1.6)
        axes.set_ylim(-0.7, top + 0.7)
        line = 2 * ROW
        axes.axhline(line, color=style.PALE, linewidth=14, zorder=0)
        for text, height in (("interface", line), ("environment", 0.0), ("reactions", top)):
            if text != "reactions" or picture.actions:
                axes.text(-1.55, height + 0.42, text, fontsize=7, color=style.GREY, ha="left")
        _arrows(axes, found)
        for box in found:
            _box(axes, box)
        figure.text(0.02, 0.955, picture.title, fontsize=10, fontweight="bold")
    return style.save(figure, directory, name)


def _box(axes: Axes, box: Box) -> None:
    x, y = box.at
    size = min(8.5, 8.5 * 1.45 * 72 * 0.72 / max(1.0, style.text_width(box.text, 8.5)))
    half = _half(box)
    axes.add_patch(
        FancyBboxPatch((x - half, y - HEIGHT / 2), 2 * half, HEIGHT, boxstyle="round,pad=0.0,rounding_size=0.1",
                       facecolor="white", edgecolor=box.colour, linewidth=1.6, zorder=2)
    )  # fmt: skip
    axes.text(x, y, box.text, ha="center", va="center", fontsize=size, zorder=3)


def _half(box: Box) -> float:
    return WIDTH / 2 if box.colour != style.ORANGE else 0.56


def _arrows(axes: Axes, found: Sequence[Box]) -> None:
    """An arrow for each port from its writer to each reader, its name beside the middle."""
    for writer in found:
        for port in sorted(writer.writes):
            for reader in found:
                if port not in reader.reads or reader is writer:
                    continue
                start, end = _ends(writer, reader)
                level = abs(start[1] - end[1]) < 0.1
                bend = 0.0 if level or abs(start[0] - end[0]) <= 0.2 else 0.12
                axes.add_patch(
                    FancyArrowPatch(start, end, arrowstyle="-|>", mutation_scale=10, color=style.INK, linewidth=1.0,
                                    connectionstyle=f"arc3,rad={bend}", shrinkA=1, shrinkB=1, zorder=1)
                )  # fmt: skip
                x, y = (start[0] + end[0]) / 2, (start[1] + end[1]) / 2
                _label(axes, (x - 0.08, y + 0.2) if level else (x + 0.09, y), port)


def _label(axes: Axes, at: Point, port: str) -> None:
    behind = {"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.85}
    axes.text(*at, port, fontsize=8, style="italic", color=style.BLUE, zorder=4, bbox=behind)


def _ends(writer: Box, reader: Box) -> tuple[Point, Point]:
    """Where an arrow leaves one box and enters the other: at the sides that face each other."""
    (ax, ay), (bx, by) = writer.at, reader.at
    if abs(ay - by) < 0.1:
        side = 1 if bx > ax else -1
        return (ax + side * _half(writer), ay), (bx - side * _half(reader), by)
    up = 1 if by > ay else -1
    lean = max(-0.35, min(0.35, (bx - ax) * 0.12))
    return (ax + lean, ay + up * HEIGHT / 2), (bx - lean, by - up * HEIGHT / 2)


if __name__ == "__main__":
    for path in draw_networks(Path(sys.argv[1])):
        print(path)
