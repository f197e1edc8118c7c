"""The papers' figures, drawn from the trace of any run: R Figs 8 to 10 and 12 to 19, as PNG and SVG.

`draw(events, directory)` is all that there is to call. A figure for which the run has nothing to show (no assumption
failed, none was relaxed) is left out. A run that replays the papers' is known by its first adaptation, and has the
papers' own times marked. Fig. 10 shows the reactor when it rests on the fewest assumptions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

from planner_reactor.experiments import figures_style as style
from planner_reactor.experiments import figures_traces as traces
from planner_reactor.experiments import published
from planner_reactor.experiments.figures_hierarchies import draw_hierarchy
from planner_reactor.experiments.figures_panels import Products
from planner_reactor.experiments.hierarchy import Tagging, hierarchy
from planner_reactor.experiments.measures import Measures, measure
from planner_reactor.experiments.snapshots import reactor_at
from planner_reactor.trace import Event
from planner_reactor.workcell import telling

Drawing = Callable[[Measures, str, bool], Figure | None]


def draw(
    events: Iterable[Event],
    directory: Path,
    *,
    beside: bool | None = None,
    relaxed: Sequence[Event] | None = None,
) -> list[Path]:
    """Draw all figures of a run into a directory, and return the files written.

    `beside`: with the papers' times (None: if the run is on the papers' clock); `relaxed`: the events of another run,
    from which Fig. 10 is drawn.
    """
    directory.mkdir(parents=True, exist_ok=True)
    kept = list(events)
    m = measure(kept, verdict=telling.verdict)
    marked = is_papers_run(m) if beside is None else beside
    written: list[Path] = []
    for number, (paper, name, what, drawing) in enumerate(_figures(kept, list(relaxed or kept), m), 1):
        figure = drawing(m, f"Fig. {number} (paper: Fig. {paper})   {what}", marked)
        if figure is not None:
            written += style.save(figure, directory, f"fig{paper:02d}_{name}")
    return written


def is_papers_run(m: Measures) -> bool:
    """Does this run have the papers' planner durations?"""
    return m.first_issued is not None and abs(m.first_issued - published.FIRST_ISSUED) < 0.05


def _figures(kept: list[Event], relaxed: list[Event], m: Measures) -> list[tuple[int, str, str, Drawing]]:
    """The papers' number, a name for the file, what it shows, and how it is drawn."""
    products = Products(telling.PRODUCTS, m.completed, m.rejected)
    return [
        (8, "initial_reactor", "Initial adaptation", partial(_initial, kept)),
        (9, "first_ideal_reactor", "First ideal reactor", partial(_ideal, kept)),
        (10, "relaxed_reactor", "Final ideal reactor", partial(_relaxed, relaxed)),
        (12, "adaptations", "Adaptations issued and applied", traces.figure_12),
        (13, "first_assumptions", "Assumptions in use, first reactor", traces.figure_13),
        (
            14,
            "relaxing",
            "Assumptions in use, relaxed by the planner",
            partial(traces.figure_14, products=products),
        ),
        (15, "planner_and_adaptations", "Planner assumptions and adaptations", traces.figure_15),
        (16, "reactor_and_adaptations", "Reactor assumptions and adaptations", traces.figure_16),
        (17, "failures", "Assumptions in use and failures", partial(traces.figure_17, products=products)),
        (18, "forced_relaxation", "One forced relaxation, close up", traces.figure_18),
        (19, "improvement", "Planner-reactor improvement", partial(traces.figure_19, products=products)),
    ]


def _initial(events: list[Event], m: Measures, title: str, beside: bool) -> Figure | None:
    return _reactor(events, m.first_applied, title, "rests_on", ", in place at 28 s in the paper" if beside else "")


def _ideal(events: list[Event], m: Measures, title: str, beside: bool) -> Figure | None:
    return _reactor(events, m.ideal, title, "rests_on", ", at 40 s in the paper" if beside else "")


def _relaxed(events: list[Event], m: Measures, title: str, beside: bool) -> Figure | None:
    """The last time that the reactor rests on the fewest assumptions, if it has given up any."""
    mine = measure(events)
    counts, begin = mine.reactor.count, mine.ideal
    if begin is None:
        return None
    later = [(t, v) for t, v in zip(counts.times, counts.values, strict=True) if t > begin]
    fewest = min((v for _, v in later), default=counts.at(begin))
    if fewest >= counts.at(begin):
        return None
    last = max(n for n, (_, v) in enumerate(later) if v == fewest)
    until = later[last + 1][0] if last + 1 < len(later) else float("inf")
    before = max(e.time for e in events if e.time < until)
    return _reactor(events, before, title, "because", "; flags: relaxing which assumption brought it in")


def _reactor(events: list[Event], time: float | None, title: str, tags: Tagging, more: str) -> Figure | None:
    if time is None:
        return None
    snapshot = reactor_at(events, time)
    used = sorted({a for assumptions in snapshot.rests_on.values() for a in assumptions} | set(snapshot.watched))
    at = f"{1000 * time:.0f} ms" if time < 0.5 else f"{time:.1f} s"
    flags = "; flags: the assumptions that a situation rests on" if tags == "rests_on" else ""
    monitors = sorted({a for r in snapshot.reactions.values() for a in r.monitors})
    count = sum(bool(r.monitors) for r in snapshot.reactions.values())
    notes = [f"{len(snapshot.reactions)} reactions, {_monitors(count, monitors)}; in use: {', '.join(used) or 'none'}"]
    subtitle = f"our reactor at {at}{more}{flags}"
    return draw_hierarchy(title, subtitle, hierarchy(snapshot, tags=tags), notes)


def _monitors(count: int, watched: Sequence[str]) -> str:
    if not count:
        return "none of them a monitor"
    return f"{count} of them monitor{'s' if count > 1 else ''} ({', '.join(watched)})"
