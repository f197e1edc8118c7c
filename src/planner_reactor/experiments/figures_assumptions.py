"""The figure of the experiment `assumptions`: kits completed and kits lost, by assumption, reactor and world."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.axes import Axes

from planner_reactor.experiments import figures_style as style

Line = Mapping[str, Any]
PANELS = (
    ("holds", "Where the assumption holds", 0.0, (0.085, 0.6, 0.9, 0.2)),
    ("fails", "Where it is false, again and again", -29.0, (0.085, 0.07, 0.9, 0.4)),
)
"""World, title, the least that is drawn, and where."""

LOOKS = (
    ("trusting", style.VERMILLION, "built on all nine, told nothing"),
    ("relaxed", style.BLUE, "built without it"),
    ("observant", style.SKY, "built on all nine, observing, adapted"),
    ("careful", style.PALE, "built on nothing"),
)
WIDTH = 0.2


def draw(table: Sequence[Line], out: Path) -> list[Path]:
    """`assumptions.png` and `.svg`: bars are means over seeds, whiskers 95 % intervals, below zero what was lost."""
    names = list(dict.fromkeys(line["assumption"] for line in table))
    seeds = max(line["runs"] for line in table)
    with matplotlib.rc_context(style.STYLE):
        figure = style.canvas(7.4, 6.0)
        for world, title, least, where in PANELS:
            axes = figure.add_axes(where)
            _panel(axes, [line for line in table if line["world"] == world], names, least)
            axes.set_title(title, size=9.5)
        figure.text(0.085, 0.975, "Each of the nine assumptions is real", size=11, weight="bold", va="top")
        about = f"kits in 15 minutes: completed above the line, lost below; {seeds} seed{'s' * (seeds > 1)}"
        figure.text(0.085, 0.94, about, size=9, va="top")
        handles, labels = axes.get_legend_handles_labels()
        figure.legend(
            handles, labels, loc="upper left", bbox_to_anchor=(0.075, 0.915), ncols=2, columnspacing=1.6,
            borderaxespad=0.0, labelspacing=0.25,
        )  # fmt: skip
    return style.save(figure, out, "assumptions")


def _panel(axes: Axes, lines: Sequence[Line], names: Sequence[str], least: float) -> None:
    for place, (reactor, colour, label) in enumerate(LOOKS):
        mine = {line["assumption"]: line for line in lines if line["reactor"] == reactor}
        if mine:
            _bars(axes, [mine[name] for name in names], place, colour, label)
    axes.axhline(0.0, color=style.INK, linewidth=0.8)
    axes.set_xticks(range(len(names)), names)
    axes.set_xlim(-0.55, len(names) - 0.45)
    axes.set_ylim(least, 37.0)
    shown = [kits for kits in (-20, -10, 0, 10, 20, 30) if kits >= least]
    axes.set_yticks(shown, [str(abs(kits)) for kits in shown])
    axes.tick_params(axis="x", length=0)
    axes.grid(visible=False, axis="x")


def _bars(axes: Axes, lines: Sequence[Line], place: int, colour: str, label: str) -> None:
    across = [n + (place - 1.5) * WIDTH for n in range(len(lines))]
    completed, lost = ([line[key] for line in lines] for key in ("completed", "lost"))
    whiskers: Any = {"ecolor": style.INK, "elinewidth": 0.9, "capsize": 1.5}
    axes.bar(
        across, completed, WIDTH * 0.92, color=colour, label=label,
        yerr=[line["completed_ci95"] for line in lines], error_kw=whiskers,
    )  # fmt: skip
    axes.bar(
        across, [-value for value in lost], WIDTH * 0.92, color=colour, alpha=0.55, hatch="////",
        edgecolor="white", linewidth=0.0,
    )  # fmt: skip
    errors = [(x, -line["lost"], line["lost_ci95"]) for x, line in zip(across, lines, strict=True) if line["lost"]]
    for x, y, half in errors:
        axes.errorbar(x, y, yerr=half, fmt="none", **whiskers)
