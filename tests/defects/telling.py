"""What became of the defects, for docs/defects.md: made from the table that the last run shipped."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from tests.defects.defects import Defect, harmless
from tests.defects.hunting import Caught

TABLE = Path(__file__).with_name("table.json")


def shipped() -> list[dict[str, Any]]:
    """The rows of the last run."""
    rows: list[dict[str, Any]] = json.loads(TABLE.read_text(encoding="utf-8")) if TABLE.exists() else []
    return rows


def summary(results: Iterable[tuple[Defect, Caught]]) -> str:
    """One line."""
    found = list(results)
    caught = [c for _, c in found if c.by]
    most = max((c.seeds for c in caught), default=0)
    return f"{len(caught)} of {len(found)} caught, within {most} seeds at most"


def defects_table() -> str:
    """Every defect, what caught it, and at which seed."""
    rows = shipped()
    caught = [row for row in rows if row["by"]]
    hand = sum(row["made"] == "by hand" for row in rows)
    lines = [
        f"{len(caught)} of {len(rows)} are caught ({hand} made by hand, {len(rows) - hand} by the tool), "
        f"{sum(row['seeds'] == 1 for row in caught)} of them by the first seed, the last by seed "
        f"{max((row['seeds'] for row in caught), default=0)}.",
        "",
        "| about | defect | caught by | seed |",
        "|---|---|---|---|",
    ]
    for row in rows:
        by = ", ".join([row["by"] or "**nothing**", *row["also"]])
        name = row["name"].replace("|", "\\|")
        lines.append(f"| {row['about']} | {name} | {by} | {row['seeds']} |")
    return "\n".join([*lines, ""])


def harmless_table() -> str:
    """What the tool changed without breaking a law."""
    lines = ["| change | why no law is broken |", "|---|---|"]
    lines += [f"| {name.replace('|', chr(92) + '|')} | {because} |" for name, because in sorted(harmless().items())]
    return "\n".join([*lines, ""])
