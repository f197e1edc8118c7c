"""A hand acquires an object that wanders about. No plan says how: GuardedMove follows from a model of hand and object.

    $ python examples/19_reach.py

Two goals: keep the object in view (TRACK), and acquire it: (CONTACT # (LOOK | MOVETOWARDS)) : ACQUIRE. The actions are
derived from guarded_move.rsl; that LOOK and MOVETOWARDS go on until there is contact is found by interval logic.
"""

from __future__ import annotations

from planner_reactor.experiments.servoing import Scene, domain_for, play

print("from the model follow:", *domain_for("reaching").schemas)
for seed in range(1, 6):
    starts = {"p": 1.0 - seed, "a": 1.0 - seed, "pr": 6.0}
    run = play(Scene(kind="reaching", starts=starts, constants={"eps": 0.3}, seed=seed, target=1))
    gauge = run.world.gauge
    print(
        f"object from {starts['p']:4.1f} to {gauge.now['p']:5.2f}, hand from 6.0: in the hand after "
        f"{gauge.acquired[0]:.2f} s, {gauge.moves} motions, {len(gauge.grips)} grips"
    )
print(run.loop.reactor.text(), end="")
