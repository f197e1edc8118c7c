"""A belt brings parts; others stop it and start it. The reaction changes between GuardedWait and GuardedMove.

    $ python examples/20_belt.py

While the belt runs, waiting is enough: (CONTACT # WAITFOROBJECT) : ACQUIRE follows from belt.rsl, and needs no motion.
That the belt runs is an assumption inside that model. When it fails, the hand has to go: guarded_move.rsl says how.
"""

from __future__ import annotations

from planner_reactor.experiments.servoing import Scene, play
from planner_reactor.trace import Event


def tell(event: Event) -> None:
    match event.kind:
        case "assumption_failure" | "assumption_holds" if event.data["assumption"] == "Running":
            said = "stands" if event.kind == "assumption_failure" else "runs again"
            print(f"{event.time:6.2f} s  the belt {said}")
        case "adaptation_applied" if "Acquire" in event.data["purpose"]:
            waits = "Running" in event.data["assumptions"]
            print(f"{event.time:6.2f} s  {'GuardedWait' if waits else 'GuardedMove'} ({event.data['purpose']})")


scene = Scene(
    kind="line",
    starts={"p": 0.0, "a": 0.0, "pr": 6.0, "s": 1.0},
    constants={"field": 30.0},
    strikes=[(20.0, False), (40.0, True), (61.0, False)],
    until=80.0,
)
run = play(scene, watch=lambda loop: loop.trace.sinks.append(tell))
gauge = run.world.gauge
print("in the hand at", *(f"{when:.1f}" for when in gauge.acquired), "s; lost:", gauge.lost)
print(run.loop.reactor.text(), end="")
