"""The table of rules in docs/analysis.md, made from the last campaign."""

from __future__ import annotations

import json

from tests.mutants.campaign import TABLE, score


def mutants_table() -> str:
    """For each rule how many mutants there are, and what became of them."""
    table = json.loads(TABLE.read_text(encoding="utf-8"))
    lines = ["| rule | mutants | killed | equivalent | survived |", "|---|---|---|---|---|"]
    total = {"killed": 0, "equivalent": 0, "survived": 0}
    for rule, row in table.items():
        counted = {fate: row[fate] for fate in total}
        lines.append(f"| {rule} | {sum(counted.values())} | " + " | ".join(map(str, counted.values())) + " |")
        total = {fate: total[fate] + n for fate, n in counted.items()}
    lines.append(f"| **all** | {sum(total.values())} | " + " | ".join(map(str, total.values())) + " |")
    return "\n".join([*lines, "", f"Score: {100 * score(table):.1f} % of those that are not equivalent.", ""])
