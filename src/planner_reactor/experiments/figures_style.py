"""How the figures look, and how they are written: the same bytes for the same run.

Colours are those of Okabe and Ito, which colour-blind readers can tell apart; lines differ in their dashes as well, so
that a black and white print can be read. matplotlib is used without a display, and nothing is kept from one figure to
the next.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path

BLUE, VERMILLION, GREEN, SKY, ORANGE, PURPLE = "#0072B2", "#D55E00", "#009E73", "#56B4E9", "#E69F00", "#CC79A7"
INK, GREY, PALE = "#222222", "#767676", "#D9D9D9"
DPI = 160

STYLE: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.titlesize": 10.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#EBEBEB",
    "grid.linewidth": 0.7,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.direction": "out",
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "legend.handlelength": 3.0,
    "lines.linewidth": 1.8,
    "lines.solid_capstyle": "butt",
    "lines.dash_capstyle": "butt",
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "svg.hashsalt": "planner-reactor",
    "svg.fonttype": "path",
}

SOLID, DASHED, DOTTED, DASHDOT = "-", (0, (5, 2)), (0, (1.2, 1.6)), (0, (6, 2, 1.2, 2))


def canvas(width: float, height: float) -> Figure:
    """An empty figure, so many inches wide and high."""
    with matplotlib.rc_context(STYLE):
        return Figure(figsize=(width, height))


def save(figure: Figure, directory: Path, name: str) -> list[Path]:
    """Write `name.png` and `name.svg`; no date and no version in either."""
    png, svg = directory / f"{name}.png", directory / f"{name}.svg"
    with matplotlib.rc_context(STYLE):
        FigureCanvasAgg(figure)
        figure.savefig(png, dpi=DPI, metadata={"Software": None})
        FigureCanvasSVG(figure)
        figure.savefig(svg, format="svg", metadata={"Date": None, "Creator": "planner-reactor"})
    return [png, svg]


@lru_cache(maxsize=4096)
def text_width(text: str, size: float) -> float:
    """The width of a text in points, at a size in points."""
    font = FontProperties(family="DejaVu Sans", size=size)
    return float(text_to_path.get_text_width_height_descent(text, font, False)[0])


def broken(text: str, size: float, width: float) -> list[str]:
    """A text in lines that are no wider than so many points, broken between words."""
    lines: list[str] = []
    for word in text.split(" "):
        if lines and text_width(f"{lines[-1]} {word}", size) <= width:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return [line.strip() for line in lines if line.strip()]
