"""The world of 04_first_to_end.rsl: a press with one motor and one feeler, 10 mm/s, something in the way at 50 mm.

A process that is aborted from outside while it runs is told once, by its `abandon`: no command stays alive.
"""

from collections.abc import Iterator

from planner_reactor.runtime import Host, Scheduler, Signal

SPEED, WAY = 10.0, 50.0


def host(scheduler: Scheduler) -> Host:
    press = Host("press")
    felt = Signal("felt")

    def stop_motor(depth: float) -> None:
        print(f"{scheduler.now:.1f} s: motor stopped on the way to {depth} mm")

    @press.process(limit=60.0, abandon=stop_motor)
    def Down(depth: float) -> Iterator[float]:
        print(f"{scheduler.now:.1f} s: motor on")
        yield min(depth, WAY) / SPEED
        if depth > WAY:
            felt.fire(WAY)
            yield 60.0  # pushes in vain
        print(f"{scheduler.now:.1f} s: motor off at {depth} mm")

    @press.process(results=("where",), limit=60.0)
    def Touched() -> Iterator[Signal]:
        return (yield felt)

    return press
