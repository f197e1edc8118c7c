"""SimPy: discrete events on a virtual clock, processes as generators."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import simpy
from measuring import timed

VERSION = simpy.__version__


def steps(count: int = 50_000) -> tuple[float, int]:
    """Two processes that yield to each other, no time passing."""
    world = simpy.Environment()

    def turn() -> Iterator[Any]:
        for _ in range(count):
            yield world.timeout(0)

    for _ in range(2):
        world.process(turn())
    return timed(world.run), 2 * count


def round_trips(count: int = 10_000) -> tuple[float, int]:
    world = simpy.Environment()
    there, back = simpy.Store(world, 1), simpy.Store(world, 1)

    def ask() -> Iterator[Any]:
        for number in range(count):
            yield there.put(number)
            yield back.get()

    def answer() -> Iterator[Any]:
        for _ in range(count):
            value = yield there.get()
            yield back.put(value)

    world.process(ask())
    world.process(answer())
    return timed(world.run), count


def delays(processes: int, rounds: int) -> tuple[float, int]:
    world = simpy.Environment()

    def tick(period: int) -> Iterator[Any]:
        for _ in range(rounds):
            yield world.timeout(period)

    for index in range(processes):
        world.process(tick(1 + index % 7))
    return timed(world.run), processes * rounds
