"""Denseness as it is computed, and as it is met: random networks of timed processes, run in the executer.

A run is a source of Definition 1, up to three stages (Definition 2, ST, AT, one that waits for two ports side by side
or one after the other, one that offers until it is taken), and a reader that comes at random. Each of its values is the
number of the source's round. Asked of each reading: did it wait longer than γ, is the value older than `age`? The pause
of a STREAM comes on top, once for every STREAM on the way. `python -m tests.analysis.timed_runs --runs 100000` goes on
where it stopped; its results are in out/denseness.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from random import Random
from typing import NamedTuple

from planner_reactor.analysis.denseness import Denseness, dense, opened
from planner_reactor.rs.loading import load
from planner_reactor.rs.prelude import QUANTUM
from planner_reactor.rs.terms import Program
from planner_reactor.runtime import Executer, Host, Scheduler, VirtualClock

PERIODS = 2
"""How many bounding periods a run lasts."""
ALIKE = 20
"""Runs of one network, each with other delays within its bounds."""
CHUNK = 1_000


class Run(NamedTuple):
    """The longest wait and the greatest age that were met, each beside its bound, and how many values were read."""

    text: str
    shape: str
    waited: float
    delay: float
    oldest: float
    age: float
    read: int

    @property
    def holds(self) -> bool:
        return self.waited <= self.delay and self.oldest <= self.age


class Station:
    """What the run tells: when the source stopped offering a value, when the reader was ready, what it got."""

    def __init__(self, scheduler: Scheduler) -> None:
        self._scheduler = scheduler
        self._ended: dict[float, float] = {}
        self._ready = 0.0
        self.waited = self.oldest = 0.0
        self.read = 0
        self.host = Host("station")
        self.host.process(window=(0.0, 0.0), outcomes=("stop",), name="Ended")(self.ended)
        self.host.process(window=(0.0, 0.0), outcomes=("stop",), name="Ready")(self.ready)
        self.host.process(window=(0.0, 0.0), outcomes=("stop",), name="Got")(self.got)

    def ended(self, value: float) -> None:
        self._ended[value] = self._scheduler.now

    def ready(self) -> None:
        self._ready = self._scheduler.now

    def got(self, value: float) -> None:
        now = self._scheduler.now
        self.read += 1
        if self.read > 1:  # the first comes when everything has just begun
            self.waited = max(self.waited, now - self._ready)
        self.oldest = max(self.oldest, now - self._ended.get(value, now))


def network(random: Random) -> tuple[str, str, int]:
    """A random text, its shape, and how many STREAMs are on the way. Ports x0, x1, … and side sources z1, …"""
    def wait(least: float = 0.02, most: float = 0.6) -> str:
        return f"{random.choice(('Delay', 'Term'))}[{round(random.uniform(least, most), 3)}]"

    lines = [f"Source[v] = {wait()} ; ((STREAM[x0, v] # {wait()}) ; (Ended[v] ; Source[v + 1]))"]
    parts, shapes, streams = ["Source[0]"], [], 1
    for n in range(1, random.randint(0, 3) + 1):
        x, y = f"x{n - 1}", f"x{n}"
        shape = random.choice(("Definition 2", "ST", "AT", "both", "then", "until taken"))
        shapes.append(shape)
        held = f"Delay[{round(random.uniform(0.02, 0.6), 3)}]"
        match shape:
            case "Definition 2":
                lines.append(f"S{n} = IN[{x}]<v> : ({wait()} ; (STREAM[{y}, v] # {wait()})) ; S{n}")
            case "ST":
                lines.append(f"S{n} = (IN[{x}]<v> ; {wait()}) :; (STREAM[{y}, v] # {wait()})")
            case "AT" if random.random() < 0.5:
                lines.append(f"S{n} = ({held} ; IN[{x}]<v> ; {wait()}) :: (STREAM[{y}, v] # {held})")
            case "AT":
                lines.append(f"S{n} = ({wait()} ; IN[{x}]<v> ; {wait()}) :: (STREAM[{y}, v] # {wait()})")
            case "both" | "then":
                taken = f"(IN[{x}]<v> & IN[z{n}]<w>)" if shape == "both" else f"IN[{x}]<v> : IN[z{n}]<w>"
                lines.append(f"S{n} = ({taken} : {wait()}) :; (STREAM[{y}, v] # {wait()})")
                lines.append(f"Z{n} = {wait()} ; ((STREAM[z{n}, 0] # {wait()}) ; Z{n})")
                parts.append(f"Z{n}")
                streams += 1
            case _:
                lines.append(f"S{n} = (IN[{x}]<v> : {wait()}) :; OUT[{y}, v]")
        streams += shape != "until taken"
        parts.append(f"S{n}")
    last = f"x{len(shapes)}"
    pause = round(random.uniform(0.02, 0.5), 3)
    lines.append(f"Reader = ((Delay[0] : Ready) : IN[{last}]<v> : Got[v]) :; Term[{pause}]")
    lines.append(f"Net = {' | '.join(parts)} | Reader")
    return "\n".join(lines), " ".join(shapes) or "source", streams


def run(seed: int) -> Run:
    """One run of a random network: it is analysed once for every `ALIKE` runs."""
    text, shape, streams, found, program = analysed(seed // ALIKE)
    station = met(program, seed, PERIODS * max(found.period, 0.1))
    slack = streams * QUANTUM + 1e-6
    return Run(text, shape, station.waited, found.delay + slack, station.oldest, found.age + slack, station.read)


def met(program: Program, seed: int, seconds: float) -> Station:
    """What the reader of `Net` meets in one run."""
    scheduler = Scheduler(VirtualClock(), seed=seed)
    station = Station(scheduler)
    executer = Executer(program, scheduler=scheduler, host=station.host)
    executer.start("Net")
    executer.run(until=seconds)
    return station


@lru_cache(maxsize=2)
def analysed(number: int) -> tuple[str, str, int, Denseness, Program]:
    """The random network of this number, its shape, its STREAMs, and what is read off its text."""
    text, shape, streams = network(Random(number))
    signatures = Station(Scheduler(VirtualClock())).host.signatures
    program = load(text, signatures=signatures)
    found = dense(opened(program, signatures), "Net", last_port(text))
    assert isinstance(found, Denseness), found
    return text, shape, streams, found, program


def last_port(text: str) -> str:
    """The port that the reader reads."""
    return text.rpartition("IN[")[2].partition("]")[0]


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--runs", type=int, default=100_000)
    parser.add_argument("--out", type=Path, default=Path("out/denseness"))
    options = parser.parse_args(arguments)
    options.out.mkdir(parents=True, exist_ok=True)
    log = options.out / "runs.jsonl"
    done = log.read_text(encoding="utf-8").splitlines() if log.exists() else []
    for first in range(len(done) * CHUNK, options.runs, CHUNK):
        found = [run(seed) for seed in range(first, min(first + CHUNK, options.runs))]
        wrong = [first + n for n, r in enumerate(found) if not r.holds]
        line = {
            "first": first, "runs": len(found), "read": sum(r.read for r in found), "wrong": wrong,
            "nearest_wait": round(max(r.waited / r.delay for r in found if r.delay > 0.1), 4),
            "nearest_age": round(max(r.oldest / r.age for r in found if r.age > 0.1), 4),
        }  # fmt: skip
        done.append(json.dumps(line))
        with log.open("a", encoding="utf-8") as out:
            out.write(done[-1] + "\n")
        print(done[-1], flush=True)
    lines = [json.loads(line) for line in done]
    print(f"{sum(x['runs'] for x in lines)} runs, {sum(len(x['wrong']) for x in lines)} against the bounds")
    return 1 if any(x["wrong"] for x in lines) else 0


if __name__ == "__main__":
    raise SystemExit(main())
