"""The picture on the first screen of the README: the architecture (R Fig. 1), and one run of it.

Above, what passes between planner, reactor and world; below, from the trace of a run, the assumptions that planner and
reactor use, when the program was rewritten, what failed, and what was completed. Generic for any domain.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib
from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

from planner_reactor.experiments import figures_style as style
from planner_reactor.experiments.measures import Measures, measure
from planner_reactor.trace import Event
from planner_reactor.workcell import telling

SIZE = (9.2, 5.0)
"""Inches."""


def draw_overview(events: Sequence[Event], directory: Path) -> list[Path]:
    """Write `overview.png` and `overview.svg` for this run."""
    m = measure(events, verdict=telling.verdict)
    with matplotlib.rc_context(style.STYLE):
        figure = style.canvas(*SIZE)
        above = figure.add_axes((0.02, 0.70, 0.96, 0.28))
        _architecture(above)
        below = figure.add_axes((0.075, 0.11, 0.905, 0.50))
        _run(below, m, events)
    return style.save(figure, directory, "overview")


def _architecture(axes: Axes) -> None:
    axes.set_axis_off()
    axes.set_xlim(0, 100)
    axes.set_ylim(0, 20)
    _box(axes, 1, "Planner", "knows what it assumes,\nrelaxes it step by step", style.SKY)
    _box(axes, 39, "Reactor", "always acts,\nis never interrupted", style.ORANGE)
    _box(axes, 77, "World", "is not always\nas assumed", style.PALE)
    _arrow(axes, (23.5, 13), (38.5, 13), "adaptations", above=True)
    _arrow(axes, (38.5, 6), (23.5, 6), "perceptions", above=False)
    _arrow(axes, (61.5, 13), (76.5, 13), "actions", above=True)
    _arrow(axes, (76.5, 6), (61.5, 6), "sensing", above=False)


def _box(axes: Axes, left: float, name: str, words: str, colour: str) -> None:
    shape = FancyBboxPatch((left, 2), 22, 15, boxstyle="round,pad=0.2,rounding_size=1.2", fc=colour, ec=style.INK, lw=1)
    shape.set_alpha(0.55)
    axes.add_patch(shape)
    axes.text(left + 11, 13.2, name, ha="center", va="center", fontsize=12, fontweight="bold")
    axes.text(left + 11, 7.0, words, ha="center", va="center", fontsize=8.5)


def _arrow(axes: Axes, tail: tuple[float, float], head: tuple[float, float], words: str, *, above: bool) -> None:
    axes.add_patch(FancyArrowPatch(tail, head, arrowstyle="-|>", mutation_scale=13, color=style.INK, lw=1.3))
    middle, height, align = (tail[0] + head[0]) / 2, 1.2 if above else -1.2, "bottom" if above else "top"
    axes.text(middle, tail[1] + height, words, ha="center", va=align, fontsize=9)


def _run(axes: Axes, m: Measures, events: Sequence[Event]) -> None:
    end = m.end
    for staircase, colour, width, words in (
        (m.planner.count, style.BLUE, 3.2, "assumptions used by the planner"),
        (m.reactor.count, style.VERMILLION, 1.5, "and by the reactor"),
    ):
        times, values = zip(*staircase.steps(0.0, end), strict=True)
        axes.step(times, values, where="post", color=colour, lw=width, label=words)
    issued = [e.time for e in events if e.kind == "adaptation_issued"]
    axes.plot(issued, [1.1] * len(issued), "|", color=style.INK, ms=9, mew=1.2, label="the program is rewritten")
    axes.plot(m.completed.times, [0.35] * len(m.completed.times), "^", color=style.GREEN, ms=6,
              label=f"{telling.PRODUCTS} completed")  # fmt: skip
    for change in m.relaxed:
        if change.cause != "normal":
            highest = max(m.planner.count.at(change.began + after) for after in (0.0, 5.0))
            _told(axes, change.began, highest, change.assumption, change.cause)
    axes.set_xlim(0, end)
    axes.set_ylim(0, 10.6)
    axes.set_yticks(range(0, 10, 3))
    axes.set_xlabel("time (s)")
    axes.legend(loc="lower left", ncols=4, bbox_to_anchor=(-0.01, 1.0), columnspacing=1.4, handletextpad=0.5)


def _told(axes: Axes, time: float, height: float, assumption: str, cause: str) -> None:
    words = f"{assumption} fails" if cause == "forced" else f"{assumption} holds again"
    axes.annotate(words, (time, height), (time, height + 1.7), ha="center", fontsize=8.5,
                  arrowprops={"arrowstyle": "-|>", "color": style.GREY, "lw": 1.0})  # fmt: skip
