"""One page of a replay: the tables, every figure, what was told, the program before and after. Opens without a network.

Pictures are inside the page; nothing is fetched from anywhere. The figures lie beside it as PNG and SVG.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path

from planner_reactor.experiments.comparison import Row
from planner_reactor.experiments.figures import draw
from planner_reactor.experiments.measures import Measures
from planner_reactor.experiments.narrative import Narrator
from planner_reactor.experiments.overview import draw_overview
from planner_reactor.experiments.papers_run import Pays, Replay
from planner_reactor.experiments.snapshots import reactor_at
from planner_reactor.rs.printer import show
from planner_reactor.workcell import telling

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #222; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.2rem; margin-top: 2.5rem; }
table { border-collapse: collapse; margin: 1rem 0; font-size: 0.92rem; }
th, td { text-align: left; padding: 0.25rem 1.4rem 0.25rem 0; border-bottom: 1px solid #ddd; vertical-align: top; }
td.inner { padding-left: 1.2rem; color: #444; }
td.time { text-align: right; font-variant-numeric: tabular-nums; color: #666; }
th { border-bottom: 2px solid #222; }
img { max-width: 100%; height: auto; margin: 0.8rem 0 1.6rem; }
pre { background: #f6f6f4; padding: 0.8rem; overflow-x: auto; font-size: 0.82rem; }
p.note { color: #555; font-size: 0.9rem; margin: 0.3rem 0; } summary { cursor: pointer; }
.planner { color: #0072b2; } .reactor { color: #b34e00; } .world { color: #00795a; }
"""

ABOUT = """A <b>reactor</b>, a program in a process algebra, runs the robot all the time. Beside it a <b>planner</b>
keeps rewriting that program, a few reactions at once, without stopping it: first so that there is one at all, trusting
nine assumptions about the world; then so that it needs fewer of them. When the world breaks an assumption, the reactor
says so, and the planner does without it. This is the run of the papers (Lyons and Hendriks, 1995), replayed."""


def write_page(out: Path, replayed: Replay, pays: Sequence[Pays]) -> list[Path]:
    """Draw the figures into `out`, write `index.html` beside them, and return the files of the figures."""
    events = replayed.theirs.loop.trace.events
    written = draw(events, out, beside=True, relaxed=replayed.relaxed.loop.trace.events)
    pictures = [path for path in written if path.suffix == ".svg"]
    overview = draw_overview(replayed.ours.loop.trace.events, out)
    parts = [
        "<h1>A program that is rewritten while it runs</h1>",
        f"<p>{ABOUT}</p>",
        *(_picture(path) for path in overview if path.suffix == ".svg"),
        "<h2>The papers' figures and ours</h2>",
        comparison_table(replayed.rows),
        *(f'<p class="note">{escape(note)}</p>' for note in telling.PAPERS_NOTES),
        "<h2>What relaxing assumptions buys</h2>",
        "<p>The same faults, once with every assumption relaxed as need be, once with none.</p>",
        pays_table(pays),
        "<h2>What happened, on the papers' clock</h2>",
        _told(replayed),
        "<h2>Figures</h2>",
        *(_picture(path) for path in pictures),
        "<h2>The program</h2>",
        *_programs(replayed.on_their_clock, replayed),
    ]
    page = _page("A program that is rewritten while it runs", parts)
    (out / "index.html").write_text(page, encoding="utf-8")
    return [*overview, *written]


def comparison_table(rows: Iterable[Row]) -> str:
    """The papers' figures beside ours, as HTML."""
    head = ("", "the papers", "ours, on the papers' clock", "ours, on our own")
    return _table(head, ((row.what, row.paper, row.on_their_clock, row.on_ours) for row in rows))


def pays_table(rows: Iterable[Pays]) -> str:
    """What relaxing buys, as HTML."""
    noun = telling.PRODUCTS
    head = ("faults", "relaxed", f"{noun} completed", f"{noun} rejected", "lost to", "last one completed at")
    return _table(head, (pays_cells(row) for row in rows))


def pays_cells(row: Pays) -> tuple[str, ...]:
    """The cells of one row."""
    last = "–" if row.last_s is None else f"{row.last_s:.0f} s"
    return (row.faults, row.relax, str(row.completed), str(row.rejected), ", ".join(row.lost_to) or "–", last)


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = ["<table><tr>" + "".join(f"<th>{escape(cell)}</th>" for cell in head) + "</tr>"]
    for row in rows:
        inner = ' class="inner"' if row[0].startswith(" ") else ""
        first, *others = (escape(cell.strip()) for cell in row)
        lines.append(f"<tr><td{inner}>{first}</td>" + "".join(f"<td>{cell}</td>" for cell in others) + "</tr>")
    return "\n".join([*lines, "</table>"])


def _told(replayed: Replay) -> str:
    lines: list[str] = []

    def say(time: float, who: str, what: str) -> None:
        lines.append(f'<tr><td class="time">{time:.1f} s</td><td class="{who}">{who}</td><td>{escape(what)}</td></tr>')

    narrator = Narrator(say, telling.MEANING, telling.told)
    narrator.begin()
    for event in replayed.theirs.loop.trace.events:
        narrator(event)
    return "<details><summary>line by line</summary><table>" + "\n".join(lines) + "</table></details>"


def _picture(path: Path) -> str:
    words = path.stem.partition("_")[2].replace("_", " ")
    inside = b64encode(path.read_bytes()).decode("ascii")
    return f'<img alt="{escape(words)}" src="data:image/svg+xml;base64,{inside}">'


def _programs(m: Measures, replayed: Replay) -> list[str]:
    events = replayed.theirs.loop.trace.events
    moments = [("The first reactor", m.first_applied), ("The first ideal reactor", m.ideal), ("At the end", m.end)]
    return [
        f"<details><summary>{escape(name)}, {time:.1f} s</summary><pre>"
        + escape("\n".join(show(reaction.schema) for reaction in reactor_at(events, time).reactions.values()))
        + "</pre></details>"
        for name, time in moments
        if time is not None
    ]


def _page(title: str, parts: Sequence[str]) -> str:
    return "\n".join(
        [
            "<!doctype html>",
            '<html lang="en"><head><meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f"<title>{escape(title)}</title><style>{STYLE}</style></head><body>",
            *parts,
            "</body></html>\n",
        ]
    )
