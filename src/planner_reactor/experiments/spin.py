"""SPIN as a witness: an exported model searched exhaustively by the model checker itself.

Needs `spin` and a C compiler on the path; `missing` says what is not there. The verifier's table of states is given
room for twice as many states as expected, so that its memory is what it needs and no more.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import msgspec

from planner_reactor.errors import PlannerReactorError

TIMEOUT = 600
"""Seconds that one search may take."""


class Searched(msgspec.Struct, frozen=True):
    """What SPIN found: states stored, transitions, invalid end states; seconds and MB of the search alone."""

    states: int
    transitions: int
    deadlocks: int
    seconds: float
    megabytes: float


def missing() -> str:
    """What is needed and not there, or nothing."""
    lacking = [tool for tool in ("spin", "gcc") if shutil.which(tool) is None]
    return f"{' and '.join(lacking)} not found on the path" if lacking else ""


def version() -> str:
    found = subprocess.run(["spin", "-V"], capture_output=True, text=True, check=True).stdout
    return found.split("--")[0].strip()


def searched(model: str, *, reduction: bool = False, fast: bool = True, expected: int = 1000) -> Searched:
    """Search all of a Promela model for invalid end states, with SPIN's partial-order reduction or without.

    `fast` compiles the verifier for speed, which takes longer than a small search.
    """
    with TemporaryDirectory() as folder:
        home = Path(folder)
        (home / "model.pml").write_text(model, encoding="utf-8")
        _run(["spin", "-a", "model.pml"], home)
        options = ["-O2" if fast else "-O0", "-w", "-DSAFETY", "-DMEMLIM=8000"]
        options += [] if reduction else ["-DNOREDUCE"]
        _run(["gcc", *options, "-o", "pan", "pan.c"], home)
        slots = max(10, (2 * expected).bit_length())
        begun = time.perf_counter()
        said = _run(["./pan", "-c0", "-n", f"-w{slots}", f"-m{max(10_000, 2 * expected)}"], home)
        return _read(said, time.perf_counter() - begun)


def _run(command: list[str], home: Path) -> str:
    done = subprocess.run(command, cwd=home, capture_output=True, text=True, timeout=TIMEOUT, check=False)
    if done.returncode != 0:
        raise PlannerReactorError(f"{command[0]} failed: {(done.stderr or done.stdout)[-500:]}")
    return done.stdout


def _read(said: str, seconds: float) -> Searched:
    if "Search not completed" in said or "max search depth too small" in said:
        raise PlannerReactorError(f"SPIN's search is not complete: {said[:300]}")
    return Searched(
        states=int(_number(r"(\d+) states, stored", said)),
        transitions=int(_number(r"(\d+) transitions", said)),
        deadlocks=int(_number(r"errors: (\d+)", said)),
        seconds=seconds,
        megabytes=_number(r"([\d.]+)\s+total actual memory usage", said),
    )


def _number(pattern: str, said: str) -> float:
    found = re.search(pattern, said)
    if found is None:
        raise PlannerReactorError(f"SPIN did not say {pattern}: {said[:300]}")
    return float(found.group(1))
