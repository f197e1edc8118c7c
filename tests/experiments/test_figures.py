"""The figures: which there are, that they are the same for the same run, and nothing overlaps or leaves its page."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg, RendererAgg
from matplotlib.figure import Figure

from planner_reactor.experiments import figures_style as style
from planner_reactor.experiments.figures import draw, is_papers_run
from planner_reactor.experiments.figures_hierarchies import draw_hierarchy
from planner_reactor.experiments.figures_panels import Beside, Line, Window, panels_figure
from planner_reactor.experiments.figures_traces import figure_12, figure_14, figure_17, figure_18, figure_19
from planner_reactor.experiments.hierarchy import hierarchy
from planner_reactor.experiments.measures import measure
from planner_reactor.experiments.papers_run import Replay
from planner_reactor.experiments.runs import Run, perform
from planner_reactor.experiments.snapshots import reactor_at
from planner_reactor.experiments.staircases import Staircase

from .conftest import Written

PAPERS = (8, 9, 10, 12, 13, 14, 15, 16, 17, 18, 19)


@pytest.fixture
def drawn(written: Written) -> list[Path]:
    return sorted(path for path in written.folder.iterdir() if path.suffix in (".png", ".svg"))


def test_every_figure_of_the_papers_is_there_as_png_and_svg(drawn: list[Path]) -> None:
    assert [path.name[:5] for path in drawn] == [f"fig{n:02d}" for n in PAPERS for _ in range(2)] + ["overv"] * 2
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in drawn if path.suffix == ".png")
    assert all(b"<svg" in path.read_bytes()[:2000] for path in drawn if path.suffix == ".svg")


def test_the_same_run_gives_the_same_bytes(replayed: Replay, tmp_path: Path) -> None:
    m = replayed.on_their_clock
    for name in ("one", "other"):
        figure = figure_18(m, "twice", beside=True)
        assert figure is not None
        style.save(figure, tmp_path, name)
    for suffix in (".png", ".svg"):
        assert (tmp_path / f"one{suffix}").read_bytes() == (tmp_path / f"other{suffix}").read_bytes()


def test_no_date_and_no_machine_is_in_them(drawn: list[Path]) -> None:
    texts = [path.read_text() for path in drawn if path.suffix == ".svg"]
    assert not [text for text in texts if "dc:date" in text or str(Path.cwd()) in text]


def test_a_run_on_the_papers_clock_is_known_as_one(replayed: Replay) -> None:
    assert is_papers_run(replayed.on_their_clock)
    assert not is_papers_run(replayed.on_ours)


def test_what_a_run_has_not_is_not_drawn(tmp_path: Path) -> None:
    """Without relaxing and without failures there is nothing of Figs 10 and 14 to 18."""
    ran = perform(Run(relax="none", until=30.0))
    names = {path.name[:5] for path in draw(ran.loop.trace.events, tmp_path)}
    assert names == {"fig08", "fig09", "fig12", "fig13", "fig19"}


def test_of_nothing_nothing_is_drawn(tmp_path: Path) -> None:
    assert draw([], tmp_path) == []
    assert figure_12(measure([]), "", beside=True) is None


def texts_of(figure: Figure) -> list[tuple[str, tuple[float, float, float, float]]]:
    """Every text that is shown with its box, in pixels."""
    FigureCanvasAgg(figure)
    figure.draw_without_rendering()
    renderer = RendererAgg(figure.get_figwidth() * figure.dpi, figure.get_figheight() * figure.dpi, figure.dpi)
    shown = [*figure.texts, *(text for legend in figure.legends for text in legend.get_texts())]
    for axes in figure.axes:
        if axes.axison:
            shown += [axes.xaxis.label, axes.yaxis.label]
        for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
            if axes.axison:
                shown += [tick.label1 for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
        shown += axes.texts
    boxes = [(text.get_text(), text.get_window_extent(renderer)) for text in shown if text.get_visible()]
    return [(text, (box.x0, box.y0, box.x1, box.y1)) for text, box in boxes if text.strip()]


def figures(replayed: Replay) -> list[Figure]:
    events = replayed.relaxed.loop.trace.events
    relaxed = hierarchy(reactor_at(events, events[-1].time), tags="because")
    first = hierarchy(reactor_at(events, 0.02))
    made = [draw_hierarchy("a title", "under it", nodes, ["a note"]) for nodes in (relaxed, first)]
    for m in (replayed.on_their_clock, replayed.on_ours):
        products = products_of(m)
        some = [figure_12(m, "a title", True), figure_14(m, "a title", True, products), figure_18(m, "a title", True)]
        some += [figure_17(m, "a title", True, products), figure_19(m, "a title", True, products)]
        made += [figure for figure in some if figure is not None]
    return made


def products_of(m):  # type: ignore[no-untyped-def]
    from planner_reactor.experiments.figures_panels import Products

    return Products("things", m.completed, m.rejected)


def test_no_two_texts_overlap_and_none_leaves_the_page(replayed: Replay) -> None:
    for figure in figures(replayed):
        wide, high = figure.get_figwidth() * figure.dpi, figure.get_figheight() * figure.dpi
        shown = texts_of(figure)
        for text, (left, low, right, top) in shown:
            assert left >= -1, text
            assert right <= wide + 1, text
            assert low >= -1, text
            assert top <= high + 1, text
        for (one, a), (other, b) in combinations(shown, 2):
            across = min(a[2], b[2]) - max(a[0], b[0])
            up = min(a[3], b[3]) - max(a[1], b[1])
            assert across <= 1.5 or up <= 1.5, (one, other)


def test_short_runs_are_shown_in_milliseconds() -> None:
    line = Line(Staircase.counting([0.003, 0.004]), "things", style.BLUE)
    figure = panels_figure("short", Window(0.0, 0.01), [("number", [line])], Beside())
    assert figure.axes[0].get_xlabel() == "time (ms)"
    assert figure.axes[0].get_xlim() == (0.0, 10.0)


def test_a_hundred_of_the_same_still_fit_a_page() -> None:
    from .test_hierarchy import snapshot

    kinds = [f"part{n}" for n in range(100)]
    text = "P[0] = STOP :; ASSERT[all]\nP[1] = SIT[all]<k> :; (~((" + " & ".join(f"REASSERT[{k}]" for k in kinds)
    text += ") : SUCCEED[all, k]) : FAIL[all, k])\n"
    text += "".join(f"P[{n + 2}] = SIT[{k}]<k> :; (Do[{k}] ; SUCCEED[{k}, k])\n" for n, k in enumerate(kinds))
    figure = draw_hierarchy("many", "", hierarchy(snapshot(text)))
    assert figure.get_figheight() < 12
