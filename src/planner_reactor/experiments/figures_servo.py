"""The figures of `tracking` and `acquiring`: error over time, the sweep with its boundary, contact times, switching."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.axes import Axes

from planner_reactor.experiments import figures_style as style

BOUNDS: Mapping[str, tuple[str, Any, str]] = {
    "corrects": (style.INK, style.SOLID, "predicted: once around the loop takes as long as the object stands"),
    "reads": (style.GREY, style.DASHED, "predicted: τr + γr < τe + γe ends"),
}


def draw_error(courses: Sequence[Mapping[str, Any]], field: float, out: Path) -> list[Path]:
    """`tracking_error`: where the object was, where the camera looked, and the error, for each course."""
    with matplotlib.rc_context(style.STYLE):
        figure = style.canvas(7.2, 5.2)
        for column, course in enumerate(courses):
            left = 0.085 + 0.48 * column
            above = figure.add_axes((left, 0.47, 0.42, 0.37))
            below = figure.add_axes((left, 0.11, 0.42, 0.29), sharex=above)
            _places(above, course, field)
            _error(below, course, field)
            kept = "sufficiently dense" if column == 0 else "not sufficiently dense"
            above.set_title(f"sensor every {course['period']:g} s: {kept}", fontsize=9)
            if column == 0:
                above.set_ylabel("position")
                below.set_ylabel("object minus camera")
        title = "TRACK, found by the planner: an object that moves at random every second"
        figure.suptitle(title, x=0.085, y=0.985, ha="left", weight="bold", size=10)
        handles, labels = figure.axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="upper left", bbox_to_anchor=(0.075, 0.955), ncols=3)
    return style.save(figure, out, "tracking_error")


def _places(axes: Axes, course: Mapping[str, Any], field: float) -> None:
    at, camera = course["at"], course["camera"]
    low, high = [a - field for a in camera], [a + field for a in camera]
    axes.fill_between(at, low, high, step="post", color=style.SKY, alpha=0.3, linewidth=0, label="what the camera sees")
    axes.step(at, camera, where="post", color=style.BLUE, linewidth=1.0, label="camera")
    axes.step(at, course["object"], where="post", color=style.VERMILLION, linewidth=1.2, label="object")
    axes.tick_params(labelbottom=False)


def _error(axes: Axes, course: Mapping[str, Any], field: float) -> None:
    errors = [p - a for p, a in zip(course["object"], course["camera"], strict=True)]
    axes.step(course["at"], errors, where="post", color=style.INK, linewidth=0.9)
    for edge in (-field, field):
        axes.axhline(edge, color=style.VERMILLION, linestyle=style.DASHED, linewidth=1.0)
    reach = max(1.5 * field, 1.05 * max(map(abs, errors)))
    axes.set_ylim(-reach, reach)
    axes.set_xlabel("seconds")


def draw_sweep(sweep: Sequence[Mapping[str, Any]], boundary: Mapping[str, float], out: Path) -> list[Path]:
    """`tracking_sweep`: the share of samples in view by the sensor's period, and where it was predicted to fall."""
    with matplotlib.rc_context(style.STYLE):
        figure = style.canvas(7.0, 4.2)
        axes = figure.add_axes((0.1, 0.13, 0.87, 0.63))
        across = [line["period"] for line in sweep]
        for name, (colour, dashes, label) in BOUNDS.items():
            told = f"{label} ({boundary[name]:.2f} s)"
            axes.axvline(boundary[name], color=colour, linestyle=dashes, linewidth=1.2, label=told)
        means, worst = ([100 * line[key] for line in sweep] for key in ("mean", "least"))
        look: dict[str, Any] = {"markersize": 4}
        axes.plot(across, means, color=style.BLUE, marker="o", label=f"mean of {sweep[0]['runs']} runs", **look)
        axes.plot(across, worst, color=style.VERMILLION, linestyle=style.DASHDOT, marker="v", label="worst run", **look)
        axes.set_xlabel("seconds between two readings of the sensor; the object moves every second")
        axes.set_ylabel("% of samples with the object in view")
        axes.set_ylim(0, 104)
        title = "TRACK keeps the object in view for as long as its timing is dense enough"
        figure.suptitle(title, x=0.1, y=0.985, ha="left", weight="bold", size=10.5)
        axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2, labelspacing=0.25)
    return style.save(figure, out, "tracking_sweep")


