"""The figure of the experiment `load`: how long an adaptation waits, by how many instances overlap, in each mode."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.axes import Axes

from planner_reactor.experiments import figures_style as style

LOOKS: Mapping[str, tuple[str, Any, str]] = {
    "wait": (style.VERMILLION, style.DASHED, "wait: WAITINHIBIT, as in the papers"),
    "drain": (style.BLUE, style.SOLID, "drain: what is in service finishes, what is new queues"),
    "versions": (style.GREEN, style.DASHDOT, "versions: new instances get the new reaction at once"),
}
TOP, BOTTOM = 600.0, 0.3
"""Seconds: an adaptation is given up above, and drawn at the edge below."""


def draw(waits: Sequence[Mapping[str, Any]], out: Path) -> list[Path]:
    """`load.png` and `load.svg`: the median, and a band up to the 95th percentile; above 600 s it was given up."""
    with matplotlib.rc_context(style.STYLE):
        figure = style.canvas(7.0, 4.2)
        axes = figure.add_axes((0.1, 0.13, 0.87, 0.66))
        for mode, (colour, dashes, label) in LOOKS.items():
            _line(axes, [w for w in waits if w["mode"] == mode], colour, dashes, label)
        axes.set_yscale("log")
        axes.set_ylim(BOTTOM * 0.8, TOP * 2.2)
        axes.set_yticks([0.3, 1, 5, 20, 100, 600], ["0", "1", "5", "20", "100", "never"])
        axes.minorticks_off()
        axes.set_xlabel("instances that overlap, 5 to 20 s each")
        axes.set_ylabel("seconds until it is applied")
        title = "A changed reaction has to wait for what is in service"
        figure.suptitle(title, x=0.1, y=0.985, ha="left", weight="bold", size=10.5)
        axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2, labelspacing=0.25)
    return style.save(figure, out, "load")


def _line(axes: Axes, waits: Sequence[Mapping[str, Any]], colour: str, dashes: Any, label: str) -> None:
    across = [w["overlapping"] for w in waits]
    medians, tops = ([_height(w[key]) for w in waits] for key in ("median_s", "p95_s"))
    axes.plot(across, medians, color=colour, linestyle=dashes, label=label, marker="o", markersize=4)
    axes.fill_between(across, medians, tops, color=colour, alpha=0.12, linewidth=0)


def _height(seconds: float | None) -> float:
    return TOP if seconds is None else min(TOP, max(BOTTOM, seconds))
