"""The world of greenhouse.itl: three pots, one can on a hook, a tap, and perhaps a hose.

    $ planner-reactor check examples/greenhouse.itl --host examples/greenhouse.py
    $ planner-reactor plan examples/greenhouse.itl --steps 1
    $ planner-reactor loop examples/greenhouse.itl --host examples/greenhouse.py --until 1800 \
          --faults examples/greenhouse.toml --relax STILL

Millilitres are counted: what was drawn or rained is in the can, in a pot, evaporated, or on the floor. The robot's side
has a rain sensor, a pressure gauge at the tap, a wet finger, and its memory of where the pots stand.
"""

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

from planner_reactor.runtime import Aborted, Host, Scheduler, Signal

POTS, CAN, FULL = ("fern", "basil", "fig"), 250, 1000  # millilitres


class Greenhouse:
    """The truth. A World: it starts, keeps its books, and lets faults strike."""

    faults: Mapping[str, Mapping[str, Any]] = {
        "rain": {"millilitres": 600}, "tap_off": {"seconds": 120.0}, "pot_moved": {"pot": "basil"}
    }  # fmt: skip

    def __init__(self, scheduler: Scheduler) -> None:
        self.scheduler = scheduler
        self.water = Counter({"drawn": 1500, **dict.fromkeys(POTS, 500)})
        self.place = dict.fromkeys(POTS, 0)
        self.shaded = False
        self.rained_s, self.pressure, self.turned = -60.0, True, Signal("tap turned on")

    def start(self, scheduler: Scheduler) -> None:
        scheduler.call_after(1.0, self.dry)

    def dry(self) -> None:
        for pot in POTS:
            self.move(pot, "evaporated", min(1 if self.shaded else 3, self.water[pot]))
        self.scheduler.call_after(1.0, self.dry)

    def move(self, source: str, target: str, amount: int) -> None:
        self.water[source] += amount if source in ("drawn", "rained") else -amount
        self.water[target] += amount
        if target in POTS and (over := self.water[target] - FULL) > 0:
            self.move(target, "floor", over)

    def turn_on(self) -> None:
        self.pressure = True
        self.turned.fire()

    def strike(self, kind: str, **parameters: Any) -> bool:
        given = {**self.faults[kind], **parameters}
        if kind == "rain":
            self.rained_s = self.scheduler.now
            for pot in POTS:
                self.move("rained", pot, given["millilitres"])
        elif kind == "tap_off":
            self.pressure = False
            self.scheduler.call_after(given["seconds"], self.turn_on)
        else:
            self.place[given["pot"]] += 1
        return True

    def ledger(self) -> Mapping[str, int]:
        return dict(self.water)

    def balanced(self) -> bool:
        came = self.water["drawn"] + self.water["rained"]
        return came == self.water.total() - came and min(self.water.values()) >= 0

    def finished(self) -> bool:
        return False  # plants are thirsty for ever: give the run an end with --until

    def report(self) -> Mapping[str, object]:
        return {"water": self.ledger()}


def host(scheduler: Scheduler) -> Host:
    """The robot's side of a fresh greenhouse."""
    made = Host("greenhouse")
    made.world = house = Greenhouse(scheduler)
    finger, hung = scheduler.random("finger"), Signal("can hung up")
    seen, hook = dict(house.place), {"free": True}

    def put_can(free: bool) -> None:
        hook["free"] = free
        if free:
            house.move("can", "floor", house.water["can"])
            hung.fire()

    @made.process(window=(0.0, 600.0))
    def TakeCan() -> Iterator[Any]:
        while not hook["free"]:
            yield hung
        put_can(False)
        yield 2.0

    @made.process(window=(0.0, 8.0))
    def Fill() -> Iterator[float]:
        yield 8.0
        if not house.pressure:
            raise Aborted("the can is still empty")
        house.move("drawn", "can", CAN - house.water["can"])

    @made.process(window=(0.0, 6.0))
    def Pour(pot: str) -> Iterator[float]:
        yield 6.0
        if seen[pot] != house.place[pot]:
            made.report("STILL", False, f"{pot} is not where it was")
            raise Aborted(f"{pot} is not there")
        house.move("can", pot, house.water["can"])

    @made.process(window=(2.0, 2.0))
    def Feel(pot: str) -> Iterator[float]:
        yield 2.0
        if house.water[pot] + finger.uniform(-50, 50) > FULL - CAN:
            raise Aborted("wet enough")

    @made.process(window=(10.0, 10.0))
    def Shade() -> Iterator[float]:
        house.shaded = True
        try:
            yield 10.0
        finally:
            house.shaded = False

    @made.process(window=(3.0, 3.0))
    def LookFor(pot: str) -> Iterator[float]:
        yield 3.0
        seen[pot] = house.place[pot]

    @made.process(window=(0.0, 600.0))
    def AwaitWater() -> Iterator[Signal]:
        if not house.pressure:
            yield house.turned

    @made.process(window=(1.0, 1.0))
    def CheckHose() -> Iterator[float]:
        yield 1.0
        raise Aborted("there is none")

    @made.process(window=(0.0, 4.0))
    def Spray(pot: str) -> Iterator[float]:
        yield 4.0
        house.move("drawn", pot, CAN)

    made.process(window=(0.0, 0.0), name="HangUp")(lambda: put_can(True))
    made.process(window=(0.0, 0.0), name="PutAway")(lambda: put_can(True))
    made.assumption("DRY")(lambda: scheduler.now > house.rained_s + 60)
    made.assumption("TAP")(lambda: house.pressure)
    made.assumption("STILL")(lambda: None)  # told by Pour
    return made
