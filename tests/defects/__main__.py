"""`python -m tests.defects`: let every defect meet chaos, tell the survivors, ship the table.

Results are appended to out/defects.jsonl; a run that was interrupted goes on where it stopped, for defects that are
what they were. Ends with 1 if one survives that is not known to be harmless.
"""

from __future__ import annotations

import argparse
import json
import os
from concurrent.futures import ThreadPoolExecutor, as_completed

from tests.defects.defects import by_hand, by_tool, harmless
from tests.defects.hunting import SEEDS, Caught, as_row, hunt
from tests.defects.telling import TABLE, summary
from tests.mutants.running import ROOT, Code

OUT = ROOT / "out/defects.jsonl"


def main() -> None:
    """Run, and end with 1 if a survivor is not explained."""
    arguments = argparse.ArgumentParser(prog="python -m tests.defects", description=__doc__)
    arguments.add_argument("--only", default="", help="only defects in the name of which this stands")
    arguments.add_argument("--fresh", action="store_true", help="forget earlier results")
    arguments.add_argument("--workers", type=int, default=1, help="at once [default: 1]")
    arguments.add_argument("--seeds", type=int, default=SEEDS, help=f"that one meets at most [default: {SEEDS}]")
    arguments.add_argument("--part", default="1/1", help="2/3: the second of three parts, for another machine")
    given = arguments.parse_args()
    os.environ.setdefault("PYTHONHASHSEED", "0")
    OUT.parent.mkdir(exist_ok=True)
    defects = [*by_hand(), *by_tool()]
    chosen = [d for d in defects if given.only in d.name and d.name not in harmless()]
    known = {} if given.fresh else read()
    due = [d for d in chosen if known.get(d.name, Caught("", "")).digest != d.digest or not known[d.name].by]
    code = Code()
    code.warm(("planner_reactor.simulation.running",))
    part, parts = map(int, given.part.split("/"))
    due = due[part - 1 :: parts]
    with ThreadPoolExecutor(given.workers) as pool, OUT.open("a", encoding="utf-8") as log:
        for future in as_completed([pool.submit(hunt, code.shared(), defect, given.seeds) for defect in due]):
            caught = future.result()
            known[caught.name] = caught
            log.write(json.dumps(as_row(caught), ensure_ascii=False) + "\n")
            log.flush()
            print(f"{caught.by or 'SURVIVED'} ({caught.seeds}): {caught.name}", flush=True)
    results = [(defect, known[defect.name]) for defect in chosen if defect.name in known]
    print(summary(results))
    if not given.only and parts == 1:
        rows = [{**as_row(found), "about": d.about, "made": d.made} for d, found in results]
        TABLE.write_text(json.dumps(rows, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    raise SystemExit(any(not found.by for _, found in results))


def read() -> dict[str, Caught]:
    """The results so far."""
    rows = [json.loads(line) for line in OUT.read_text(encoding="utf-8").splitlines()] if OUT.exists() else []
    return {row["name"]: Caught(**{**row, "also": tuple(row["also"])}) for row in rows}


if __name__ == "__main__":
    main()
