"""`python -m tests.fuzz [--many N]`: structured fuzz; goes on where it stopped (out/fuzz.json), until N are done.

Tells each input whose answer was no typed error, that took more than 50 ms of CPU time, or after which the process had
grown by more than 64 MB; ends with 1 if there was one. `--only SEED` takes that one alone, and shows what it raises.
"""

from __future__ import annotations

import argparse
import gc
import json
import resource
import time
from collections import Counter
from pathlib import Path
from typing import Any

from tests.fuzz.subjects import attacked, survived

STATE = Path("out/fuzz.json")
SLOWEST = 0.05
"""Seconds of CPU time."""

AGAIN = 4
"""What takes longer is measured so often again, and the least counts: what else the machine did is not the input's."""

GROWTH = 64_000
"""Kilobytes by which one input may make the process grow."""


def main() -> None:
    arguments = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    arguments.add_argument("--many", type=int, default=1_000_000)
    arguments.add_argument("--only", type=int, default=None)
    arguments.add_argument("--fresh", action="store_true", help="begin at the first seed")
    given = arguments.parse_args()
    if given.only is not None:
        name, attack = attacked(given.only)
        print(name, "refused" if survived(attack) else "taken")
        return
    STATE.parent.mkdir(exist_ok=True)
    state: dict[str, Any] = {"done": 0, "refused": 0, "wrong": []}
    if STATE.exists() and not given.fresh:
        state = json.loads(STATE.read_text())
    slowest: Counter[str] = Counter(state.get("slowest_ms", {}))
    for seed in range(state["done"], given.many):
        name, problem, milliseconds, refused = judged(seed)
        state["refused"] += refused
        slowest[name] = max(slowest[name], round(milliseconds))
        if problem:
            state["wrong"].append([seed, name, problem])
            print(f"seed {seed}, {name}: {problem}", flush=True)
        state |= {"done": seed + 1, "slowest_ms": dict(slowest)}
        if seed % 1_000 == 0:
            STATE.write_text(json.dumps(state))
    STATE.write_text(json.dumps(state))
    wrong = len(state["wrong"])
    print(f"{state['done']:,} inputs, {state['refused']:,} refused, {wrong} wrong; slowest (ms): {dict(slowest)}")
    raise SystemExit(bool(state["wrong"]))


def judged(seed: int) -> tuple[str, str, float, bool]:
    """(subject, what is wrong or "", milliseconds, was it refused?)."""
    name, attack = attacked(seed)
    grown, began = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.thread_time()
    refused, problem = False, ""
    try:
        refused = survived(attack)
    except BaseException as raised:
        if isinstance(raised, KeyboardInterrupt):
            raise
        problem = f"{type(raised).__name__}: {str(raised)[:200]}"
    taken = time.thread_time() - began
    for _ in range(AGAIN):
        if taken <= SLOWEST or problem:
            break
        taken = min(taken, _again(seed))
    if taken > SLOWEST and not problem:
        problem = f"took {taken * 1e3:.0f} ms"
    if (more := resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - grown) > GROWTH:
        problem = problem or f"took {more // 1000} MB"
    return name, problem, taken * 1e3, refused


def _again(seed: int) -> float:
    _, attack = attacked(seed)
    gc.collect()
    began = time.thread_time()
    survived(attack)
    return time.thread_time() - began


main()
