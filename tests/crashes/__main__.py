"""`python -m tests.crashes`: the whole matrix; goes on where it stopped (out/crashes.jsonl, a line a case).

Every shape of up to six situations, of up to four also where some are kept, in every way; crash and power loss at every
step of each; the link cut at every frame of those of up to `--cuts` situations. Ends with 1 if anything was wrong.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from pathlib import Path

from tests.crashes.matrix import looked_at
from tests.crashes.shapes import cases, situations

RESULTS = Path("out/crashes.jsonl")


def main() -> None:
    arguments = argparse.ArgumentParser(prog="python -m tests.crashes", description=__doc__)
    arguments.add_argument("--most", type=int, default=6, help="situations")
    arguments.add_argument("--kept", type=int, default=4, help="situations, where some are kept")
    arguments.add_argument("--cuts", type=int, default=4, help="situations, where the link is cut")
    arguments.add_argument("--fresh", action="store_true", help="begin at the first case")
    given = arguments.parse_args()
    RESULTS.parent.mkdir(exist_ok=True)
    if given.fresh:
        RESULTS.unlink(missing_ok=True)
    lines = RESULTS.read_text().splitlines() if RESULTS.exists() else []
    found = {line["case"]: line for line in map(json.loads, lines)}
    with RESULTS.open("a") as results:
        for case in cases(given.most, kept=given.kept):
            if str(case) not in found:
                finding = looked_at(case, cuts=len(situations(case.forest)) <= given.cuts)
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


main()
