"""trio: structured concurrency."""

from __future__ import annotations

import time

import trio
import trio.testing
from measuring import percentiles, timed

VERSION = trio.__version__


def steps(count: int = 10_000) -> tuple[float, int]:
    async def turn() -> None:
        for _ in range(count):
            await trio.lowlevel.checkpoint()

    async def both() -> None:
        async with trio.open_nursery() as nursery:
            nursery.start_soon(turn)
            nursery.start_soon(turn)

    return timed(lambda: trio.run(both)), 2 * count


def round_trips(count: int = 5_000) -> tuple[float, int]:
    async def play() -> None:
        ask, asked = trio.open_memory_channel[int](0)
        reply, replied = trio.open_memory_channel[int](0)

        async def answer() -> None:
            for _ in range(count):
                await reply.send(await asked.receive())

        async with trio.open_nursery() as nursery:
            nursery.start_soon(answer)
            for number in range(count):
                await ask.send(number)
                await replied.receive()

    return timed(lambda: trio.run(play)), count


def reaction_latency(count: int, events: int = 1000) -> tuple[float, float]:
    """(p50, p99) microseconds from sending to the task that waits for it, among `count` that wait."""

    async def play() -> list[float]:
        ring, rung = trio.open_memory_channel[float](0)
        latencies: list[float] = []

        async def listen() -> None:
            async for begun in rung:
                latencies.append(time.perf_counter() - begun)

        async with trio.open_nursery() as nursery:
            for _ in range(count - 1):
                nursery.start_soon(trio.sleep_forever)
            nursery.start_soon(listen)
            await trio.testing.wait_all_tasks_blocked()
            for _ in range(events):
                await ring.send(time.perf_counter())
                await trio.testing.wait_all_tasks_blocked()
            nursery.cancel_scope.cancel()
        return latencies

    return percentiles(trio.run(play))
