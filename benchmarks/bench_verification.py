"""What it costs to verify every adaptation of a kitting run before it is issued, all nine assumptions relaxed.

`python benchmarks/bench_verification.py`. Each run is one planner with nothing remembered; `cold` forgets also between
the adaptations of one run, so that every one of them is looked at.
"""

from __future__ import annotations

import argparse
import json
import statistics
import time

from planner_reactor.analysis.adaptations import Verdict
from planner_reactor.analysis.looking import Looking, finish
from planner_reactor.experiments.loop import Loop
from planner_reactor.experiments.runs import Run, perform, the_domain
from planner_reactor.link.messages import Adaptation
from planner_reactor.planner import Planner

GOALS_MS = {"median": 50.0, "p99": 500.0}


def main() -> int:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=10)
    parser.add_argument("--json", action="store_true")
    given = parser.parse_args()
    prompt = [(first(True), first(False)) for _ in range(given.runs + 1)][1:]  # the first reads the domain
    found = {
        "verified": told(verifying(given.runs, forgetful=False)),
        "cold": told(verifying(given.runs, forgetful=True)),
        "goals_ms": GOALS_MS,
        "first_adaptation_ms": {
            name: round(statistics.median(pair[n] for pair in prompt), 2) for n, name in enumerate(("with", "without"))
        },
    }
    print(json.dumps(found) if given.json else "\n".join(f"{name}: {value}" for name, value in found.items()))
    return 0


def verifying(runs: int, *, forgetful: bool) -> list[tuple[float, int]]:
    """Milliseconds and states of every verification of some whole runs."""
    taken: list[tuple[float, int]] = []

    def watch(loop: Loop) -> None:
        gate = loop.planner._gate
        assert gate is not None
        examining = gate.examining

        def timed(adaptation: Adaptation) -> Looking[Verdict]:
            if forgetful:
                gate.verifier.forget()
            began = time.perf_counter()
            verdict = finish(examining(adaptation))
            taken.append(((time.perf_counter() - began) * 1e3, verdict.states))
            assert verdict.holds
            yield from ()
            return verdict

        gate.examining = timed  # type: ignore[method-assign]

    for seed in range(runs):
        ran = perform(Run(seed=seed, products=5), watch=watch)
        assert len(ran.loop.relaxations) == 9
    return taken


def told(taken: list[tuple[float, int]]) -> dict[str, float]:
    times = sorted(ms for ms, _ in taken)
    return {
        "adaptations": len(times),
        "looked_at": sum(states > 0 for _, states in taken),
        "most_states": max(states for _, states in taken),
        "median_ms": round(statistics.median(times), 2),
        "p99_ms": round(times[int(0.99 * (len(times) - 1))], 2),
        "most_ms": round(times[-1], 2),
    }


def first(verify: bool) -> float:
    """Milliseconds of thinking until a planner issues its first adaptation."""
    planner = Planner(the_domain(), verify=verify)
    began = time.perf_counter()
    while (step := planner.step()) is not None and not step.adaptations:
        pass
    return (time.perf_counter() - began) * 1e3


if __name__ == "__main__":
    raise SystemExit(main())
