"""A running reactor is rewritten by hand, while it is at work: what is in service finishes first.

    $ python examples/06_rewrite.py
"""

from collections.abc import Iterator

from planner_reactor.link.messages import Adaptation, Change
from planner_reactor.reactor.reactor import Reactor
from planner_reactor.runtime import Host, Scheduler, VirtualClock
from planner_reactor.trace import Event, Trace

scheduler = Scheduler(VirtualClock())
tower = Host("tower")


@tower.process(window=(0.0, 12.0))
def Turn(degrees: float) -> Iterator[float]:
    yield degrees / 30


@tower.process(window=(3.0, 3.0))
def Flash() -> Iterator[float]:
    yield 3.0


def tell(event: Event) -> None:
    if event.kind in ("delivered", "ended", "draining", "removed", "added") or event.kind.startswith("adaptation"):
        print(f"{event.time:5.1f} s  {event.kind:20}", *event.data.values())


trace = Trace(lambda: scheduler.now)
trace.sinks.append(tell)
reactor = Reactor(scheduler, host=tower, trace=trace)

first = Adaptation(
    id=1,
    definitions="""
P[0] = STOP :; ASSERT[watch]
P[1] = SIT[watch]<k> :; (~(Turn[120] : SUCCEED[watch, k]) : FAIL[watch, k])
""",
    changes=(Change(situation="watch", base=0, fresh=True),),
    adds=(1, 0),
)
second = Adaptation(
    id=2,
    definitions="P[2] = SIT[watch]<k> :; (~(Flash : Turn[30] : SUCCEED[watch, k]) : FAIL[watch, k])",
    changes=(Change(situation="watch", base=1),),
    kills=(1,),
    adds=(2,),
)
reactor.start()
scheduler.call_at(1.0, lambda: reactor.receive(first))
scheduler.call_at(7.0, lambda: reactor.receive(second))
reactor.executer.run(until=18.0)
print(reactor.text(), end="")
print("laws broken:", reactor.laws.violations)
