"""`python -m tests.mutants`: run every mutant, tell the survivors, write the table.

Results are appended to out/mutants.jsonl as they come; a run that was interrupted goes on where it stopped, for the
modules and tests that have not changed since. A mutant first meets the test that killed it
before, or that killed its neighbour.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import time

from tests.mutants.campaign import OUT, TESTS, Mutant, mutants, summary, unexplained, write_table
from tests.mutants.running import ROOT, Code, judged


def main() -> None:
    """Run, and end with 1 if a survivor is not explained."""
    arguments = argparse.ArgumentParser(prog="python -m tests.mutants", description=__doc__)
    arguments.add_argument("--fresh", action="store_true", help="forget earlier results")
    arguments.add_argument("--module", default="", help="only the mutants of this module")
    arguments.add_argument("--new", action="store_true", help="only mutants that no earlier run has judged")
    given = arguments.parse_args()
    os.environ.setdefault("PYTHONHASHSEED", "0")
    OUT.parent.mkdir(exist_ok=True)
    known = {} if given.fresh else _known()
    code = Code()
    code.warm(TESTS)
    _sound(code)
    found = [m for m in mutants() if not given.module or m.module == given.module]
    results = []
    killers: dict[str, str] = {}
    with OUT.open("w" if given.fresh else "a", encoding="utf-8") as log:
        for mutant in found:
            earlier = known.get(mutant.key)
            again = earlier is not None and earlier["fate"] == "survived" and not given.new
            if earlier is None or earlier["source"] != mutant.source or again:
                likely = (earlier or {}).get("by") or killers.get(mutant.mutation.function, "")
                earlier = _judged(code, mutant, likely)
                killers[mutant.mutation.function] = earlier["by"] or likely
                log.write(json.dumps(earlier, ensure_ascii=False) + "\n")
                log.flush()
            results.append(earlier)
    print(summary(results))
    for result in unexplained(results):
        print(f"survived: {result['rule']}  {result['key']}")
    if not given.module:
        write_table(results)
    raise SystemExit(bool(unexplained(results)))


def _sound(code: Code) -> None:
    """The tests pass on the rules as they are: else every mutant would seem to be found."""
    source = (ROOT / "src/planner_reactor/rs/evolves.py").read_text(encoding="utf-8")
    verdict = judged(code, "planner_reactor.rs.evolves", ast.parse(source), TESTS)
    if verdict.fate != "survived":
        raise SystemExit(f"without any mutant {verdict.by} fails: {verdict.problem}")


def _known() -> dict[str, dict[str, str]]:
    if not OUT.exists():
        return {}
    rows = [json.loads(line) for line in OUT.read_text(encoding="utf-8").splitlines()]
    return {row["key"]: row for row in rows}


def _judged(code: Code, mutant: Mutant, first: str) -> dict[str, str]:
    begun = time.process_time()
    verdict = judged(code, mutant.name, mutant.tree(), TESTS, first=first)
    return {
        "key": mutant.key, "rule": mutant.rule, "source": mutant.source, "fate": verdict.fate, "by": verdict.by,
        "problem": verdict.problem, "seconds": f"{time.process_time() - begun:.2f}",
    }  # fmt: skip


if __name__ == "__main__":
    main()
