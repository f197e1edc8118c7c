"""Staircases in panels below each other: the one form that all traces of the papers take.

Title and legend above, what was measured beneath; thin dotted lines mark the times that the papers print. An axis
shorter than half a second is in milliseconds.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, nextafter
from typing import Any

import matplotlib
import msgspec
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from planner_reactor.experiments import figures_style as style
from planner_reactor.experiments.staircases import Staircase

WIDTH, LOW, TALL = 7.0, 2.1, 3.4
WORDS, WORDS_SIZE = 470.0, 7.6
"""Points: how wide the lines beneath a figure are, and the size of their letters."""

LEGEND = 108
"""Characters on a line of a legend."""

MARKED = "times in the paper"


class Line(msgspec.Struct, frozen=True):
    """One staircase of a panel."""

    stairs: Staircase
    label: str
    colour: str
    dashes: Any = style.SOLID
    anew: bool = False  # counted from the zero of the window


class Window(msgspec.Struct, frozen=True):
    """What part of the run is shown, in seconds; `zero` is where the axis counts from."""

    begin: float
    end: float
    zero: float = 0.0

    @property
    def unit(self) -> tuple[str, float]:
        """The unit of the axis and how many make a second."""
        return ("ms", 1000.0) if self.end - self.begin < 0.6 else ("s", 1.0)


class Beside(msgspec.Struct, frozen=True):
    """Marks at times that the papers print, and the words beneath a figure."""

    marks: Sequence[float] = ()
    words: str = ""


class Products(msgspec.Struct, frozen=True):
    """What came out of the world meanwhile."""

    noun: str
    completed: Staircase
    rejected: Staircase

    def shown(self, window: Window) -> set[str]:
        """The labels of those that fall into a window."""
        both = ((self.completed, "completed"), (self.rejected, "rejected"))
        return {f"{self.noun} {w}" for s, w in both if any(window.begin <= t <= window.end for t in s.times)}


def panels_figure(
    title: str,
    window: Window,
    panels: Sequence[tuple[str, Sequence[Line]]],
    beside: Beside,
    products: Products | None = None,
    *,
    counts: bool = True,
) -> Figure:
    """Panels below each other on one time axis, with title, legend, marks and words."""
    words = style.broken(beside.words, WORDS_SIZE, WORDS)
    shown = {line.label for _, lines in panels for line in lines} | (products.shown(window) if products else set())
    shown |= {MARKED} if any(window.begin <= t <= window.end for t in beside.marks) else set()
    rows = 1 if sum(map(len, shown)) + 9 * len(shown) <= LEGEND else 2
    body = LOW if len(panels) == 1 else TALL
    above, below = 0.62 + 0.22 * rows, 0.58 + 0.17 * len(words)
    height = body + above + below
    figure = style.canvas(WIDTH, height)
    with matplotlib.rc_context(style.STYLE):
        axes = _panels(figure, len(panels), 1 - above / height, below / height)
        for axis, (label, lines) in zip(axes, panels, strict=True):
            for line in lines:
                _stairs(axis, line, window)
            axis.set_ylabel(label)
            if counts:
                _count_axis(axis)
            _mark(axis, window, beside.marks, labelled=axis is axes[0])
        unit, scale = window.unit
        axes[-1].set_xlabel(f"time since the first signal ({unit})" if window.zero else f"time ({unit})")
        axes[-1].set_xlim((window.begin - window.zero) * scale, (window.end - window.zero) * scale)
        if products is not None:
            _show_products(axes[-1], window, products)
        figure.text(0.02, 1 - 0.22 / height, title, fontsize=10.5, fontweight="bold", va="center")
        _legend(figure, axes, 1 - 0.38 / height, -(-len(shown) // rows))
        for n, text in enumerate(words):
            place = (0.12 + 0.17 * (len(words) - 1 - n)) / height
            figure.text(0.02, place, text, fontsize=WORDS_SIZE, color=style.GREY, va="center")
    return figure


def _panels(figure: Figure, count: int, top: float, bottom: float) -> list[Axes]:
    left, right, gap = 0.105, 0.975, 0.05
    tall = (top - bottom - gap * (count - 1)) / count
    axes: list[Axes] = []
    for n in range(count):
        low = top - (n + 1) * tall - gap * n
        axes.append(figure.add_axes((left, low, right - left, tall), sharex=axes[0] if axes else None))
    for axis in axes[:-1]:
        axis.tick_params(labelbottom=False)
    return axes


def _stairs(axis: Axes, line: Line, window: Window) -> None:
    _, scale = window.unit
    corners = list(line.stairs.steps(window.begin, window.end))
    times = [(t - window.zero) * scale for t, _ in corners]
    before = line.stairs.at(nextafter(window.zero, -inf)) if line.anew else 0.0
    axis.step(
        times,
        [v - before for _, v in corners],
        where="post",
        label=line.label,
        color=line.colour,
        linestyle=line.dashes,
    )


def _count_axis(axis: Axes) -> None:
    axis.yaxis.set_major_locator(MaxNLocator(integer=True, nbins=6))
    low, high = axis.get_ylim()
    axis.set_ylim(min(low, 0.0) if low < 3 else low - 0.5, high + max(0.6, 0.08 * (high - low)))


def _mark(axis: Axes, window: Window, marks: Sequence[float], *, labelled: bool) -> None:
    """Thin dotted lines at the papers' times; labels of close ones are put together."""
    _, scale = window.unit
    shown = sorted(t for t in marks if window.begin <= t <= window.end)
    look: dict[str, Any] = {"color": style.GREY, "linewidth": 1.0, "linestyle": (0, (1, 2)), "zorder": 0.5}
    for time in shown:
        axis.axvline((time - window.zero) * scale, label=MARKED, **look)
    groups: list[list[float]] = []
    for time in shown:
        if groups and time - groups[-1][-1] < 0.04 * (window.end - window.begin):
            groups[-1].append(time)
        else:
            groups.append([time])
    for group in groups if labelled else ():
        text = ", ".join(f"{t - window.zero:+.0f}" if window.zero else f"{t:.0f}" for t in group)
        place = (sum(group) / len(group) - window.zero) * scale
        axis.annotate(
            f"{text} s", (place, 1.0), (0, 3), xycoords=("data", "axes fraction"), textcoords="offset points",
            fontsize=7.2, color=style.GREY, ha="center", va="bottom",
        )  # fmt: skip


def _show_products(axis: Axes, window: Window, products: Products) -> None:
    """Small signs on the time axis: what was completed, what was rejected."""
    _, scale = window.unit
    for stairs, word, sign, colour in (
        (products.completed, "completed", "^", style.PURPLE),
        (products.rejected, "rejected", "x", style.INK),
    ):
        times = [(t - window.zero) * scale for t in stairs.times if window.begin <= t <= window.end]
        if times:
            axis.plot(
                times, [0.05] * len(times), sign, transform=axis.get_xaxis_transform(), color=colour, markersize=5,
                clip_on=False, label=f"{products.noun} {word}", zorder=5,
            )  # fmt: skip


def _legend(figure: Figure, axes: Sequence[Axes], top: float, columns: int) -> None:
    found = {label: mark for axis in axes for mark, label in zip(*axis.get_legend_handles_labels(), strict=True)}
    if MARKED in found:
        found[MARKED] = found.pop(MARKED)  # last
    figure.legend(
        found.values(), found.keys(), loc="upper left", ncols=columns, bbox_to_anchor=(0.012, top),
        columnspacing=1.4, handletextpad=0.6, labelspacing=0.4, borderaxespad=0.0, fontsize=8,
    )  # fmt: skip
