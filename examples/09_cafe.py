"""The world of 09_cafe.itl: tables, guests who leave cups, a robot that clears them (docs/hosts.md explains a host).

The robot's side sees how often the door opened, what its bumper feels, and a picture that is wrong one time in fifty.
What is truly on a table it never sees.
"""

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

from planner_reactor.runtime import Aborted, Host, Scheduler, Signal

TABLES, HOUR = ("window", "corner", "terrace"), 3600.0


class Cafe:
    """The truth. A World: it starts, keeps its books, and lets faults strike."""

    faults: Mapping[str, Mapping[str, Any]] = {"quiet": {"hours": 3.0}, "aisle_blocked": {"minutes": 30.0}}

    def __init__(self, scheduler: Scheduler) -> None:
        self.scheduler, self.chance = scheduler, scheduler.random("guests")
        self.hours, self.opened_s, self.quiet_until, self.free = 0, 0.0, 0.0, True
        self.cups = dict.fromkeys(TABLES, 0)
        self.books = Counter(served=0, cleared=0)
        self.rounds: Counter[str] = Counter()
        self.chime, self.passage = Signal("chime"), Signal("passage")

    def start(self, scheduler: Scheduler) -> None:
        scheduler.call_after(HOUR, self.strike_hour)
        self.scheduler.call_after(300.0, self.guests_come)

    def strike_hour(self) -> None:
        self.hours += 1
        self.chime.fire(f"hour{self.hours}")
        self.scheduler.call_after(HOUR, self.strike_hour)

    def guests_come(self) -> None:
        if self.scheduler.now >= self.quiet_until:
            self.opened_s, cups = self.scheduler.now, self.chance.randint(1, 4)
            self.cups[self.chance.choice(TABLES)] += cups
            self.books["served"] += cups
        self.scheduler.call_after(self.chance.uniform(300, 900), self.guests_come)

    def clear(self, table: str) -> None:
        self.rounds[table if self.cups[table] else f"{table} in vain"] += 1
        self.books["cleared"] += self.cups[table]
        self.cups[table] = 0

    def free_aisle(self) -> None:
        self.free = True
        self.passage.fire()

    def strike(self, kind: str, **parameters: Any) -> bool:
        given = {**self.faults[kind], **parameters}
        if kind == "quiet":
            self.quiet_until = self.scheduler.now + given["hours"] * HOUR
        else:
            self.free = False
            self.scheduler.call_after(given["minutes"] * 60, self.free_aisle)
        return True

    def ledger(self) -> Mapping[str, int]:
        return {**self.books, "on_tables": sum(self.cups.values())}

    def balanced(self) -> bool:
        return self.books["served"] == self.books["cleared"] + sum(self.cups.values())

    def finished(self) -> bool:
        return False  # it never is: give the run an end with --until

    def report(self) -> Mapping[str, object]:
        return {"hours": self.hours, "cups": self.ledger(), "cleared": dict(self.rounds)}


def host(scheduler: Scheduler) -> Host:
    """The robot's side of a fresh café: four processes, and what can be sensed of two assumptions."""
    made = Host("cafe")
    made.world = cafe = Cafe(scheduler)
    camera = scheduler.random("camera")
    done: set[tuple[str, str]] = set()

    @made.process(results=("hour",), window=(0.0, HOUR))
    def AwaitHour() -> Iterator[Signal]:
        return (yield cafe.chime)

    @made.process(window=(0.0, 150.0))
    def Clear(table: str, hour: str) -> Iterator[float]:
        if (table, hour) in done:
            return  # what is done is not done twice, however often it is asked for
        yield 30.0
        if not cafe.free:
            made.report("Aisle", False, "bumped into something")
            raise Aborted("the aisle is blocked")
        yield 120.0
        done.add((table, hour))
        cafe.clear(table)

    @made.process(window=(10.0, 10.0))
    def Look(table: str, hour: str) -> Iterator[float]:
        yield 10.0
        if bool(cafe.cups[table]) == (camera.random() < 0.02):
            raise Aborted("the table looks clean")

    @made.process(window=(0.0, HOUR))
    def AwaitAisle() -> Iterator[Signal]:
        if not cafe.free:
            yield cafe.passage

    made.assumption("Guests")(lambda: scheduler.now < cafe.opened_s + HOUR)
    made.assumption("Aisle")(lambda: None)  # unknown, until Clear runs into something and says so
    return made
