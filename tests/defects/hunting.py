"""Let a defect meet seeds of chaos until a law, a ledger or a counter catches it.

A child is forked that has imported nothing of ours, imports the changed modules in the place of the real ones, and runs
case after case. What it may use of the processor in one case is limited: going round for ever is being caught, too.
"""

from __future__ import annotations

import json
import os
import re
import resource
import signal
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

from tests.defects.defects import Defect
from tests.mutants.running import MEMORY, Code, forget

SEEDS = 100
"""That a defect meets at most."""

ENOUGH = 10
"""Seeds after which a counter that is still at 0 has caught it."""

SECONDS = 600.0
CPU = 20.0
"""Seconds of processor time in one case: the longest needs 6."""


@dataclass(frozen=True, slots=True)
class Caught:
    """How a defect was caught: `by` a law (or "no end", "an exception", a counter; "" if it was not), at which seed."""

    name: str
    digest: str
    by: str = ""
    seeds: int = 0
    also: tuple[str, ...] = ()
    message: str = ""


def hunt(code: Code, defect: Defect, seeds: int = SEEDS) -> Caught:
    """Run chaos on a defect."""
    code.changed = {
        f"planner_reactor.{module}": compile(text, f"<defect of {module}>", "exec")
        for module, text in defect.sources.items()
    }
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        with os.fdopen(writing, "w") as said:
            _live(code, defect, seeds, lambda line: (said.write(line + "\n"), said.flush()))
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as heard:
        lines = heard.read().splitlines()
    _, status = os.waitpid(child, 0)
    code.changed = {}
    return _verdict(defect, lines, status)


def _verdict(defect: Defect, lines: list[str], status: int) -> Caught:
    tried = sum(line.startswith("seed") for line in lines)
    last = lines[-1] if lines else ""
    if last.startswith("{"):
        return Caught(defect.name, defect.digest, seeds=tried, **json.loads(last))
    if last == "survived":
        return Caught(defect.name, defect.digest, seeds=tried)
    why = signal.Signals(status & 127).name if status & 127 else "ended"
    return Caught(defect.name, defect.digest, "no end", max(tried, 1), (), why)


def _live(code: Code, defect: Defect, seeds: int, say: Callable[[str], object]) -> None:
    """In the child."""
    resource.setrlimit(resource.RLIMIT_AS, (2 * MEMORY, 2 * MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    sys.meta_path.insert(0, code)
    forget()
    sys.stdout = sys.stderr = open(os.devnull, "w")  # noqa: SIM115
    try:
        say(_met(defect, seeds, say))
    except BaseException as problem:  # it cannot even be imported, or ends the run itself
        say(json.dumps({"by": f"an exception ({type(problem).__name__})", "message": str(problem)[:200]}))


def _met(defect: Defect, seeds: int, say: Callable[[str], object]) -> str:
    from planner_reactor.simulation.running import run  # with the defect

    rows: Counter[str] = Counter()
    for seed in range(1, seeds + 1):
        say(f"seed {seed}")
        signal.setitimer(signal.ITIMER_VIRTUAL, CPU)
        result = run(case_of(defect, seed), twice=defect.cases == "twice")
        rows.update(result.rows)
        if result.violations:
            by = list(dict.fromkeys(map(_law, result.violations)))
            message = result.violations[0].strip().splitlines()[-1][:200]
            return json.dumps({"by": by[0], "also": by[1:], "message": message})
        if defect.counter and seed == ENOUGH and not rows[defect.counter]:
            return json.dumps({"by": "a counter at 0", "message": defect.counter})
    return "survived"


def _law(violation: str) -> str:
    if found := re.match(r"law \d+", violation):
        return found[0]
    return f"an exception ({violation.strip().splitlines()[-1].partition(':')[0].rpartition('.')[2]})"


def case_of(defect: Defect, seed: int) -> Any:
    """The case in which a defect meets a seed."""
    from msgspec.structs import replace

    from planner_reactor.simulation.cases import Case, Fault, drawn

    match defect.cases:
        case "cell":
            case = drawn("cell", seed, SECONDS)
        case "crowd":
            case = Case("workshop", seed, 200.0, (Fault("crowd", 20.0, None, 60.0),))
        case _:
            case = drawn("workshop", seed, SECONDS)
    added = [*defect.faults, *(["failing"] if defect.cases == "storm" else ())]
    added += ["jump", "jump"] if defect.cases == "twice" else []
    at = (40.0 + (seed * 37 + 90 * (n // 2) + 4 * (n % 2)) % (SECONDS - 100) for n in range(len(added)))
    parted = (kind.partition(":") for kind in added)
    faults = (Fault(kind, when, None, 12.0, what) for (kind, _, what), when in zip(parted, at, strict=False))
    return replace(case, faults=tuple(sorted((*case.faults, *faults), key=lambda fault: fault.at)))


def as_row(caught: Caught) -> dict[str, Any]:
    return asdict(caught)
