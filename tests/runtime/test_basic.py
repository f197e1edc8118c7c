"""Basic processes of a host: how they begin, wait, end, fail, outlive their limits and are abandoned."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

import pytest

from planner_reactor.runtime import Aborted, Host, Signal, sleep
from tests.runtime.driving import Run, begin, run

Steps = Generator[Any, Any, Any]


class Bench:
    """A host with processes of every kind, and what became of them."""

    def __init__(self) -> None:
        self.host = host = Host("bench")
        self.abandoned: list[tuple[object, ...]] = []
        self.closed: list[str] = []
        self.bell = Signal("bell")

        @host.process(results=("y",), window=(0, 0))
        def Double(x: float) -> float:
            return 2 * x

        @host.process(window=(0, 5), abandon=lambda *given: self.abandoned.append(given))
        def Hold(seconds: float, name: str = "hold") -> Steps:
            try:
                yield seconds
            finally:
                self.closed.append(name)

        @host.process(results=("v",), limit=9)
        def Hear() -> Steps:
            return (yield self.bell)

        @host.process(results=("heard",), limit=9)
        async def HearWithin(seconds: float) -> object:
            await sleep(1)
            return str(await self.bell.within(seconds))

        @host.process(results=2, window=(1, 3))
        def Early() -> tuple[int, int]:
            return 1, 2

        @host.process(limit=3)
        def Refuse(reason: str) -> Steps:
            yield 1
            raise Aborted(reason)

        @host.process(limit=3)
        def Break() -> None:
            raise ZeroDivisionError("broken")

        @host.process(limit=3)
        def BreakLater() -> Steps:
            yield 1
            raise ZeroDivisionError("broken")

        @host.process(results=("x",), limit=3)
        def Forget() -> None:
            return None

        @host.process(limit=3)
        def WaitForNothing() -> Steps:
            yield "nothing"

        @host.process(limit=3)
        def WaitBackwards() -> Steps:
            yield -1

        @host.process(window=(0, 0), outcomes=("stop",))
        def NeverAborts() -> None:
            raise Aborted("after all")

        @host.process(window=(0, 0), outcomes=("abort",))
        def NeverStops() -> None:
            return None


@pytest.fixture
def bench() -> Bench:
    return Bench()


def notes(ran: Run) -> list[str]:
    return [event.kind for event in ran.trace.events]


def test_a_plain_function_takes_arguments_and_gives_results(bench: Bench) -> None:
    ran = run("Double[21]<y>", host=bench.host)
    assert ran.results == {"y": 42}
    assert ran.seen == [("Double", (21,), "ok", (42,))]


def test_a_generator_waits_for_seconds(bench: Bench) -> None:
    ran = run("Hold[2.5]", host=bench.host)
    assert (ran.outcome, ran.now) == ("stop", 2.5)
    assert ran.seen == [("Hold", (2.5,), "ok", ())]


def test_a_generator_waits_for_a_signal_and_gets_its_value(bench: Bench) -> None:
    begun = begin("Hear<v>", host=bench.host)
    begun.executer.scheduler.call_at(3, lambda: bench.bell.fire(7))
    begun.executer.run()
    assert (begun.results, begun.now) == ({"v": 7}, 3.0)


@pytest.mark.parametrize(("rings", "heard", "at"), [(2.0, "True", 2.0), (5.0, "False", 4.0)])
def test_a_coroutine_waits_for_a_signal_within_a_time(bench: Bench, rings: float, heard: str, at: float) -> None:
    begun = begin("HearWithin[3]<h>", host=bench.host)
    begun.executer.scheduler.call_at(rings, bench.bell.fire)
    begun.executer.run()
    assert (begun.results, begun.at) == ({"h": heard}, [at])


def test_a_signal_wakes_all_who_wait_in_order(bench: Bench) -> None:
    begun = begin("(Hear<a> | Hear<b> | Hear<c>) ; Hear<d>", host=bench.host)
    begun.executer.scheduler.call_at(1, lambda: bench.bell.fire(1))
    begun.executer.run(until=2)
    assert [label[3] for label in begun.seen] == [(1,), (1,), (1,)]
    assert begun.outcome is None  # a signal is a moment: the one who came later waits for the next
    assert bench.bell.waiting == 1


def test_it_never_ends_before_its_window_begins(bench: Bench) -> None:
    ran = run("Early<a,b>", host=bench.host)
    assert (ran.now, ran.results) == (1.0, {"a": 1, "b": 2})


def test_aborted_is_an_outcome_and_its_reason_is_in_the_trace(bench: Bench) -> None:
    ran = run("Refuse[full]", host=bench.host)
    assert (ran.outcome, ran.root.cause) == ("abort", "failed")
    assert [e.data["message"] for e in ran.trace.of("aborted")] == ["full"]


@pytest.mark.parametrize(
    "name", ["Break", "BreakLater", "Forget", "WaitForNothing", "WaitBackwards", "NeverStops", "NeverAborts"]
)
def test_what_a_hosts_code_does_wrong_is_an_abort_with_cause_error(bench: Bench, name: str) -> None:
    ran = run(name, host=bench.host)
    assert (ran.outcome, ran.root.cause) == ("abort", "error")
    assert notes(ran) == ["error"]


@pytest.mark.parametrize("call", ["Double[a]<y>", "Hold[b]", "Refuse[3]"])
def test_an_argument_of_the_wrong_kind_aborts(bench: Bench, call: str) -> None:
    ran = run(call, host=bench.host)
    assert (ran.outcome, ran.root.cause) == ("abort", "error")


def test_too_few_arguments_abort(bench: Bench) -> None:
    assert run("Hold", host=bench.host).seen == [("Hold", (), "ab", ())]


def test_one_that_outlives_its_limit_is_abandoned_and_aborts(bench: Bench) -> None:
    ran = run("Hold[9]", host=bench.host)
    assert (ran.outcome, ran.root.cause) == ("abort", "error")
    assert ran.now == pytest.approx(5.0)
    assert bench.abandoned == [(9,)]
    assert bench.closed == ["hold"]
    assert notes(ran) == ["limit"]


def test_one_that_ends_exactly_at_its_limit_has_ended(bench: Bench) -> None:
    assert run("Hold[5]", host=bench.host).outcome == "stop"


def test_one_that_is_aborted_is_abandoned_exactly_once(bench: Bench) -> None:
    ran = run("(Hold[4,a] | Hold[3,b]) # (Hold[1,c] ; ABORT)", host=bench.host)
    assert bench.abandoned == [(4, "a"), (3, "b")]
    assert bench.closed == ["c", "a", "b"]
    assert ran.executer.statistics().basic_running == 0
    assert bench.host.processes["Hold"].limit == 5


def test_one_that_has_not_begun_is_not_abandoned(bench: Bench) -> None:
    run("(Delay[3] ; Hold[4]) # Delay[1]", host=bench.host)
    assert bench.abandoned == []


def test_one_that_is_aborted_in_the_instant_of_its_signal_is_abandoned(bench: Bench) -> None:
    begun = begin("Hear<x> # Hear<y>", host=bench.host)
    begun.executer.scheduler.call_at(1, lambda: bench.bell.fire(5))
    begun.executer.run()
    assert begun.results == {"x": 5}
    assert begun.executer.statistics().basic_running == 0


def test_an_error_while_it_is_abandoned_stops_nobody() -> None:
    host = Host("h")

    @host.process(limit=9, abandon=lambda: 1 / 0)
    def Stubborn() -> Steps:
        while True:
            try:
                yield 5
            except GeneratorExit:
                yield 5

    ran = run("Stubborn # Delay[1]", host=host)
    assert ran.outcome == "stop"
    assert notes(ran) == ["error", "error"]


def test_functions_of_the_host_may_be_used_in_expressions() -> None:
    host = Host("h")

    @host.function
    def half(x: float) -> float:
        return x / 2

    assert run("Delay[half(5)]", host=host).now == 2.5
    assert run("Delay[half(a)]", host=host).root.cause == "error"
