"""Draws a hierarchy as R Figs 8 to 10 do: light arrows for situations, dark ones for what is done in them.

Top-down, from left to right in the order of time; what goes on at once stands one below the other behind a bracket
with its operator. Assumptions are small flags on the arrows. Works in points; the figure is as large as it must be.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch, Polygon

from planner_reactor.experiments import figures_style as style
from planner_reactor.experiments.hierarchy import Act, AtOnce, InOrder, Node, Part, folded

ROW, GAP, LANE_GAP, POINT, PAD, BRACKET, MARGIN = 21.0, 5.0, 7.0, 6.0, 7.0, 15.0, 14.0
SIZE, FLAG_SIZE = 8.0, 6.6
LIGHT, LIGHT_EDGE, DARK, STUB, FLAG = "#DCE8F2", "#6F93B3", "#1F4E79", "#FFFFFF", "#F6C9A8"
HEAD, FOOT = 44.0, 40.0
LEAST_WIDTH, MOST_WIDTH = 520.0, 900.0
LOOKS: dict[str, tuple[str, str, str, Any]] = {  # face, edge, ink, dashes
    "light": (LIGHT, LIGHT_EDGE, style.INK, "-"),
    "dark": (DARK, DARK, "white", "-"),
    "elsewhere": ("white", LIGHT_EDGE, style.INK, (0, (3, 2))),
    "stub": (STUB, style.VERMILLION, style.VERMILLION, (0, (3, 2))),
}
NAMES = {"light": "situation", "dark": "reaction", "elsewhere": "shown above", "stub": "stub, not refined yet"}
SIGNS = {
    "&": "& all of these at once",
    "|": "| these at once",
    "#": "# until the first of them ends",
    "if": "if: one or the other, by the test before",
    "then": "then: line after line",
}


def draw_hierarchy(title: str, subtitle: str, roots: Sequence[Node], notes: Sequence[str] = ()) -> Figure:
    """A figure of these roots, one below the other; `notes` stand beneath it."""
    roots = [folded(root, _width, MOST_WIDTH) for root in roots]
    looks = {_look(node) for root in roots for node in _all(root)}
    signs = sorted({node.sign for root in roots for node in _all(root) if isinstance(node, AtOnce)})
    legend = [text for sign, text in SIGNS.items() if sign in signs]
    width = max(
        [
            LEAST_WIDTH,
            style.text_width(title, 10.5) * 1.1,
            style.text_width(subtitle, SIZE),
            *(_width(root) for root in roots),
        ]
    )
    tall = sum(_height(root) + LANE_GAP for root in roots)
    foot = FOOT + 12 * len(notes)
    size = (width + 2 * MARGIN, tall + HEAD + foot)
    figure = style.canvas(size[0] / 72, size[1] / 72)
    with matplotlib.rc_context(style.STYLE):
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set(xlim=(0, size[0]), ylim=(size[1], 0))
        axes.axis("off")
        axes.text(MARGIN, 15, title, fontsize=10.5, fontweight="bold", va="center")
        axes.text(MARGIN, 30, subtitle, fontsize=SIZE, color=style.GREY, va="center")
        top = HEAD
        for root in roots:
            _draw(axes, root, MARGIN, top, width)
            top += _height(root) + LANE_GAP
        _key(axes, top + 12, looks, legend)
        for n, note in enumerate(notes):
            axes.text(MARGIN, top + 30 + 12 * n, note, fontsize=7.5, color=style.INK, va="center")
    return figure


def _all(node: Node) -> list[Node]:
    match node:
        case Act():
            return [node]
        case Part(inside=inside):
            return [node, *(_all(inside) if inside is not None else [])]
        case InOrder(parts) | AtOnce(_, parts):
            return [node, *(found for part in parts for found in _all(part))]


def _look(node: Node) -> str:
    match node:
        case Act(stub=stub):
            return "stub" if stub else "dark"
        case Part(inside=inside):
            return "light" if inside is not None else "elsewhere"
        case _:
            return ""


# -- how large


def _flags(tags: Sequence[str]) -> float:
    return sum(style.text_width(tag, FLAG_SIZE) + 9 for tag in tags)


def _own(label: str, tags: Sequence[str]) -> float:
    return style.text_width(label, SIZE) + _flags(tags) + 2 * PAD + POINT


def _width(node: Node) -> float:
    match node:
        case Act(label=label, tags=tags):
            return _own(label, tags)
        case Part(label=label, inside=inside, tags=tags):
            return max(_own(label, tags), 0.0 if inside is None else _width(inside))
        case InOrder(parts):
            return sum(map(_width, parts)) + GAP * (len(parts) - 1)
        case AtOnce(_, lanes):
            return max(map(_width, lanes)) + BRACKET


def _height(node: Node) -> float:
    match node:
        case Act():
            return ROW
        case Part(inside=inside):
            return ROW + (0.0 if inside is None else GAP + _height(inside))
        case InOrder(parts):
            return max(map(_height, parts))
        case AtOnce(_, lanes):
            return sum(map(_height, lanes)) + LANE_GAP * (len(lanes) - 1)


# -- the drawing


def _draw(axes: Axes, node: Node, left: float, top: float, width: float) -> None:
    match node:
        case Act(label=label, tags=tags):
            _arrow(axes, left, top, width, label, tags, look=_look(node))
        case Part(label=label, inside=inside, tags=tags):
            _arrow(axes, left, top, width, label, tags, look=_look(node))
            if inside is not None:
                _draw(axes, inside, left, top + ROW + GAP, width)
        case InOrder(parts):
            spare = (width - _width(node)) / sum(map(_width, parts))
            for part in parts:
                wide = _width(part) * (1 + spare)
                _draw(axes, part, left, top, wide)
                left += wide + GAP
        case AtOnce(sign, lanes):
            tall = _height(node)
            _bracket(axes, left, top, tall, sign)
            for lane in lanes:
                _draw(axes, lane, left + BRACKET, top, width - BRACKET)
                top += _height(lane) + LANE_GAP


def _arrow(axes: Axes, left: float, top: float, width: float, label: str, tags: Sequence[str], *, look: str) -> None:
    tip, middle, low = left + width, top + ROW / 2, top + ROW
    corners = [(left, top), (tip - POINT, top), (tip, middle), (tip - POINT, low), (left, low)]
    face, edge, ink, dash = LOOKS[look]
    axes.add_patch(Polygon(corners, closed=True, facecolor=face, edgecolor=edge, linewidth=0.9, linestyle=dash))
    axes.text(left + PAD, middle + 0.5, label, fontsize=SIZE, color=ink, va="center", ha="left")
    right = tip - POINT - PAD + 3
    for tag in reversed(tags):
        wide = style.text_width(tag, FLAG_SIZE) + 6
        box = FancyBboxPatch(
            (right - wide, middle - 6), wide, 12, boxstyle="round,pad=0,rounding_size=2.5", linewidth=0, facecolor=FLAG
        )
        axes.add_patch(box)
        axes.text(right - wide / 2, middle + 0.5, tag, fontsize=FLAG_SIZE, color=style.INK, va="center", ha="center")
        right -= wide + 3


def _bracket(axes: Axes, left: float, top: float, tall: float, sign: str) -> None:
    x = left + BRACKET - 4
    axes.plot([x, x - 3, x - 3, x], [top + 1, top + 1, top + tall - 1, top + tall - 1], color=style.GREY, linewidth=1.0)
    axes.text(
        left + BRACKET / 2 - 4, top + tall / 2, sign, fontsize=8.5, color=style.GREY, va="center", ha="center",
        rotation=90 if len(sign) > 1 else 0,
    )  # fmt: skip


def _key(axes: Axes, y: float, looks: Collection[str], legend: Sequence[str]) -> None:
    """What the arrows and signs mean, on one line."""
    x = MARGIN
    for look, (face, edge, _, dash) in LOOKS.items():
        if look not in looks:
            continue
        corners = [(x, y - 5), (x + 18, y - 5), (x + 22, y), (x + 18, y + 5), (x, y + 5)]
        axes.add_patch(Polygon(corners, closed=True, facecolor=face, edgecolor=edge, linewidth=0.9, linestyle=dash))
        axes.text(x + 27, y + 0.5, NAMES[look], fontsize=7.5, va="center")
        x += 27 + style.text_width(NAMES[look], 7.5) + 12
    for text in legend:
        axes.text(x, y + 0.5, text, fontsize=7.5, va="center", color=style.GREY)
        x += style.text_width(text, 7.5) + 12
