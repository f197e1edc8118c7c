"""From `papers.itl` come the reactions that R §8.3 prints: P0 to P14, P23 and P24, term by term."""

from __future__ import annotations

import pytest

from planner_reactor.planner import Planner
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.terms import All, Cond, Disable, If, Loop, Not, Par, Process, Program, Seq, Spawn
from tests.planner.driving import PAPERS, Book, first_adaptations, kitting, settle

PRINTED = """
P[0] = STOP :; ASSERT[Kitting]
P[1] = SIT[Kitting]<k> :; (~((REASSERT[AcquireTray]<x1> : REASSERT[FillTray,x1]
      : REASSERT[FinishTray,x1]) : SUCCEED[Kitting,k]) : FAIL[Kitting,k])
P[2] = SIT[AcquireTray]<k> :; (~(REASSERT[FindPart]<x1> : Move[x1,trayarea]
      : (UPDATE[AcquireTray,k,x1] ; SUCCEED[AcquireTray,k])) : FAIL[AcquireTray,k])
P[3] = SIT[FindPart]<k> :; (~(Find[tray]<x1> : (UPDATE[FindPart,k,x1]
      ; SUCCEED[FindPart,k])) : FAIL[FindPart,k])
P[4] = SIT[FillTray]<k,x1> :; ((STUB[FillTray] : SUSPEND[2000]) ; FAIL[FillTray,k])
P[5] = SIT[FinishTray]<k,x1> :; ((STUB[FinishTray] : SUSPEND[2000]) ; FAIL[FinishTray,k])
P[6] = ASSUMONITOR[AS,2000]
P[7] = ASSUMONITOR[AQ,2000]
P[8] = ASSUMONITOR[AF,2000]
P[9] = ASSUMONITOR[ACP,2000]
P[10] = ASSUMONITOR[ADT,2000]
P[11] = SIT[FillTray]<k,x1> :; (~((REASSERT[LacksMotor,x1] | REASSERT[LacksCap,x1]
      | REASSERT[LacksBody,x1]) : SUCCEED[FillTray,k]) : FAIL[FillTray,k])
P[12] = SIT[LacksMotor]<k,x1> :; (~(FindGetInsert[motor,x1] : SUCCEED[LacksMotor,k])
      : FAIL[LacksMotor,k])
P[13] = SIT[LacksCap]<k,x1> :; ((STUB[LacksCap] : SUSPEND[2000]) ; FAIL[LacksCap,k])
P[14] = SIT[LacksBody]<k,x1> :; ((STUB[LacksBody] : SUSPEND[2000]) ; FAIL[LacksBody,k])
P[23] = SIT[AcquireTray]<k> :; (~(REASSERT[FindGoodPart]<x1> : Move[x1,trayarea]
      : (UPDATE[AcquireTray,k,x1] ; SUCCEED[AcquireTray,k])) : FAIL[AcquireTray,k])
P[24] = SIT[FindGoodPart]<k> :; (~(Find[tray]<x1> : Test[tray,x1] : (UPDATE[FindGoodPart,k,x1]
      ; SUCCEED[FindGoodPart,k])) : FAIL[FindGoodPart,k])
"""


def normal(process: Process) -> Process:
    """The same process with `:` grouped in one way (it is associative) and `&` printed for `|`."""
    match process:
        case Cond(parts):
            flat: list[Process] = []
            for part in map(normal, parts):
                flat.extend(part.parts if isinstance(part, Cond) else [part])
            return Cond(tuple(flat))
        case Seq(parts):
            return Seq(tuple(map(normal, parts)))
        case Par(parts) | All(parts):
            return All(tuple(map(normal, parts)))
        case Disable(parts):
            return Disable(tuple(map(normal, parts)))
        case Not(body):
            return Not(normal(body))
        case Loop(condition, body):
            return Loop(normal(condition), normal(body))
        case Spawn(condition, body):
            return Spawn(normal(condition), normal(body))
        case If(test, then, otherwise):
            return If(normal(test), normal(then), normal(otherwise))
        case _:
            return process


def bodies(program: Program) -> dict[int, Process]:
    return {schema.head[0].value: normal(schema.body) for schema in program.schemas}  # type: ignore[union-attr, misc]


@pytest.fixture(scope="module")
def segments() -> list[dict[int, Process]]:
    issued = first_adaptations(Planner(kitting(PAPERS)), 9)
    return [bodies(parse_program(adaptation.definitions)) for adaptation in issued]


PAPER = bodies(parse_program(PRINTED))


def test_the_first_adaptation_is_p0_to_p10(segments: list[dict[int, Process]]) -> None:
    first = segments[0]
    assert [first[n] for n in range(6)] == [PAPER[n] for n in range(6)]
    assert {first[n] for n in range(6, 11)} == {PAPER[n] for n in range(6, 11)}


def test_the_refinement_of_the_second_situation_is_p11_to_p14(segments: list[dict[int, Process]]) -> None:
    assert [segments[1][n] for n in range(11, 15)] == [PAPER[n] for n in range(11, 15)]


def test_relaxing_quality_begins_with_p23_and_p24(segments: list[dict[int, Process]]) -> None:
    assert list(segments[5].values()) == [PAPER[23], PAPER[24]]


def test_five_segments_make_the_first_ideal_reactor() -> None:
    planner = Planner(kitting(PAPERS), relax="none")
    issued = settle(planner)
    assert len(issued) == 5
    assert planner.ideal
    assert len(planner.assumptions_in_use) == 9


def test_a_reactor_takes_every_segment_of_the_papers_domain() -> None:
    planner = Planner(kitting(PAPERS))
    settle(planner, Book(planner.domain))
    assert planner.ideal
    assert planner.assumptions_in_use == ()