def draw_contact(rows: Sequence[Mapping[str, Any]], out: Path) -> list[Path]:
    """`contact`: when objects were in the hand, by GuardedMove and by GuardedWait."""
    with matplotlib.rc_context(style.STYLE):
        figure = style.canvas(7.0, 3.6)
        told = (("move", "GuardedMove: the robot goes to the object", style.VERMILLION),
                ("wait", "GuardedWait: the belt brings the object", style.BLUE))  # fmt: skip
        for column, (way, title, colour) in enumerate(told):
            axes = figure.add_axes((0.085 + 0.48 * column, 0.15, 0.42, 0.6))
            mine = [r for r in rows if r["way"] == way]
            times = [r["contact_s"] for r in mine if r["contact_s"] is not None]
            axes.hist(times, bins=30, color=colour)
            axes.set_title(f"{title}\n{len(times)} of {len(mine)} acquired, {sum(r['moves'] for r in mine)} motions",
                           fontsize=8.5)  # fmt: skip
            axes.set_xlabel("seconds until it is in the hand")
            if column == 0:
                axes.set_ylabel("runs")
        title = "Reactions that were found from models of the environment acquire"
        figure.suptitle(title, x=0.085, y=0.985, ha="left", weight="bold", size=10.5)
    return style.save(figure, out, "contact")


def draw_switching(story: Mapping[str, Any], out: Path) -> list[Path]:
    """`switching`: the belt stops and starts, and the reaction is exchanged by adaptation."""
    with matplotlib.rc_context(style.STYLE):
        figure = style.canvas(7.2, 3.9)
        axes = figure.add_axes((0.085, 0.13, 0.89, 0.66))
        _belt(axes, story)
        for name, colour, width in (("object", style.VERMILLION, 1.0), ("robot", style.BLUE, 1.6)):
            times, values = zip(*story[name], strict=True)
            across, up = [*times, story["lasts"]], [*values, values[-1]]
            axes.step(across, up, where="post", color=colour, linewidth=width, label=name)
        robot = [_at(story["robot"], when) for when in story["acquired"]]
        axes.plot(story["acquired"], robot, "o", color=style.INK, markersize=2.5, label="acquired")
        row, last = 0, -story["lasts"]
        for change in story["changes"]:
            axes.axvline(change["at_s"], color=style.INK, linestyle=style.DOTTED, linewidth=1.0)
            row = row + 1 if change["at_s"] - last < story["lasts"] / 20 else 0  # no name over another
            name, last = "Move" if change["moves"] else "Wait", change["at_s"]
            axes.annotate(name, (last, 1.015 + 0.05 * row), xycoords=("data", "axes fraction"), fontsize=7, va="bottom")
        axes.set_xlim(0, story["lasts"])
        axes.set_xlabel("seconds; grey: the belt stands; dotted: an adaptation is applied")
        axes.set_ylabel("position along the belt")
        title = "A belt that others stop and start: GuardedWait and GuardedMove change places"
        figure.suptitle(title, x=0.085, y=0.985, ha="left", weight="bold", size=10.5)
        axes.legend(loc="upper right", ncols=3, facecolor="white", framealpha=0.85, frameon=True, edgecolor="none")
    return style.save(figure, out, "switching")


def _belt(axes: Axes, story: Mapping[str, Any]) -> None:
    """Grey where the belt stands."""
    since = None
    for when, runs in [*story["strikes"], (story["lasts"], True)]:
        if not runs:
            since = when
        elif since is not None:
            axes.axvspan(since, when, color=style.PALE, alpha=0.6, linewidth=0)
            since = None


def _at(course: Sequence[tuple[float, float]], when: float) -> float:
    return [value for time, value in course if time <= when][-1]
