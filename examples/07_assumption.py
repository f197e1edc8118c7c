"""An assumption fails and holds again: the reactor itself disables what rests on it, and interrupts nothing.

    $ python examples/07_assumption.py
"""

from collections.abc import Iterator

from planner_reactor.link.messages import Adaptation, Change
from planner_reactor.reactor.reactor import Reactor
from planner_reactor.runtime import Host, Scheduler, VirtualClock
from planner_reactor.trace import Event, Trace

scheduler = Scheduler(VirtualClock())
boat = Host("boat")
weather = {"fog": False}


@boat.process(window=(0.0, 10.0))
def Sail(miles: float) -> Iterator[float]:
    yield miles * 2


@boat.process(window=(0.0, 1.0))
def Ring() -> Iterator[float]:
    yield 1.0


@boat.assumption("Clear")
def clear() -> bool | None:
    """What the sensors say: True, False, or None for unknown."""
    return not weather["fog"]


def tell(event: Event) -> None:
    if event.kind in ("delivered", "ended", "inhibited", "uninhibited", "assumption_holds"):
        print(f"{event.time:5.1f} s  {event.kind:17}", *event.data.values())


trace = Trace(lambda: scheduler.now)
trace.sinks.append(tell)
reactor = Reactor(scheduler, host=boat, trace=trace)
TEXT = """
P[0] = STOP :; ASSERT[cross]
P[1] = SIT[cross]<k> :; (~(Sail[2] : SUCCEED[cross, k]) : FAIL[cross, k])
P[2] = STOP :; ASSERT[bell]
P[3] = SIT[bell]<k> :; (Ring : Delay[4] : SUCCEED[bell, k])
P[4] = ASSUMONITOR[Clear, 1000]
P[5] = HOLDMONITOR[Clear, 1000]
"""
rests = Change(situation="cross", base=0, fresh=True, assumptions=("Clear",))
other = Change(situation="bell", base=0, fresh=True)
reactor.start()
reactor.receive(Adaptation(id=1, definitions=TEXT, changes=(rests, other), adds=(5, 4, 3, 2, 1, 0)))
scheduler.call_at(5.5, lambda: weather.update(fog=True))
scheduler.call_at(13.5, lambda: weather.update(fog=False))
reactor.executer.run(until=20.0)
for told in reactor.perceptions.take():
    print(f"perception {told.number}: {told.kind} {told.subject}, {told.count} times")
