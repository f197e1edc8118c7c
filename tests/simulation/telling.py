"""What the last campaign of chaos came to, in docs/reliability.md: `python -m tests.simulation.telling`.

It adds up the results of `make chaos` on the present sources (out/chaos.jsonl), ships the sums (seen.json) and makes
the page anew.
"""

from __future__ import annotations

from pathlib import Path

import msgspec

from planner_reactor.simulation.campaign import RESULTS, Sums, read, sources, sums
from planner_reactor.simulation.counters import ELSEWHERE, ROWS

SEEN = Path(__file__).with_name("seen.json")


def seen() -> Sums:
    """The sums that are shipped."""
    return msgspec.json.decode(SEEN.read_bytes(), type=Sums)


def figures() -> str:
    """A sentence or two."""
    came = seen()
    hours = " and ".join(f"{h:,.0f} of the {world}" for world, h in came.hours.items())
    kinds = ", ".join(f"{n:,} {kind}" for kind, n in came.inside.items())
    return (
        f"{came.cases:,} cases, {sum(came.hours.values()):,.0f} simulated hours ({hours}), {came.events:,} events,\n"
        f"{came.adaptations:,} adaptations, {sum(came.inside.values()):,} faults inside one, "
        f"{came.violations} violations, in {came.cpu:,.0f} s of processor time.\n\n"
        f"Inside an adaptation: {kinds}.\n"
    )


def counters_table() -> str:
    """What a campaign has to bring about, by rows of the fault table, and how often it did."""
    rows = seen().rows
    lines = ["| row | what happens | counter | seen |", "|---|---|---|---|"]
    for counter, (row, text) in ROWS.items():
        lines.append(f"| {row or '–'} | {text} | {counter.lstrip('0123456789 ')} | {rows.get(counter, 0):,} |")
    for row, (file, text) in sorted(ELSEWHERE.items()):
        lines.append(f"| {row} | {text} | `{file}` | |")
    return "\n".join([*lines, ""])


def main() -> None:
    """Add up, ship, make the page."""
    from tests.pages import DOCS, made_anew

    digest = sources()
    SEEN.write_bytes(msgspec.json.format(msgspec.json.encode(sums(read(RESULTS, digest), digest)), indent=1) + b"\n")
    page = DOCS / "reliability.md"
    page.write_text(made_anew(page), encoding="utf-8")


if __name__ == "__main__":
    main()
