"""Perceptions are numbered without gaps, repeats are counted, and what was said last is heard last (law 10)."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from planner_reactor.link.channels import PerceptionChannel
from planner_reactor.link.messages import PerceptionKind

FAILS: PerceptionKind = "assumption_failure"
HOLDS: PerceptionKind = "assumption_holds"
SAID = st.lists(
    st.tuples(st.sampled_from([FAILS, HOLDS, "guard_kill", "situation_failure", "take"]), st.sampled_from("ab")),
    max_size=30,
)


def taken(channel: PerceptionChannel) -> list[tuple[int, str, str, int]]:
    return [(p.number, p.kind, p.subject, p.count) for p in channel.take()]


def test_a_repeat_is_counted_with_the_first() -> None:
    channel = PerceptionChannel()
    for time in (1.0, 2.0, 3.0):
        channel.report(FAILS, "a", time=time)
    channel.report("guard_kill", "7", time=4.0)
    channel.report(FAILS, "a", time=5.0)
    assert [(p.time, p.count) for p in channel._waiting.values()] == [(1.0, 4), (4.0, 1)]
    assert taken(channel) == [(1, FAILS, "a", 4), (2, "guard_kill", "7", 1)]
    channel.report(FAILS, "a", time=6.0)
    assert taken(channel) == [(3, FAILS, "a", 1)]


def test_a_return_that_was_told_before_the_last_failure_is_heard_after_it() -> None:
    """Found by chaos, seed 593: holds, fails, holds became holds (twice), fails: it was thought to fail for ever."""
    channel = PerceptionChannel()
    for time, kind in enumerate((HOLDS, FAILS, HOLDS, FAILS, HOLDS)):
        last = channel.report(kind, "a", time=float(time))
    channel.report("guard_kill", "7", time=9.0)
    assert last.number == 2
    assert taken(channel) == [(1, FAILS, "a", 2), (2, HOLDS, "a", 3), (3, "guard_kill", "7", 1)]


@given(SAID)
def test_whatever_is_said_the_last_of_each_subject_is_heard_last_and_nothing_is_lost(
    said: list[tuple[PerceptionKind, str]],
) -> None:
    channel, heard = PerceptionChannel(), []
    for time, (kind, subject) in enumerate([*said, ("take", "")]):
        if kind == "take":  # type: ignore[comparison-overlap]  # of this test
            heard += channel.take()
        else:
            channel.report(kind, subject, time=float(time))
    told = [(kind, subject) for kind, subject in said if kind != "take"]  # type: ignore[comparison-overlap]
    assert [p.number for p in heard] == list(range(1, len(heard) + 1))
    assert channel.sent == channel.taken == len(heard)
    assert sum(p.count for p in heard) == len(told)
    for subject in "ab":
        about = [p.kind for p in heard if p.subject == subject]
        assert about[-1:] == [kind for kind, of in told if of == subject][-1:]
