"""The same seed gives the same run, in any process; another seed another."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys

from planner_reactor.runtime import Host, Signal
from tests.runtime.driving import run

PROGRAM = """
Feed[n] = Term[2] : OUT[p,n] : (if GTR[n,9] then STOP else Feed[n+1])
Eat     = ((IN[p]<x> : Ran[0,1]<r>) :: (Term[r] : OUT[q,x] : Work[x]<y>))
"""


def story(seed: int) -> str:
    """Everything that was seen, with its instants, as one hash."""
    host, bell = Host("h"), Signal()
    draws = __import__("random").Random(seed)

    @host.process(results=("y",), limit=20)
    def Work(x: float):  # type: ignore[no-untyped-def]
        yield draws.random()
        bell.fire(x)
        fired = yield bell.within(draws.random())
        return str(fired)

    ran = run("Feed[1] | (Eat # Delay[30]) | ((IN[q]<z> :; STOP) # Delay[30])", PROGRAM, host=host, seed=seed)
    return hashlib.sha256(repr((ran.seen, ran.at, ran.results)).encode()).hexdigest()


def test_the_same_seed_gives_the_same_run_whatever_the_hash_seed() -> None:
    hashes = set()
    for hash_seed in ("0", "1", "4711"):
        done = subprocess.run(
            [sys.executable, "-c", "from tests.runtime.test_determinism import story; print(story(5))"],
            env={**os.environ, "PYTHONHASHSEED": hash_seed}, capture_output=True, text=True, check=True, timeout=15,
        )  # fmt: skip
        hashes.add(done.stdout.strip())
    assert hashes == {story(5)}


def test_another_seed_gives_another_run() -> None:
    assert story(5) != story(6)
