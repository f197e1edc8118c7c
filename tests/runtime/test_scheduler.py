"""Time, order and randomness, on the virtual clock and on the wall clock."""

from __future__ import annotations

import threading
import time

import pytest

from planner_reactor.runtime import Scheduler, VirtualClock, WallClock


@pytest.fixture
def scheduler() -> Scheduler:
    return Scheduler(VirtualClock(), seed=7)


def test_actions_run_in_order_of_time_and_first_come_first_among_equals(scheduler: Scheduler) -> None:
    ran: list[object] = []
    for name, when in [("a", 2), ("b", 1), ("c", 2), ("d", 1), ("e", 0)]:
        scheduler.call_at(when, lambda name=name: ran.append((name, scheduler.now)))
    scheduler.run()
    assert ran == [("e", 0), ("b", 1), ("d", 1), ("a", 2), ("c", 2)]


def test_what_is_due_soon_comes_before_what_waits_for_the_same_instant(scheduler: Scheduler) -> None:
    ran: list[str] = []
    scheduler.call_at(1, lambda: (scheduler.soon(lambda: ran.append("soon")), ran.append("first")))
    scheduler.call_at(1, lambda: ran.append("second"))
    scheduler.run()
    assert ran == ["first", "soon", "second"]


def test_an_action_may_call_others_at_the_same_instant(scheduler: Scheduler) -> None:
    ran: list[str] = []
    scheduler.call_at(1, lambda: scheduler.call_after(0, lambda: ran.append("after")))
    scheduler.call_at(1, lambda: ran.append("second"))
    scheduler.run()
    assert (ran, scheduler.now) == (["second", "after"], 1)


def test_what_is_past_is_due_now(scheduler: Scheduler) -> None:
    scheduler.run(5.0)
    timer = scheduler.call_at(3.0, lambda: None)
    assert timer.when == 5.0


def test_a_cancelled_timer_does_not_run(scheduler: Scheduler) -> None:
    ran: list[int] = []
    timers = [scheduler.call_at(n % 7, lambda n=n: ran.append(n)) for n in range(2000)]
    for timer in timers[:-3]:
        timer.cancel()
        timer.cancel()
    scheduler.run()
    assert sorted(ran) == [1997, 1998, 1999]
    assert not timers[-1].active
    assert scheduler.idle


def test_run_stops_at_its_limit_and_goes_on_from_there(scheduler: Scheduler) -> None:
    ran: list[float] = []
    for when in (1, 2, 3):
        scheduler.call_at(when, lambda: ran.append(scheduler.now))
    scheduler.run(until=2)
    assert (ran, scheduler.now) == ([1, 2], 2)
    scheduler.run(until=2.5)
    assert scheduler.now == 2.5
    scheduler.run()
    assert ran == [1, 2, 3]


def test_stop_returns_after_the_present_action_and_nothing_is_lost(scheduler: Scheduler) -> None:
    ran: list[str] = []
    scheduler.call_at(1, scheduler.stop)
    scheduler.call_at(1, lambda: ran.append("later"))
    scheduler.run()
    assert (ran, scheduler.now) == ([], 1)
    scheduler.run()
    assert ran == ["later"]


def test_what_waits_for_ever_is_never_due(scheduler: Scheduler) -> None:
    scheduler.call_at(float("inf"), lambda: pytest.fail("it came"))
    scheduler.run()
    assert scheduler.now == 0


def test_random_streams_depend_on_seed_and_name_only(scheduler: Scheduler) -> None:
    other = Scheduler(VirtualClock(), seed=7)
    other.random("b").random()
    assert [scheduler.random("a").random() for _ in range(3)] == [other.random("a").random() for _ in range(3)]
    assert (
        Scheduler(VirtualClock(), seed=8).random("a").random() != Scheduler(VirtualClock(), seed=7).random("a").random()
    )


def test_the_wall_clock_waits_for_its_timers() -> None:
    scheduler = Scheduler(WallClock())
    begun = time.monotonic()
    scheduler.call_after(0.05, scheduler.stop)
    scheduler.run()
    assert 0.045 <= time.monotonic() - begun < 1.0


def test_a_post_from_another_thread_ends_the_wait_of_the_wall_clock() -> None:
    scheduler = Scheduler(WallClock())
    threading.Timer(0.02, lambda: scheduler.post(scheduler.stop)).start()
    begun = time.monotonic()
    scheduler.run(until=10)
    assert time.monotonic() - begun < 5.0


def test_the_wall_clock_stops_at_its_limit() -> None:
    scheduler = Scheduler(WallClock())
    scheduler.run(until=0.02)
    assert scheduler.now >= 0.02


def test_many_posts_do_not_starve_the_timers_of_the_wall_clock() -> None:
    scheduler = Scheduler(WallClock())
    scheduler.call_after(0.01, scheduler.stop)

    def again() -> None:
        scheduler.post(again)

    again()
    begun = time.monotonic()
    scheduler.run(until=10)
    assert time.monotonic() - begun < 5.0


def test_now_stands_still_while_an_action_runs() -> None:
    scheduler = Scheduler(WallClock())
    seen: list[float] = []

    def look() -> None:
        seen.append(scheduler.now)
        time.sleep(0.01)
        seen.append(scheduler.now)
        scheduler.stop()

    scheduler.call_after(0, look)
    scheduler.run()
    assert seen[0] == seen[1]
