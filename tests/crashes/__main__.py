"""`python -m tests.crashes`: the whole matrix; goes on where it stopped (out/crashes.jsonl, a line a case).

Every shape of up to six situations, of up to four also where some are kept, in every way; crash and power loss at every
step, and the link cut at every frame (of those of up to `--cuts` situations). Ends with 1 if anything was wrong.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

from tests.crashes.matrix import Finding, looked_at
from tests.crashes.shapes import Case, cases, situations

RESULTS = Path("out/crashes.jsonl")


def main() -> None:
    arguments = argparse.ArgumentParser(prog="python -m tests.crashes", description=__doc__)
    arguments.add_argument("--most", type=int, default=6, help="situations")
    arguments.add_argument("--kept", type=int, default=4, help="situations, where some are kept")
    arguments.add_argument("--cuts", type=int, default=6, help="situations, where the link is cut")
    arguments.add_argument("--fresh", action="store_true", help="begin at the first case")
    arguments.add_argument("--workers", type=int, default=2, help="processes")
    given = arguments.parse_args()
    RESULTS.parent.mkdir(exist_ok=True)
    if given.fresh:
        RESULTS.unlink(missing_ok=True)
    lines = RESULTS.read_text().splitlines() if RESULTS.exists() else []
    found = {line["case"]: line for line in map(json.loads, lines)}
    due = [case for case in cases(given.most, kept=given.kept) if str(case) not in found]
    look = partial(looked_at_one, most=given.cuts)
    with RESULTS.open("a") as results, ProcessPoolExecutor(given.workers) as pool:
        for case, finding in zip(due, pool.map(look, due, chunksize=4), strict=True):
            found[str(case)] = {"case": str(case), **finding._asdict()}
            results.write(json.dumps(found[str(case)]) + "\n")
            results.flush()
            print(*finding.wrong, sep="\n", end="\n" if finding.wrong else "")
    counts: Counter[str] = Counter()
    for line in found.values():
        counts.update({what: n for what, n in line.items() if isinstance(n, int)})
    wrong = sum(len(line["wrong"]) for line in found.values())
    print(f"{len(found):,} cases; {', '.join(f'{what} {n:,}' for what, n in counts.items())}; {wrong} wrong")
    raise SystemExit(wrong > 0)


def looked_at_one(case: Case, *, most: int) -> Finding:
    """The link is cut where there are at most so many situations."""
    return looked_at(case, cuts=len(situations(case.forest)) <= most)


if __name__ == "__main__":
    main()
