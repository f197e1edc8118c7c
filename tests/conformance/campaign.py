"""A long run of random programs, resumed where it stopped: `python -m tests.conformance`, or `make conformance`.

Batches of 1,000 seeds; each is a line of the results (JSON), with a digest of the sources that it held against each
other. What counts as one campaign is what was run on the same sources: lines of others stay, and are told apart.
"""

from __future__ import annotations

import argparse
import hashlib
import sys
import time
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

import msgspec

import planner_reactor
from tests.conformance.coverage import Coverage, Row
from tests.conformance.running import conforms
from tests.conformance.texts import example

BATCH = 1000
RESULTS = Path("out/conformance.jsonl")
ROOMS = ("rs", "runtime", "reactor")


class Batch(msgspec.Struct, frozen=True):
    """What came of the programs `first` to `first + BATCH - 1`."""

    first: int
    programs: int
    steps: int
    seconds: float  # of processor time
    sources: str
    disagreements: tuple[tuple[int, str], ...]  # seed, what was seen
    unfollowed: int  # programs of which the labels said too little to follow them to their end
    rows: tuple[tuple[Row, int], ...]


def sources() -> str:
    """A digest of both sides: the semantics, and the executer with the reactor's processes."""
    root = Path(planner_reactor.__file__).parent
    digest = hashlib.sha256()
    for file in sorted(file for room in ROOMS for file in (root / room).rglob("*.py")):
        digest.update(file.read_bytes())
    return digest.hexdigest()[:12]


def batch(first: int, coverage: Coverage, digest: str, programs: int = BATCH) -> Batch:
    """Run these programs; `coverage` counts on."""
    before, begun = coverage.table(), time.process_time()
    steps = unfollowed = 0
    disagreements: list[tuple[int, str]] = []
    for seed in range(first, first + programs):
        try:
            run = conforms(example(seed), seed)
            steps += run.steps
            unfollowed += run.lost
        except Exception as problem:  # whatever it is, it is a finding
            disagreements.append((seed, f"{type(problem).__name__}: {problem}"))
    rows = tuple((row, hits - before[row]) for row, hits in coverage.table().items())
    seconds = time.process_time() - begun
    return Batch(first, programs, steps, seconds, digest, tuple(disagreements), unfollowed, rows)


def read(file: Path) -> list[Batch]:
    """The batches so far; a last line that was torn off is left out."""
    lines = file.read_bytes().splitlines() if file.exists() else []
    return [msgspec.json.decode(line, type=Batch) for line in lines if line.endswith(b"}")]


def summary(batches: Iterable[Batch]) -> str:
    """Programs done, rows covered, disagreements."""
    found = list(batches)
    rows: Counter[Row] = Counter()
    for b in found:
        rows.update(dict(b.rows))
    bad = [d for b in found for d in b.disagreements]
    programs, steps = sum(b.programs for b in found), sum(b.steps for b in found)
    lines = [
        f"{programs} programs, {steps} steps, {sum(b.seconds for b in found):.0f} s of processor time",
        f"{sum(hits > 0 for hits in rows.values())} of {len(rows)} rows covered",
        f"{sum(b.unfollowed for b in found)} programs not followed to their end",
        f"{len(bad)} disagreements",
    ]
    return "\n".join([*lines, *(f"  seed {seed}: {what}" for seed, what in bad[:20])])


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.conformance", description=__doc__)
    parser.add_argument("--first", type=int, default=0, metavar="SEED", help="where several share it [default: 0]")
    parser.add_argument("--until", type=int, default=1_000_000, metavar="SEED", help="stop before [default: 1000000]")
    parser.add_argument("--results", type=Path, default=RESULTS, help=f"where they stand [default: {RESULTS}]")
    parser.add_argument("--summary", action="store_true", help="only say what was done so far")
    given = parser.parse_args(arguments)
    digest = sources()
    done = [b for b in read(given.results) if b.sources == digest or given.summary]
    if not given.summary:
        given.results.parent.mkdir(parents=True, exist_ok=True)
        coverage = Coverage()
        first = max((b.first + b.programs for b in done if b.first >= given.first), default=given.first)
        with given.results.open("ab") as file:
            for start in range(first, given.until, BATCH):
                done.append(batch(start, coverage, digest))
                file.write(msgspec.json.encode(done[-1]) + b"\n")
                file.flush()
                print(f"{start + BATCH} of {given.until}: {len(done[-1].disagreements)} disagreements", flush=True)
        coverage.close()
    for version in dict.fromkeys(b.sources for b in done):
        print(f"sources {version}{' (these)' if version == digest else ''}:")
        print(summary(b for b in done if b.sources == version))
    return int(any(b.disagreements for b in done))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
