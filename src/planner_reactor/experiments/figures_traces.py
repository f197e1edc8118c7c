"""The papers' traces as figures: R Figs 12 to 19, one function each, from the measures of any run.

A function returns None where the run has nothing of the kind (no relaxation, no failure). With `beside` the times that
the papers print are marked by thin dotted lines; what they and we measured stands beneath the figure.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from msgspec.structs import replace

from planner_reactor.experiments import figures_style as style
from planner_reactor.experiments import published
from planner_reactor.experiments.figures_panels import Beside, Line, Products, Window, panels_figure
from planner_reactor.experiments.measures import Change, Measures
from planner_reactor.experiments.staircases import Staircase

NO_BREAK = "\u00a0"


def figure_12(m: Measures, title: str, beside: bool) -> Figure | None:
    """Adaptations issued and applied, while the first reactor is built."""
    if m.first_issued is None:
        return None
    words = _pairs(
        ("first issued", published.FIRST_ISSUED, m.first_issued),
        ("last of the first ideal reactor", published.IDEAL_ISSUED, m.ideal_issued),
        ("first applied", published.FIRST_APPLIED, m.first_applied),
    )
    marks = (published.FIRST_ISSUED, published.IDEAL_ISSUED)
    return panels_figure(title, _first_phase(m), [("number so far", _adaptations(m))], _beside(beside, marks, words))


def figure_13(m: Measures, title: str, beside: bool) -> Figure | None:
    """Assumptions in use, while the first reactor is built."""
    if m.first_issued is None:
        return None
    used = (m.reactor.count.at(m.first_applied or 0.0), m.reactor.count.at(m.ideal or 0.0))
    words = _pairs(
        ("first reactor", published.FIRST_APPLIED, m.first_applied),
        ("first ideal reactor", published.IDEAL, m.ideal),
    )
    words += f"; assumptions {published.ASSUMPTIONS[0]}, {published.ASSUMPTIONS[1]} → {used[0]:.0f}, {used[1]:.0f}"
    marks = (published.FIRST_APPLIED, published.IDEAL)
    return panels_figure(
        title, _first_phase(m), [("assumptions in use", _assumptions(m))], _beside(beside, marks, words)
    )


def figure_14(m: Measures, title: str, beside: bool, products: Products) -> Figure | None:
    """Assumptions in use, while the planner relaxes them by choice."""
    window = _second_phase(m)
    if window is None:
        return None
    relaxed = [r for r in m.relaxed if r.cause == "normal" and r.issued]
    words = "; ".join(f"{r.assumption}: {r.thinking:.3g} s of planning" for r in relaxed[:4])
    if beside:
        words = f"paper: AQ 6 s, AS 30 s, reactor follows at 103 to 104 s; ours: {_followed(relaxed)}"
    marks = (published.IDEAL, *published.REACTOR_FOLLOWS)
    panels = [("assumptions in use", _assumptions(m))]
    return panels_figure(title, window, panels, _beside(beside, marks, words), products)


def figure_15(m: Measures, title: str, beside: bool) -> Figure | None:
    """The planner's assumptions above the adaptations."""
    return _superimposed(m, title, beside, _assumptions(m)[:1])


def figure_16(m: Measures, title: str, beside: bool) -> Figure | None:
    """The reactor's assumptions above the adaptations."""
    return _superimposed(m, title, beside, _assumptions(m)[1:])


def figure_17(m: Measures, title: str, beside: bool, products: Products) -> Figure | None:
    """Assumptions in use and failure signals, when the environment breaks assumptions."""
    signalled = [r for r in m.relaxed if r.signalled is not None]
    if not signalled:
        return None
    begin = min(r.began for r in signalled)
    window = Window(max(0.0, begin - 0.15 * (m.end - begin)), m.end)
    told = (f"{r.assumption} {_past(r)} at {r.began:.1f} s".replace(" ", NO_BREAK) for r in signalled)
    words = "ours: " + ", ".join(told)
    if beside:
        words = "paper: AM fails at 152 s, ADD at 215 s, reinstated at 357 s; " + words
    marks = (published.MOVED, published.BLOCKED, published.REINSTATED)
    panels = [("assumptions in use", _assumptions(m)), ("failure signals", _failures(m))]
    return panels_figure(title, window, panels, _beside(beside, marks, words), products)


def figure_18(m: Measures, title: str, beside: bool) -> Figure | None:
    """A close-up of the first forced relaxation; time counts from its signal."""
    forced = m.relaxation("forced")
    if forced is None or forced.response is None or not forced.issued:
        return None
    zero = forced.began
    span = max(forced.response, 0.01)
    window = Window(zero - 0.2 * span, zero + 1.35 * span, zero)
    words = _pairs(
        ("issuing from", published.ISSUING_FROM - published.MOVED, forced.issued[0] - zero),
        ("to", published.ISSUING_TO - published.MOVED, forced.issued[-1] - zero),
        ("signals end", published.SILENT - published.MOVED, (forced.silent or zero) - zero),
        ("final change", published.RESPONSE, forced.response),
    )
    shift = zero - published.MOVED
    marks = [t + shift for t in (published.MOVED, published.ISSUING_FROM, published.SILENT, published.ISSUING_TO)]
    adaptations = [replace(line, anew=True) for line in _adaptations(m)]
    failures = [replace(line, anew=True, label="failure signals received") for line in _failures(m)]
    panels = [("number since then", adaptations), ("number", [*_assumptions(m)[1:], *failures])]
    return panels_figure(title, window, panels, _beside(beside, marks, words))


