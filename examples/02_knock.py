"""The world of 02_knock.rsl: a door behind which somebody is slow to get up.

A host registers basic processes. A plain function ends at once; a generator may wait: `yield 2.0` is two seconds.
Each has an age window in seconds, so that nothing can last for ever unnoticed.
"""

from collections.abc import Iterator

from planner_reactor.runtime import Aborted, Host, Scheduler


def host(scheduler: Scheduler) -> Host:
    """Called once for each run."""
    house = Host("house")

    @house.process(results=("who",), window=(2.0, 2.0))
    def Knock() -> Iterator[float]:
        yield 2.0
        if scheduler.now < 10:
            raise Aborted("nobody came")
        return "Ada"

    @house.process(results=("answer",), window=(0.0, 0.0))
    def Greet(who: str) -> str:
        return f"hello from {who}"

    return house
