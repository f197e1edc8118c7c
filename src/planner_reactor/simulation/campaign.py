"""Chaos: case after case, on several processes, for so many minutes (`make chaos`).

Seeds go on where the last campaign on the same sources stopped; each case is a line of the results (JSON). A case that
fails is made smaller, and printed as it is to be kept in `tests/simulation/regressions.toml`.
"""

from __future__ import annotations

import argparse
import hashlib
import time
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from pathlib import Path

import msgspec
from msgspec.structs import replace

from planner_reactor.simulation.cases import Case, Fault, drawn
from planner_reactor.simulation.counters import ROWS, missing
from planner_reactor.simulation.keeping import written
from planner_reactor.simulation.running import Result, run
from planner_reactor.simulation.shrinking import shrunk

RESULTS = Path("out/chaos.jsonl")
SECONDS = 1800.0
"""Of simulated time in which faults strike, in each case."""

CELL_EVERY, TWICE_EVERY, CROWD_EVERY = 6, 25, 200
"""Of so many seeds one is the cell's; one is run twice, with jumps of the time of day; one has a crowd."""


class Line(msgspec.Struct, frozen=True):
    """A result, and the sources that it is of."""

    sources: str
    result: Result


def sources() -> str:
    """A digest of everything that is simulated, and of the simulation."""
    root = Path(__file__).parents[1]
    digest = hashlib.sha256()
    for file in sorted(root.rglob("*.py")):
        digest.update(file.read_bytes())
    return digest.hexdigest()[:12]


def case_of(seed: int, seconds: float = SECONDS) -> Case:
    """The case of a seed."""
    case = drawn("cell" if seed % CELL_EVERY == 0 else "workshop", seed, seconds)
    if seed % TWICE_EVERY == 1:
        jumps = (Fault("jump", seconds * part) for part in (0.2, 0.4, 0.7))
        case = replace(case, faults=(*case.faults, *jumps))
    if seed % CROWD_EVERY == 2:
        case = replace(case, faults=(*case.faults, Fault("crowd", seconds / 4, None, 42.0)))
    return case


def one(seed: int, seconds: float = SECONDS) -> Result:
    """Run the case of a seed."""
    return run(case_of(seed, seconds), twice=seed % TWICE_EVERY == 1)


def campaign(first: int, *, minutes: float, workers: int, seconds: float = SECONDS) -> Iterator[Result]:
    """Results as they come, until the time is over."""
    end = time.monotonic() + 60 * minutes
    seed = first
    with ProcessPoolExecutor(workers) as pool:
        running: set[Future[Result]] = set()
        while running or time.monotonic() < end:
            while len(running) < workers + 1 and time.monotonic() < end:
                running.add(pool.submit(one, seed, seconds))
                seed += 1
            done, running = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                yield future.result()


class Sums(msgspec.Struct, frozen=True):
    """What a campaign comes to. `hours` are simulated, by world; `cpu` is seconds; `inside` counts by kind of fault."""

    sources: str
    cases: int
    hours: dict[str, float]
    events: int
    adaptations: int
    inside: dict[str, int]
    violations: int
    cpu: float
    rows: dict[str, int]


def sums(results: Iterable[Result], digest: str = "") -> Sums:
    """Add up."""
    found = list(results)
    rows, inside = Counter[str](), Counter[str]()
    hours: defaultdict[str, float] = defaultdict(float)
    for result in found:
        rows.update(result.rows)
        for where, n in result.inside.items():
            inside[where.partition(" at ")[0]] += n
        hours[result.case.world] += result.simulated / 3600
    return Sums(
        sources=digest,
        cases=len(found),
        hours={world: round(h, 1) for world, h in sorted(hours.items())},
        events=sum(r.events for r in found),
        adaptations=sum(r.adaptations for r in found),
        inside=dict(sorted(inside.items())),
        violations=sum(not r.ok for r in found),
        cpu=round(sum(r.cpu for r in found), 1),
        rows={name: rows[name] for name in ROWS},
    )


def told(came: Sums) -> str:
    """The same, for people."""
    hours = ", ".join(f"{h:.0f} of the {world}" for world, h in came.hours.items())
    lines = [
        f"{came.cases} cases, {sum(came.hours.values()):.0f} simulated hours ({hours}), {came.events:,} events, "
        f"{came.cpu:.0f} s of processor time",
        f"{came.adaptations:,} adaptations, {sum(came.inside.values()):,} faults struck inside one",
        f"{came.violations} cases with violations",
        "",
        *(f"{came.rows[name]:9}  {text}{f' (row {row})' if row else ''}" for name, (row, text) in ROWS.items()),
    ]
    if absent := missing(came.rows):
        lines += ["", f"NOT SEEN: {', '.join(absent)}"]
    return "\n".join(lines)


def read(file: Path, digest: str) -> list[Result]:
    """The results so far of these sources; a last line that was torn off is left out."""
    lines = file.read_bytes().splitlines() if file.exists() else []
    found = [msgspec.json.decode(line, type=Line) for line in lines if line.endswith(b"}")]
    return [line.result for line in found if line.sources == digest]


def kept(result: Result) -> str:
    """A failing case, made smaller, as it is kept."""

    def fails(case: Case) -> bool:
        return not run(case).ok

    case = shrunk(result.case, fails, tries=60) if fails(result.case) else result.case
    return written(case, result.violations[0].splitlines()[-1])


def main(arguments: list[str] | None = None) -> int:
    """The command: exit 1 for a violation, or for a row of the fault table that did not happen."""
    parser = argparse.ArgumentParser(prog="python -m planner_reactor.simulation", description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0, help="how long [default: 10]")
    parser.add_argument("--workers", type=int, default=2, help="processes [default: 2]")
    parser.add_argument("--seed", type=int, help="run the case of one seed alone, and say what came of it")
    parser.add_argument("--results", type=Path, default=RESULTS, help=f"where they stand [default: {RESULTS}]")
    given = parser.parse_args(arguments)
    if given.seed is not None:
        result = one(given.seed)
        print(told(sums([result])), *result.violations, sep="\n")
        return int(not result.ok)
    digest = sources()
    done = read(given.results, digest)
    given.results.parent.mkdir(parents=True, exist_ok=True)
    first = max((r.case.seed for r in done), default=0) + 1
    with given.results.open("ab") as file:
        for result in campaign(first, minutes=given.minutes, workers=given.workers):
            done.append(result)
            file.write(msgspec.json.encode(Line(digest, result)) + b"\n")
            file.flush()
            if not result.ok:
                print(f"seed {result.case.seed}:", *result.violations[:3], kept(result), sep="\n", flush=True)
    came = sums(done, digest)
    print(told(came))
    return int(bool(missing(came.rows) or came.violations))
