"""How long what is in service may still take: case by case, and held against what runs are seen to take."""

from __future__ import annotations

from math import inf

import pytest

from planner_reactor.rs.bounds import Bounds
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.terms import Loop, Program, Spawn
from planner_reactor.rs.vocabulary import Signature

TIMES = {"One": 1.0, "Three": 3.0, "Ten": 10.0}
LEAVES = {name: Signature(name, window=(0.0, high)) for name, high in TIMES.items()}

REACTIONS = """
Part = SIT[part]<k> :; (~(Three : SUCCEED[part, k]) : FAIL[part, k])
Whole = SIT[whole]<k> :; (~(One : REASSERT[part] : REASSERT[part] : Ten : SUCCEED[whole, k]) : FAIL[whole, k])
Cut = SIT[cut]<k> :; (REASSERT[part] # Delay[1])
Crowd = SIT[crowd]<k> :: (Three : SUCCEED[crowd, k])
Deep = SIT[deep]<k> :: (ASSERT[deep] : SUCCEED[deep, k])
Twice[t] = Delay[t] : Delay[2 * t]
Forever = Delay[1] : Forever
"""
PROGRAM = parse_program(REACTIONS)


def bounds(program: Program = PROGRAM, **limits: float) -> Bounds:
    def served(situation: str) -> tuple[object, ...]:
        loops = [s.body for s in program.schemas if isinstance(s.body, Loop | Spawn)]
        return tuple(loop.body for loop in loops if loop.condition.arguments[0].name == situation)  # type: ignore[union-attr]

    return Bounds(program, LEAVES, limits, served)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("Ten", 10), ("One : Three", 4), ("One ; Three", 4), ("One | Three", 3), ("One & Three", 3),
        ("One # Three", 1), ("~One : Three", 4), ("if One then Three else Ten", 11), ("Delay[4] : One", 5),
        ("SUSPEND[1500]", 1.5), ("Twice[4]", 12), ("NIL # Delay[3]", 3), ("NIL", inf), ("IN[p]<x>", inf),
        ("One :; Ten", inf), ("Forever", inf), ("STOP : Ten", 10), ("ABORT : Ten", 0), ("~ABORT : Ten", 10),
        ("(NIL # Delay[2]) : One", 3), ("Ran[0, 2]<x> : Delay[x]", inf), ("GTR[1, 2] : One", 1),
    ],
)  # fmt: skip
def test_the_bound_of_a_process_from_its_beginning(text: str, seconds: float) -> None:
    assert bounds().fresh(parse_process(text)).end == seconds


def test_an_assert_below_a_withdrawn_instance_fails_at_once() -> None:
    assert bounds().fresh(parse_process("ASSERT[part] : Ten")).end == 0
    assert bounds().fresh(parse_process("ASSERT[part] ; Ten")).end == 10
    assert bounds().fresh(parse_process("ASSERT[part] :; Ten")).end == 0


def test_one_assert_that_waits_takes_time_and_the_next_fails_at_once() -> None:
    """In the first REASSERT: 3 s, then the second fails. In the second: 3 s, and if it stopped 10 s. Before: 1 s."""
    assert bounds().situation("part") == 3
    assert bounds().situation("whole") == 13
    assert bounds().drains(("whole", "part")) == 16


def test_what_a_body_has_left_behind_counts_too() -> None:
    """`#` aborts the ASSERT after a second; the instance that it made is served to its end, and its owner waits."""
    assert bounds().situation("cut") == 3


def test_instances_served_side_by_side_end_side_by_side() -> None:
    assert bounds().situation("crowd") == 3


def test_what_is_asserted_below_itself_has_no_bound() -> None:
    assert bounds().situation("deep") == inf


def test_a_situation_that_nothing_serves_ends_at_once() -> None:
    assert bounds().situation("nothing") == 0


def test_a_limit_beyond_the_window_counts() -> None:
    assert bounds(One=7.0).fresh(parse_process("One : Three")).end == 10


def test_a_loop_under_way_ends_with_its_round_if_its_condition_can_only_fail() -> None:
    assert bounds().going(parse_process("ASSERT[part] :; Ten")).end == 13
    assert bounds().going(parse_process("ASSERT[part] :: Ten")).end == 13
    assert bounds().going(parse_process("One :: Ten")).end == inf


def test_parts_side_by_side_may_have_ended_before() -> None:
    """The abort of `Three` leads on only because the other part may have aborted already."""
    assert bounds().going(parse_process("~(Three | Delay[1]) : Ten")).end == 13
    assert bounds().fresh(parse_process("~(Three | Delay[1]) : Ten")).end == 3
