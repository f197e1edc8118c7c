"""On the wall clock: what blocks runs apart, what holds up the loop is interrupted, and the others go on.

Nothing here is timed but by limits that are many times what is needed: the clock is that of a busy machine.
"""

from __future__ import annotations

import threading
import time
from collections import Counter
from collections.abc import Iterator

import pytest

from planner_reactor.errors import InputError
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.runtime import Aborted, Executer, Host, Root, Scheduler, Signal, VirtualClock, WallClock
from planner_reactor.runtime import apart as module
from planner_reactor.trace import Trace

MANY = 1_000
HANGS, RAISES = 417, 512
REACTIONS = """
Feed[n]  = GTR[n, 0] : OUT[make, n - 1] : Feed[n - 1]
Reactions = IN[make]<i> :: (Delay[0.2] :; Act[i])
"""


def run(host: Host, text: str, *, patience: float = 5.0, until: float = 20.0) -> tuple[Root, Trace]:
    """A process on the wall clock, to its end."""
    scheduler = Scheduler(WallClock())
    trace = Trace(lambda: scheduler.now)
    executer = Executer(parse_program(""), scheduler=scheduler, host=host, trace=trace)
    root = executer.start_process(parse_process(text))
    with executer.patient(patience):
        executer.run(until)
    return root, trace


@pytest.mark.parametrize("apart", [False, True])
def test_one_that_hangs_and_one_that_raises_among_a_thousand(apart: bool) -> None:
    """`while True` in a process fails within its limit, in the loop and in a thread; the other 998 act on and on."""
    acted, scheduler = Counter[int](), Scheduler(WallClock())
    trace = Trace(lambda: scheduler.now)
    host = Host("isolation")

    def act(index: float) -> None:
        if index == HANGS:
            while True:
                pass
        if index == RAISES:
            raise ZeroDivisionError("as it happens")
        acted[int(index)] += 1
        if index == MANY - 1 and acted[MANY - 1] >= 2 and failed():
            scheduler.stop()

    @host.process(limit=0.3, blocking=True)
    def Blocking(index: float) -> None:
        act(index)

    @host.process(limit=0.3)
    def Direct(index: float) -> None:
        act(index)

    def failed() -> list[str]:
        """By whom the limit was seen to have passed, or the loop to have been held up."""
        late = trace.of("limit") if apart else (e for e in trace.of("error") if "HeldUp" in e.data["message"])
        return [e.data["name"] for e in late]

    who = f"(if Equal[i, {HANGS}] then Blocking[i] else Direct[i])" if apart else "Direct[i]"
    text = REACTIONS.replace("Act[i]", who)
    executer = Executer(parse_program(text), scheduler=scheduler, host=host, trace=trace)
    executer.start_process(parse_process(f"Reactions | Feed[{MANY}]"))
    with executer.patient(0.1):
        executer.run(19.0)
    assert min(acted[n] for n in range(MANY) if n not in (HANGS, RAISES)) >= 1
    assert acted[MANY - 1] >= 2
    assert set(failed()) == {"Blocking" if apart else "Direct"}
    assert any("ZeroDivisionError" in e.data["message"] for e in trace.of("error"))


def test_a_blocking_process_ends_as_it_returns_raises_or_aborts() -> None:
    host, threads = Host("h"), list[bool]()

    @host.process(results=("x",), limit=5, blocking=True)
    def Read(what: str) -> int:
        threads.append(threading.current_thread() is threading.main_thread())
        if what == "nothing":
            raise Aborted("nothing there")
        return {"one": 1}[what]

    root, _ = run(host, "Read[one]<x>")
    assert (root.outcome, dict(root.results)) == ("stop", {"x": 1})
    root, trace = run(host, "Read[nothing]<x>")
    assert (root.outcome, root.cause) == ("abort", "failed")
    assert [e.data["message"] for e in trace.of("aborted")] == ["nothing there"]
    root, trace = run(host, "Read[two]<x>")
    assert (root.outcome, root.cause) == ("abort", "error")
    assert threads == [False, False, False]


def test_what_blocks_too_long_is_given_up_and_does_nothing_afterwards() -> None:
    host, commands, abandoned, blocked = Host("h"), list[str](), list[str](), threading.Event()

    @host.process(limit=0.05, blocking=True, abandon=lambda: abandoned.append("stop the motor"))
    def Drive() -> None:
        blocked.wait(0.3)  # as foreign code does: nothing is raised before it comes back
        commands.append("go on")

    root, trace = run(host, "Drive ; Delay[0.6]")
    assert root.outcome == "stop"
    assert len(list(trace.of("limit"))) == 1
    assert abandoned == ["stop the motor"]
    assert commands == []


def test_the_thread_of_what_was_given_up_is_used_again() -> None:
    host, used = Host("h"), set[int]()

    @host.process(limit=0.05, blocking=True)
    def Hang() -> None:
        used.add(threading.get_ident())
        while True:
            pass

    root, trace = run(host, " ; ".join(["Hang", "Delay[0.1]"] * 4))
    assert root.outcome == "stop"
    assert len(list(trace.of("limit"))) == 4
    assert len(used) < 4


def test_no_more_threads_than_there_may_be(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST", 3)
    host, gate = Host("h"), threading.Event()

    @host.process(limit=10, blocking=True)
    def Wait() -> None:
        gate.wait(10)

    @host.process(window=(0, 0))
    def Open() -> None:
        gate.set()

    root, trace = run(host, " | ".join(["Wait"] * 4 + ["(Delay[0.05] ; Open)"]))
    assert root.outcome == "stop"
    assert [e.data["message"].split(":")[0] for e in trace.of("error")] == ["Crowded"]


def test_host_code_that_sleeps_in_the_loop_is_interrupted() -> None:
    host, swallowed = Host("h"), list[str]()

    @host.process(limit=10)
    def Sleep() -> Iterator[float]:
        yield 0.01
        try:
            time.sleep(60)
        except Exception:  # as careless host code does
            swallowed.append("everything")

    root, trace = run(host, "Sleep", patience=0.1)
    assert (root.outcome, root.cause, swallowed) == ("abort", "error", [])
    (error,) = trace.of("error")
    assert "blocking=True" in error.data["message"]


def test_many_short_calls_are_never_interrupted() -> None:
    """Together they take three times as long as one may."""
    host, calls = Host("h"), Counter[str]()

    @host.process(limit=10)
    def Short() -> None:
        time.sleep(0.05)
        calls["short"] += 1

    root, trace = run(host, "Short ; " * 30 + "STOP", patience=0.5)
    assert (root.outcome, calls["short"], list(trace.of("error"))) == ("stop", 30, [])


def test_on_the_virtual_clock_nothing_runs_apart() -> None:
    host, threads, never = Host("h"), list[bool](), Signal()

    @host.process(window=(2, 2), blocking=True)
    def Read() -> None:
        threads.append(threading.current_thread() is threading.main_thread())

    scheduler = Scheduler(VirtualClock())
    executer = Executer(parse_program(""), scheduler=scheduler, host=host)
    root = executer.start_process(parse_process("Read"))
    with executer.patient():
        executer.run()
    assert (root.outcome, scheduler.now, threads, never.waiting) == ("stop", 2.0, [True], 0)


def test_what_yields_does_not_block() -> None:
    host = Host("h")
    with pytest.raises(InputError, match="blocking is a plain function"):

        @host.process(limit=1, blocking=True)
        def Wrong() -> Iterator[float]:
            yield 1.0
