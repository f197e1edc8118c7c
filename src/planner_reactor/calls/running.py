"""`run`: one process of a program, on its own or with a host, until it ends (R §4, §9.1).

The program may use the situation processes too: it has a store of situations of its own, as a reactor has, but
nobody adapts it. What is out of the ordinary (an error in a host's code, a budget, a report, a stub) is told line by
line to whoever listens.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from planner_reactor.calls.conforming import LATENESS, Monitor
from planner_reactor.calls.hosts import HostSource, find_host
from planner_reactor.calls.inputs import one_of, read_text, seconds, whole
from planner_reactor.calls.processes import called, checked, value
from planner_reactor.reactor.built_ins import BuiltIns
from planner_reactor.rs.configurations import spawned_situations
from planner_reactor.rs.terms import Call, Program, Value
from planner_reactor.runtime import Clock, Executer, Host, Root, Scheduler, VirtualClock, WallClock
from planner_reactor.runtime.scheduler import END_OF_TIME
from planner_reactor.runtime.sensing import Reading, Sensed
from planner_reactor.trace import Event, Trace


def run(
    file: str | Path,
    process: str,
    *,
    host: HostSource | None = None,
    seed: int = 0,
    until: float | None = None,
    clock: str = "virtual",
    conform: bool = False,
    told: Callable[[str], object] = lambda line: None,
) -> dict[str, Any]:
    """Run `process`, a call such as `Main` or `Main[3, cap]`, beside the definitions of a file `*.rsl`.

    `host` brings basic processes, functions, a world; `until` is in seconds; `clock` is "virtual" or "wall". Returns
    `outcome` (stop, abort, running: at `until`, or because all waits), `cause` of an abort, `results`, `time_s`,
    `events` (steps), `rendezvous`, `processes_live`, `zeno` (the definition that used up a budget, or None) and
    `waiting` (ports at which something waits) and, with `conform`, `conformance` (`conforming`). Raises SourceError
    for a wrong text, InputError for a wrong argument.
    """
    seed, until = whole("seed", seed, 0), seconds("until", until)
    one_of("clock", clock, ("virtual", "wall"))
    text, maker = read_text(file), find_host(host) if host is not None else None
    call = called(process)
    time: Clock = VirtualClock() if clock == "virtual" else WallClock() if maker else _LonelyClock()
    scheduler = Scheduler(time, seed=seed)
    trace = Trace(lambda: scheduler.now, keep=False)

    def tell(event: Event) -> None:
        told(_line(event))

    trace.sinks.append(tell)
    used = maker(scheduler, trace=trace) if maker else Host("none")
    program = checked(text, str(file), process, call, used)
    executer, start = _executer(program, used, scheduler, trace)
    arguments = [value(argument, process, call, used) for argument in call.arguments]
    if isinstance(time, _LonelyClock):
        time.stop = scheduler.stop
    late = LATENESS if clock == "wall" else 0.0
    monitor = Monitor(executer, program, used, trace, lateness=late) if conform else None
    root = start(call, arguments)
    with executer.patient():
        executer.run(until)
    return _came_to(root, executer) | ({"conformance": monitor.report()} if monitor is not None else {})


class _LonelyClock(WallClock):
    """The wall clock of a program without a host: when nothing is due any more, nothing ever will be."""

    __slots__ = ("stop",)

    def __init__(self) -> None:
        super().__init__()
        self.stop: Callable[[], object] = self.interrupt

    def reach(self, when: float) -> None:
        if when >= END_OF_TIME:
            self.stop()
        else:
            super().reach(when)


def _executer(
    program: Program, host: Host, scheduler: Scheduler, trace: Trace
) -> tuple[Executer, Callable[[Call, list[Value]], Root]]:
    def assumed(assumption: str, holds: bool, evidence: str = "") -> None:
        trace.record("assumption", name=assumption, holds=holds, evidence=evidence)

    def read(assumption: str, sensed: Sensed, *, returns: bool) -> None:
        holds = sensed.holds if isinstance(sensed, Reading) else sensed
        if holds is returns:
            assumed(assumption, returns)

    built_in = BuiltIns(
        scheduler,
        host.assumptions,
        read=read,
        reached=lambda situation, instance: trace.record("stub", situation=situation, instance=instance),
        told=lambda name, values: trace.record("report", name=name, values=values),
    )
    host.listen(assumed)
    executer = Executer(
        program, scheduler=scheduler, host=host, controls=built_in.controls, trace=trace,
        on_end=built_in.situations.root_ended,
    )  # fmt: skip
    built_in.attach(executer)
    built_in.situations.spawned.update(spawned_situations(program))

    def start(call: Call, arguments: list[Value]) -> Root:
        if host.world is not None:
            host.world.start(scheduler)
        # a call that names its results has them under these names, whichever of them are bound
        return executer.start_process(call) if call.results else executer.start(call.name, arguments)

    return executer, start


def _came_to(root: Root, executer: Executer) -> dict[str, Any]:
    statistics = executer.statistics()
    return {
        "outcome": root.outcome or "running",
        "cause": root.cause,
        "results": dict(root.results),
        "time_s": statistics.time,
        "events": statistics.steps,
        "rendezvous": statistics.rendezvous,
        "processes_live": statistics.processes_live,
        "zeno": statistics.zeno,
        "waiting": {str(port): side for port, side in executer.ports().items()},
    }


def _line(event: Event) -> str:
    match event.kind, event.data:
        case "report", {"name": name, "values": values}:
            said = " ".join(map(str, (name, *values)))
        case "assumption", {"name": name, "holds": holds, "evidence": evidence}:
            said = f"{name} {'holds' if holds else 'fails'}" + (f" ({evidence})" if evidence else "")
        case _, data:
            said = ", ".join(f"{key} {value}" for key, value in data.items())
    return f"{event.time:.3f} s: {event.kind}: {said}"
