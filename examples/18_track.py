"""A camera keeps an object in view. The planner has a model of the two; LOOK and MOVECAMERA it derives from that.

    $ python examples/18_track.py

As long as the object may be taken to stand still there is nothing to do. It moves: the assumption fails, and the
reaction that follows from tracking.rsl, TRACK = LOOK | MOVECAMERA, comes into the running reactor.
"""

from __future__ import annotations

from planner_reactor.experiments.servoing import Scene, domain_for, play
from planner_reactor.trace import Event


def tell(event: Event) -> None:
    if event.kind == "relaxation":
        print(f"{event.time:5.2f} s  {event.data['assumption']} is given up ({event.data['cause']})")
    if event.kind == "adaptation_applied":
        print(f"{event.time:5.2f} s  adapted: {event.data['purpose']}")


print("from the model follow:", *domain_for("tracking").schemas)
scene = Scene(kind="tracking", starts={"p": 0.0, "a": 0.0}, seed=7, until=60.0)
run = play(scene, watch=lambda loop: loop.trace.sinks.append(tell))
print(run.loop.reactor.text(), end="")

instants = [n / 20 for n in range(20 * 60)]
where, looks = run.world.gauge.samples("p", instants), run.world.gauge.samples("a", instants)
print("  at   object  camera")
for n in range(0, len(instants), 200):
    print(f"{instants[n]:4.0f}   {where[n]:6.2f}  {looks[n]:6.2f}")
seen = sum(abs(p - a) <= 1.0 for p, a in zip(where, looks, strict=True))
print(f"in view in {100 * seen / len(instants):.1f} % of the samples")
print("laws broken:", run.loop.reactor.laws.violations)
