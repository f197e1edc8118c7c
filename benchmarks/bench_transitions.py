"""Transition systems beside SPIN: safe adaptations side by side, one model, one run.

    python benchmarks/bench_transitions.py [--json] [--models FOLDER]

The model is `planner_reactor.experiments.copies`: k reactors R0 that are each adapted to R1 (R §5.5), from RS text.
SPIN gets it as Promela, exported from the tables that our own searches use, and is asked for invalid end states:
exhaustively, and with its partial-order reduction. Each search of ours runs in a process of its own, so that its
memory is all of that process; seconds are those of the search alone, and from the text on. SPIN's seconds do not hold
its compilation.

    enumerated   every state, one bit each            reduced   with stubborn sets factored     parts that share
    nothing one by one  explored  every state and every transition kept, with shortest paths
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from planner_reactor.analysis.automata import Automata, compiled
from planner_reactor.analysis.enumeration import enumerated
from planner_reactor.analysis.factoring import factored
from planner_reactor.analysis.networks import networked
from planner_reactor.analysis.promela import promela
from planner_reactor.analysis.stubborn import reduced
from planner_reactor.analysis.transitions import build
from planner_reactor.experiments import copies, spin

Row = dict[str, Any]

CASES = (
    *(("enumerated", k, coupled) for k, coupled in ((2, False), (2, True), (3, False), (3, True), (4, False))),
    *(("reduced", k, coupled) for k, coupled in ((2, False), (2, True), (3, False), (3, True), (4, False))),
    *(("factored", k, coupled) for k in (3, 4, 100) for coupled in (False, True)),
    ("explored", 2, False), ("explored", 3, False),
)  # fmt: skip


def tables(k: int, coupled: bool) -> Automata:
    config, world = copies.begun(k, coupled=coupled)
    return compiled(networked(config, world, limit=100_000))


def one(engine: str, k: int, coupled: bool) -> Row:
    """One search, in this process."""
    begun = time.perf_counter()
    if engine in ("enumerated", "reduced"):
        automata = tables(k, coupled)
        searching = time.perf_counter()
        found: Any = enumerated(automata) if engine == "enumerated" else reduced(automata)
        deadlocks = found.deadlocks if engine == "enumerated" else len(found.deadlocks)
        counts = {"states": found.states, "transitions": found.transitions, "deadlocks": deadlocks}
    elif engine == "factored":
        config, world = copies.begun(k, coupled=coupled)
        searching = time.perf_counter()
        found = factored(config, world)
        counts = {"states": found.states, "transitions": found.transitions, "deadlocks": found.deadlocks}
        counts["stuck parts"] = len(found.stuck)
    else:
        config, world = copies.begun(k, coupled=coupled)
        searching = time.perf_counter()
        whole = build(config, world, limit=10_000_000)
        counts = {"states": len(whole), "transitions": whole.size, "deadlocks": len(whole.deadlocks)}
    ended = time.perf_counter()
    return {
        "engine": engine, "k": k, "coupled": coupled, **counts, "seconds": round(ended - searching, 4),
        "from_text": round(ended - begun, 4),
        "megabytes": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, 1),
    }  # fmt: skip


def ours() -> list[Row]:
    rows = []
    for engine, k, coupled in CASES:
        print(f"… {engine}, k = {k}{', coupled' * coupled}", file=sys.stderr, flush=True)
        command = [sys.executable, __file__, "--one", engine, str(k), str(int(coupled))]
        rows.append(json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout))
    return rows


def theirs(counted: list[Row]) -> list[Row]:
    """SPIN on every model that was enumerated."""
    rows = []
    for row in counted:
        if row["engine"] != "enumerated":
            continue
        model = promela(tables(row["k"], row["coupled"]))
        for reduction in (False, True):
            print(f"… SPIN, k = {row['k']}{', coupled' * row['coupled']}", file=sys.stderr, flush=True)
            found = spin.searched(model, reduction=reduction, expected=row["states"])
            rows.append({
                "engine": "SPIN, reduced" if reduction else "SPIN", "k": row["k"], "coupled": row["coupled"],
                "states": found.states, "transitions": found.transitions - 1, "deadlocks": found.deadlocks,
                "seconds": round(found.seconds, 4), "from_text": None, "megabytes": found.megabytes,
            })  # fmt: skip
    return rows


def measured() -> list[Row]:
    """All rows; those of SPIN only if it is there."""
    rows = ours()
    if lacking := spin.missing():
        print(f"SPIN is left out: {lacking}", file=sys.stderr)
        return rows
    return rows + theirs(rows)


def readable(rows: list[Row]) -> str:
    lines = ["| k | | states | transitions | deadlocks | search, s | from the text, s | MB |",
             "|---|---|---|---|---|---|---|---|"]  # fmt: skip
    for row in sorted(rows, key=lambda r: (r["k"], r["coupled"])):
        states, transitions, deadlocks = (_count(row[name]) for name in ("states", "transitions", "deadlocks"))
        text = "" if row["from_text"] is None else f"{row['from_text']:.3g}"
        name = row["engine"] + (f", {row['stuck parts']} part stuck" if row.get("stuck parts") else "")
        lines.append(
            f"| {row['k']}{', coupled' * row['coupled']} | {name} | {states} | {transitions} | {deadlocks} "
            f"| {row['seconds']:.3g} | {text} | {row['megabytes']:.0f} |"
        )
    return "\n".join(lines)


def _count(number: int) -> str:
    return f"{number:,}" if number < 10**12 else f"{float(number):.1e}"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("--models", type=Path, help="write the models, as RS and as Promela, into this folder")
    parser.add_argument("--one", nargs=3, metavar=("ENGINE", "K", "COUPLED"), help="one search, in this process")
    given = parser.parse_args()
    if given.one:
        print(json.dumps(one(given.one[0], int(given.one[1]), given.one[2] == "1")))
        return 0
    if given.models:
        given.models.mkdir(parents=True, exist_ok=True)
        for k, coupled in ((2, False), (2, True), (3, False), (3, True), (4, False)):
            name = f"copies_{k}{'_coupled' * coupled}"
            (given.models / f"{name}.rsl").write_text(copies.text(k, coupled=coupled), encoding="utf-8")
            (given.models / f"{name}.pml").write_text(promela(tables(k, coupled), title=name), encoding="utf-8")
    rows = measured()
    print(json.dumps({"measures": rows}) if given.json else readable(rows))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
