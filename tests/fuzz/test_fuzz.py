"""Structured fuzz: whatever text, bytes or adaptation comes in, what is wrong with it is said by a typed error."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from types import FrameType
from typing import Any

import msgspec
import pytest

from planner_reactor.errors import DomainError, InputError
from planner_reactor.link.codec import decode
from planner_reactor.link.messages import Adaptation
from planner_reactor.link.session import Session
from planner_reactor.logic.reader import check_domain, read_domain
from planner_reactor.reactor.journal import HEADER, Journal
from planner_reactor.rs.checks import check_text
from tests.fuzz.messages import framed_content, in_arrays
from tests.fuzz.subjects import SHARES, attacked, survived
from tests.reactor.disks import TornDisk
from tests.reactor.driving import FIRST, SECOND, Bench

MANY = int(os.environ.get("FUZZ_INPUTS", "2000"))
PARTS = 4


@pytest.mark.parametrize("part", range(PARTS))
def test_every_answer_is_a_result_or_a_typed_error(part: int) -> None:
    refused: dict[str, list[bool]] = {name: [] for name in SHARES}
    for seed in range(part, MANY, PARTS):
        name, attack = attacked(seed)
        try:
            refused[name].append(survived(attack))
        except Exception as problem:
            pytest.fail(f"{name}: {type(problem).__name__}: {problem} (python -m tests.fuzz --only {seed})")
    assert {name: any(found) for name, found in refused.items() if name not in ("journal", "frame", "adaptation")} == {
        "RS": True, "domain": True, "message": True,
    }  # fmt: skip
    assert any(not found for found in refused["RS"])  # some of the texts are sound, or nothing much was asked


# found by the campaign


@pytest.mark.parametrize("depth", [1_000, 100_000])
def test_arrays_within_arrays_are_malformed(depth: int) -> None:
    for content in (b"\x92\xaaadaptation" + in_arrays(depth), in_arrays(depth)):
        with pytest.raises(InputError, match="malformed"):
            decode(content)
    end = Session(1)
    assert end.receive(in_arrays(depth), 0.0) == []
    recovery = Journal(TornDisk(HEADER + framed_content(in_arrays(depth), 1))).recover()
    assert (recovery.state.committed.clauses, recovery.lost > depth) == ({}, True)


def test_bytes_that_are_no_text_are_malformed() -> None:
    with pytest.raises(InputError, match="malformed"):
        decode(b"\x92\xaaadaptation\x81\xa2\xff\xfe\x01")
    with pytest.raises(InputError, match="malformed"):
        decode(b"\x92\xa2\xbd\xbd\x80")


@pytest.mark.parametrize(
    "hostile",
    [
        Adaptation(id=7, purpose="\ud800"),
        Adaptation(id=7, definitions="P[9] = OUT['\ud800', 1]", adds=(9,)),
        Adaptation(id=7, removed=("\ud800",)),
        Adaptation(id=2**70),
    ],
)
def test_what_cannot_be_written_down_is_refused(hostile: Adaptation) -> None:
    bench = Bench()
    bench.reactor.receive(hostile)
    bench.run(1.0)
    assert [(p.kind, p.cause) for p in bench.perceptions() if p.kind == "adaptation_refused"] == [
        ("adaptation_refused", "text")
    ]
    assert bench.reactor.laws.violations == []


def test_what_is_removed_may_not_be_served_by_what_is_added() -> None:
    """Mode `versions` began no new version of it: an instance was served by the old reaction and by the new one."""
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.at(1.0, msgspec.structs.replace(SECOND, removed=("part",), mode="versions"))
    bench.run(3.0)
    assert [p.cause for p in bench.perceptions() if p.kind == "adaptation_refused"] == ["structure"]
    assert bench.reactor.laws.violations == []


@pytest.mark.parametrize("deadline", [-1.0, float("nan")])
def test_a_deadline_that_cannot_be_kept_is_refused(deadline: float) -> None:
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.at(1.0, msgspec.structs.replace(SECOND, deadline=deadline))
    bench.run(3.0)
    assert [p.cause for p in bench.perceptions() if p.kind == "adaptation_refused"] == ["mode"]
    assert bench.reactor.laws.violations == []


def test_what_is_nested_deeply_is_looked_at_once() -> None:
    """The check of guardedness asked every level about all that is below it."""
    calls = [calls_of(f"T = {'if ' * depth}STOP{' then STOP else STOP' * depth}") for depth in (40, 80)]
    assert calls[1] < 2.5 * calls[0]


@pytest.mark.parametrize(
    "text", ["atp_assumption A() monitor flag {};", "atp_fact P({});", "atp_resource r capacity {};"]
)
def test_a_number_beyond_all_measure_is_refused(text: str) -> None:
    with pytest.raises(DomainError, match="a number with 5000 digits"):
        read_domain(text.format("9" * 5_000))


@pytest.mark.parametrize("line", ["executability: Before(x) @ i1 and ITL(i1, encompasses, Act);", "intervals i1;",
                                  "effects: Exists z: After(x, y) @ i2 and ITL(Act, meets, i2);"])  # fmt: skip
def test_what_is_said_again_and_again_of_intervals_is_gathered_once(line: str) -> None:
    """Every condition of a schema asked all its constraints anew."""
    schema = "atp_actionschema Act <x><y> intervals i1, i2; {} endactionschema"
    calls = [calls_of(schema.format(f"{line}\n" * many), check_domain) for many in (100, 200)]
    assert calls[1] < 2.5 * calls[0]


def calls_of(text: str, check: Callable[[str], object] = check_text) -> int:
    """Calls of our own functions that a check of this text takes."""
    count = 0

    def call(frame: FrameType, event: str, argument: Any) -> None:
        nonlocal count
        count += event == "call" and "planner_reactor" in frame.f_code.co_filename

    sys.setprofile(call)
    check(text)
    sys.setprofile(None)
    return count


def test_a_message_that_is_sound_is_taken() -> None:
    assert decode(msgspec.msgpack.encode(["adaptation", {"id": 3}])) == Adaptation(id=3)
