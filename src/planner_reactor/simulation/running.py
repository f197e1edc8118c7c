"""A case is run, and what came of it is a value.

Whatever goes wrong is a finding: a law that was broken, and an exception as well. A case that is run `twice` is run
again without its jumps of the time of day, and must have the same trace (law 16, row 24).
"""

from __future__ import annotations

import time
import traceback

import msgspec
from msgspec.structs import replace

from planner_reactor.simulation.cases import Case
from planner_reactor.simulation.kitting import Cell
from planner_reactor.simulation.stage import CALM, Stage


class Result(msgspec.Struct, frozen=True):
    """What came of a case. `inside`: faults that struck inside an adaptation, by kind and point."""

    case: Case
    simulated: float
    events: int
    adaptations: int
    rows: dict[str, int]
    inside: dict[str, int]
    violations: tuple[str, ...]
    trace_hash: str
    cpu: float

    @property
    def ok(self) -> bool:
        return not self.violations


def run(case: Case, *, twice: bool = False) -> Result:
    """Run a case; with `twice` ask law 16 of it as well."""
    result = _once(case)
    if not twice:
        return result
    faults = tuple(replace(f, kind="nothing") if f.kind == "jump" else f for f in case.faults)
    again = _once(replace(case, faults=faults))
    rows = {**result.rows, "24 runs that were done twice, with jumps and without": int(faults != case.faults)}
    wrong = () if again.trace_hash == result.trace_hash else ("law 16: two runs of one case differ",)
    return replace(result, rows=rows, violations=(*result.violations, *wrong), cpu=result.cpu + again.cpu)


def _once(case: Case) -> Result:
    began = time.process_time()
    stage: Stage | Cell = Stage(case) if case.world == "workshop" else Cell(case)
    violations: list[str] = []
    try:
        stage.run()
    except Exception:
        violations.append(f"at {stage.scheduler.now:.3f} s: {traceback.format_exc(limit=-4)}")
    violations = [str(v) for v in stage.watch.violations] + violations
    return Result(
        case=case,
        simulated=case.seconds + CALM,
        events=stage.trace.count,
        adaptations=stage.watch.totals["adaptations received"],
        rows={row: n for row, n in sorted(stage.rows.items()) if n},
        inside={what: n for what, n in sorted(stage.inside.items()) if n},
        violations=tuple(violations),
        trace_hash=stage.trace.hash,
        cpu=round(time.process_time() - began, 3),
    )