def figure_19(m: Measures, title: str, beside: bool, products: Products) -> Figure | None:
    """The papers' measure of improvement, 1/M over the whole run."""
    shown = [(t, v) for t, v in zip(m.m.times, m.m.values, strict=True) if v > 0]
    if not shown:
        return None
    curve = Staircase(tuple(t for t, _ in shown), tuple(1 / v for _, v in shown), 1 / shown[0][1])
    window = Window(0.0, m.end)
    marks = (published.MOVED, published.BLOCKED, published.REINSTATED)
    words = "M = (supported in planner + reactor) + 2 (retracted in planner + reactor) + change of those that hold"
    line = Line(curve, "1/M, from M > 0", style.BLUE)
    figure = panels_figure(title, window, [("1/M", [line])], _beside(beside, marks, words), products, counts=False)
    _label_levels(figure.axes[0], m, shown[0][0])
    return figure


# -- what they are made of


def _adaptations(m: Measures) -> list[Line]:
    return [
        Line(m.issued, "adaptations issued by the planner", style.BLUE),
        Line(m.changes, "changes applied in the reactor", style.VERMILLION, style.DASHED),
    ]


def _assumptions(m: Measures) -> list[Line]:
    return [
        Line(m.planner.count, "in use by the planner", style.BLUE),
        Line(m.reactor.count, "in use by the reactor", style.VERMILLION, style.DOTTED),
    ]


def _failures(m: Measures) -> list[Line]:
    return [Line(m.failures, "failure signals received so far", style.GREEN, style.DASHDOT)]


def _superimposed(m: Measures, title: str, beside: bool, assumptions: list[Line]) -> Figure | None:
    window = _second_phase(m)
    if window is None:
        return None
    inked = [replace(line, colour=style.INK, label=f"assumptions {line.label}") for line in assumptions]
    panels = [("assumptions in use", inked), ("number so far", _adaptations(m))]
    relaxed = [r for r in m.relaxed if r.cause == "normal" and r.issued]
    words = "paper: changes in progress from 40 s to 103 s; ours: " + _followed(relaxed)
    return panels_figure(title, window, panels, _beside(beside, (published.IDEAL, published.REACTOR_FOLLOWS[0]), words))


def _first_phase(m: Measures) -> Window:
    until = m.ideal or m.first_applied or m.end
    return Window(0.0, min(max(m.end, 1e-9), 1.5 * until))


def _second_phase(m: Measures) -> Window | None:
    applied = [t for r in m.relaxed if r.cause == "normal" for t in r.applied]
    if not applied or m.first_applied is None:
        return None
    long = max(applied) - m.first_applied
    return Window(max(0.0, m.first_applied - 0.12 * long), min(m.end, max(applied) + 0.2 * long))


def _followed(relaxed: Sequence[Change]) -> str:
    parts = [
        f"{r.assumption} {r.thinking:.3g} s, in the reactor at {max(r.applied):.1f} s".replace(" ", NO_BREAK)
        for r in relaxed[:3]
        if r.applied and r.thinking is not None
    ]
    more = f" (and {len(relaxed) - 3} more)" if len(relaxed) > 3 else ""
    return "; ".join(parts) + more


def _past(change: Change) -> str:
    return "reinstated" if change.cause == "reinstated" else "fails"


def _pairs(*measured: tuple[str, float, float | None]) -> str:
    """`what: paper → ours`, for each."""
    ours = ("–" if value is None else f"{value:.3g} s" if value < 1 else f"{value:.1f} s" for _, _, value in measured)
    told = [f"{what} {paper:.0f} s → {own}" for (what, paper, _), own in zip(measured, ours, strict=True)]
    return "paper → ours: " + "; ".join(part.replace(" ", NO_BREAK) for part in told)


def _beside(beside: bool, marks: Sequence[float], words: str) -> Beside:
    if beside:
        return Beside(marks, words)
    return Beside((), "" if words.startswith("paper") else words)


def _label_levels(axis: Axes, m: Measures, begin: float) -> None:
    """M beside each level that lasts; the scale leaves out what lasts for an instant."""
    ends = (*m.m.times[1:], m.end)
    levels = [
        (start, end, value)
        for start, end, value in zip(m.m.times, ends, m.m.values, strict=True)
        if start >= begin and value > 0 and end - start >= 0.005 * m.end
    ]
    if not levels:
        return
    heights = [1 / value for _, _, value in levels]
    room = max(heights) - min(heights) or max(heights)
    with matplotlib.rc_context(style.STYLE):
        axis.set_ylim(min(heights) - 0.2 * room, max(heights) + 0.15 * room)
        for n, (start, end, value) in enumerate(levels):
            if end - start >= 0.045 * m.end:
                valley = 0 < n < len(levels) - 1 and max(levels[n - 1][2], levels[n + 1][2]) < value
                _tell(axis, value, (start + end) / 2, (0, -4 if valley else 3), "center", "top" if valley else "bottom")
            elif n == 0:
                _tell(axis, value, end, (5, 0), "left", "center")


def _tell(axis: Axes, value: float, time: float, offset: tuple[float, float], across: Any, up: Any) -> None:
    axis.annotate(
        f"M = {value:.0f}", (time, 1 / value), offset, textcoords="offset points", fontsize=7.2, ha=across, va=up
    )  # fmt: skip
