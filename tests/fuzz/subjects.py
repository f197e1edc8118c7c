"""What is attacked, and what it may answer: a result, or an error that it declares."""

from __future__ import annotations

from collections.abc import Callable
from random import Random

from planner_reactor.errors import PlannerReactorError
from planner_reactor.link.codec import decode, encode
from planner_reactor.logic.reader import read_domain
from planner_reactor.reactor.journal import Journal
from planner_reactor.rs.checks import check_text
from planner_reactor.rs.loading import load
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.printer import show
from tests.fuzz import messages
from tests.fuzz.domains import domain
from tests.fuzz.texts import rs
from tests.reactor.disks import TornDisk
from tests.reactor.driving import FIRST, Bench

Attack = Callable[[], object]
Subject = Callable[[Random], Attack]
"""Makes an input, and gives what takes it: only the taking is measured."""


def of_rs(draw: Random) -> Attack:
    text, how = rs(draw), draw.randrange(3)

    def take() -> None:
        if how == 0:
            check_text(text)
        elif how == 1:
            load(text)
        else:
            printed = "\n".join(show(schema) for schema in parse_program(text).schemas)
            assert "\n".join(show(schema) for schema in parse_program(printed).schemas) == printed

    return take


def of_domain(draw: Random) -> Attack:
    text = domain(draw)
    return lambda: read_domain(text)


def of_journal(draw: Random) -> Attack:
    content = messages.journal(draw)

    def take() -> None:
        disk = TornDisk(content)
        first = Journal(disk).recover().state
        assert Journal(disk).recover().state == first  # what was cut off once is not cut off again

    return take


def of_frame(draw: Random) -> Attack:
    frames = [messages.frame(draw) for _ in range(draw.randint(1, 5))]
    end = messages.session()

    def take() -> None:
        for frame in frames:
            end.receive(frame, 1.0)
            end.due(1.0)

    return take


def of_message(draw: Random) -> Attack:
    content = messages.message(draw)

    def take() -> None:
        taken = encode(decode(content))
        assert encode(decode(taken)) == taken  # what is taken is said again as it is

    return take


def of_adaptation(draw: Random) -> Attack:
    """A reactor at work takes a few of them: it may refuse, time out or apply; no law may break."""
    bench = Bench()
    bench.reactor.receive(FIRST)
    bench.run(1.0)
    hostile = [messages.adaptation(draw, number) for number in range(2, draw.randint(3, 5))]

    def take() -> None:
        for one in hostile:
            bench.reactor.receive(one)
            bench.run(bench.scheduler.now + 1.0)
        assert bench.reactor.laws.violations == [], bench.reactor.laws.violations[:2]

    return take


SUBJECTS: dict[str, Subject] = {
    "RS": of_rs, "domain": of_domain, "journal": of_journal, "frame": of_frame, "message": of_message,
    "adaptation": of_adaptation,
}  # fmt: skip
SHARES = {"RS": 10, "domain": 4, "journal": 6, "frame": 4, "message": 5, "adaptation": 1}
"""How often each is attacked, in proportion."""

ORDER = tuple(name for name, share in SHARES.items() for _ in range(share))


def attacked(seed: int) -> tuple[str, Attack]:
    """The subject of a seed, and the attack on it."""
    name = ORDER[seed % len(ORDER)]
    return name, SUBJECTS[name](Random(seed))


def survived(attack: Attack) -> bool:
    """Was it refused by a typed error? Anything else that is raised is raised."""
    try:
        attack()
    except PlannerReactorError:
        return True
    return False
