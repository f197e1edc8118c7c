"""`python -m tests.schedules [--many N] [--whole N]`: a long campaign; goes on where it stopped (out/schedules.jsonl).

Batches of 1,000 schedules, each a line; of 100 batches 95 are the café's, 4 the greenhouse's, 1 the workcell's.
`--whole N` runs N with the real reactor beside (out/whole.jsonl), in batches of 50; `--orders N` N orders in which nine
assumptions are given up (out/orders.jsonl), in batches of 20; `--sets` all 2⁹ sets (out/sets.jsonl). `--only LIFE` is
one life alone.
Ends with 1 if a schedule did not end as it has to.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import random
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import planner_reactor
from planner_reactor.workcell.evidence import ASSUMPTIONS
from tests.schedules.ledger import Unsafe
from tests.schedules.life import Life, Tally, domain
from tests.schedules.orders import drawn, relaxes, walks
from tests.schedules.whole import WholeLife

BATCH, LIVES = 1000, 20
WHOLE_BATCH, ORDERS_BATCH = 50, 20
OUT = Path("out")


def life_of(number: int) -> Life:
    """The life of this number: which domain, whether all may return, what is relaxed by choice."""
    draw = random.Random(f"life {number}")
    place = number // LIVES % 100
    name = "kitting" if place == 99 else "greenhouse" if place >= 95 else "cafe"
    returning = draw.random() < 0.7
    names = list(domain(name, returning).assumptions)
    return Life(name, returning, (draw.choice(names),) if draw.random() < 0.2 else ())


def live(number: int, schedules: int = BATCH // LIVES) -> tuple[Tally, str]:
    """Live it; what came of it, and what was wrong, or ""."""
    life = life_of(number)
    for n in range(schedules):
        try:
            life.run(f"{number}.{n}")
        except Unsafe as problem:
            return life.tally, f"life {number}, schedule {n}: {problem}"
    return life.tally, ""


def batch(number: int) -> dict[str, Any]:
    tally, wrong = Tally(), []
    for life in range(number * LIVES, (number + 1) * LIVES):
        found, problem = live(life)
        tally.add(found)
        wrong += [problem] if problem else []
    counts = {key: getattr(tally, key) for key in (*COUNTS, "most")}
    return {**counts, "reached": dict(tally.reached), "wrong": wrong}


COUNTS = ("schedules", "issued", "changes", "flips", "unapplied", "perceived")


def whole_batch(number: int) -> dict[str, Any]:
    """So many schedules in five lives with the real reactor."""
    wrong, done = [], 0
    for life in range(number * 5, number * 5 + 5):
        lived = WholeLife("greenhouse" if life % 5 == 4 else "cafe", life % 3 > 0, life)
        for n in range(WHOLE_BATCH // 5):
            try:
                lived.run(f"{life}.{n}")
                done += 1
            except Unsafe as problem:
                wrong.append(f"whole life {life}, schedule {n}: {problem}")
                break
    return {"schedules": done, "wrong": wrong}


def orders_batch(number: int) -> dict[str, Any]:
    """So many orders, each with its comparisons of reactors."""
    wrong, compared = [], 0
    for seed in range(number * ORDERS_BATCH, (number + 1) * ORDERS_BATCH):
        try:
            compared += relaxes(drawn(seed))
        except Unsafe as problem:
            wrong.append(f"order {seed}: {problem}")
    return {"schedules": ORDERS_BATCH, "compared": compared, "wrong": wrong}


def sets_batch(number: int) -> dict[str, Any]:
    """64 of the 2⁹ sets: which of three assumptions are given up is the number of the batch."""
    given_up = [name for place, name in enumerate(ASSUMPTIONS[6:]) if number >> place & 1]
    try:
        return {"compared": walks(given_up, ASSUMPTIONS[:6]), "wrong": []}
    except Unsafe as problem:
        return {"compared": 0, "wrong": [f"sets {number}: {problem}"]}


def sources() -> str:
    """A digest of what is under test."""
    root, digest = Path(planner_reactor.__file__).parent, hashlib.sha256()
    for file in sorted(f for room in ("planner", "reactor", "logic") for f in (root / room).rglob("*.py")):
        digest.update(file.read_bytes())
    return digest.hexdigest()[:12]


def campaign(file: Path, batches: int, one: Callable[[int], dict[str, Any]]) -> int:
    """Run the batches that are not in the file yet, and say what all of them came to."""
    file.parent.mkdir(exist_ok=True)
    lines = [line for line in file.read_bytes().splitlines() if line.endswith(b"}")] if file.exists() else []
    rows, digest = [json.loads(line) for line in lines], sources()
    with file.open("ab") as target:
        for number in range(len(rows), batches):
            begun = time.process_time()
            row = {**one(number), "cpu_s": round(time.process_time() - begun, 3), "sources": digest}
            rows.append(row)
            target.write(json.dumps(row).encode() + b"\n")
            target.flush()
    return told(rows)


def told(rows: list[dict[str, Any]]) -> int:
    """Print the totals; 1 if anything was wrong."""
    totals = {key: sum(row[key] for row in rows) for key in (*COUNTS, "compared") if rows and key in rows[0]}
    reached: Counter[str] = Counter()
    for row in rows:
        reached.update(row.get("reached", {}))
    wrong = [problem for row in rows for problem in row["wrong"]]
    print(*wrong[:20], sep="\n", end="\n" if wrong else "")
    print(", ".join(f"{value:,} {key}" for key, value in totals.items()))
    most = max((row.get("most", 0.0) for row in rows), default=0.0)
    print(f"{len(reached)} sets of assumptions given up in the end; at most {most:g} adaptations for one change")
    print(f"{len(wrong)} wrong; {sum(row['cpu_s'] for row in rows):.0f} s of CPU time")
    return int(bool(wrong))


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.schedules", description=__doc__)
    parser.add_argument("--many", type=int, default=1_000_000)
    parser.add_argument("--whole", type=int, default=0)
    parser.add_argument("--orders", type=int, default=0)
    parser.add_argument("--sets", action="store_true")
    parser.add_argument("--only", type=int, default=None)
    given = parser.parse_args()
    if given.only is not None:
        print(live(given.only))
        return
    if given.whole:
        raise SystemExit(campaign(OUT / "whole.jsonl", given.whole // WHOLE_BATCH, whole_batch))
    if given.orders:
        raise SystemExit(campaign(OUT / "orders.jsonl", given.orders // ORDERS_BATCH, orders_batch))
    if given.sets:
        raise SystemExit(campaign(OUT / "sets.jsonl", 8, sets_batch))
    raise SystemExit(campaign(OUT / "schedules.jsonl", given.many // BATCH, batch))


if __name__ == "__main__":
    main()
