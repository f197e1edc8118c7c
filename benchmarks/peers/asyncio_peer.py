"""asyncio: coroutines on an event loop."""

from __future__ import annotations

import asyncio
import platform
import time
from collections.abc import Coroutine
from typing import Any

from measuring import percentiles, timed

VERSION = platform.python_version()


def _timed(work: Coroutine[Any, Any, None]) -> float:
    return timed(lambda: asyncio.run(work))


def steps(count: int = 20_000) -> tuple[float, int]:
    async def turn() -> None:
        for _ in range(count):
            await asyncio.sleep(0)

    async def both() -> None:
        await asyncio.gather(turn(), turn())

    return _timed(both()), 2 * count


def round_trips(count: int = 10_000) -> tuple[float, int]:
    async def play() -> None:
        there: asyncio.Queue[int] = asyncio.Queue()
        back: asyncio.Queue[int] = asyncio.Queue()

        async def answer() -> None:
            for _ in range(count):
                await back.put(await there.get())

        answering = asyncio.create_task(answer())
        for number in range(count):
            await there.put(number)
            await back.get()
        await answering

    return _timed(play()), count


def reaction_latency(count: int, events: int = 1000) -> tuple[float, float]:
    """(p50, p99) microseconds from setting an event to the task that waits for it, among `count` that wait."""

    async def play() -> list[float]:
        ring, heard = asyncio.Event(), asyncio.Event()
        latencies: list[float] = []
        begun = 0.0

        async def listen() -> None:
            while True:
                await ring.wait()
                latencies.append(time.perf_counter() - begun)
                ring.clear()
                heard.set()

        others = [asyncio.create_task(asyncio.Event().wait()) for _ in range(count - 1)]
        listening = asyncio.create_task(listen())
        await asyncio.sleep(0)
        for _ in range(events):
            begun = time.perf_counter()
            ring.set()
            await heard.wait()
            heard.clear()
        for task in (*others, listening):
            task.cancel()
        await asyncio.gather(*others, listening, return_exceptions=True)
        return latencies

    return percentiles(asyncio.run(play()))
