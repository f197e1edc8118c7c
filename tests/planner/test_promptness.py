"""No step is long, and what a change costs follows what changes: counted in units of work, not in time."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import FrameType

import pytest

from planner_reactor.logic.domain import Domain
from planner_reactor.planner import Planner, Step
from planner_reactor.planner.reducing import PATIENCE, UNITS
from tests.planner.driving import Book, first_adaptations, kitting, perception, planner_without, settle, texts
from tests.planner.test_altered_domains import with_kinds

NINE = ("AQ", "AS", "AF", "ACT", "ACP", "ADT", "AM", "ADD", "AO")


def planned(count: int, **options: object) -> tuple[Planner, Book]:
    """A planner for so many kinds that has issued everything, and what it has come to."""
    domain = with_kinds(*(f"p{n}" for n in range(count)))
    planner, book = Planner(domain, **{"relax": (), "verify": False, **options}), Book(domain, loads=False)  # type: ignore[arg-type]
    settle(planner, book, most=20_000)
    return planner, book


def units(planner: Planner) -> int:
    return planner.statistics()["units"]


def test_no_step_does_more_than_its_share_of_work() -> None:
    planner, _ = planned(60, relax="all")
    assert planner.ideal
    assert not planner.assumptions_in_use
    assert 0 < planner.statistics()["longest_step"] <= UNITS


def test_the_first_adaptation_takes_as_little_with_many_kinds_as_with_few() -> None:
    few, many = (Planner(with_kinds(*(f"p{n}" for n in range(count)))) for count in (3, 100))
    first_adaptations(few, 1)
    first_adaptations(many, 1)
    assert units(few) == units(many)


@pytest.mark.parametrize("name", NINE)
def test_what_a_relaxation_takes_follows_what_it_changes(name: str) -> None:
    """Three units at most for each situation that changes, and a constant that no number of kinds raises."""
    taken = []
    for count in (10, 40):
        planner, book = planned(count)
        before = units(planner)
        planner.perceive(perception("assumption_failure", name))
        changes = sum(len(adaptation.changes) for adaptation in settle(planner, book))
        taken.append((units(planner) - before, changes))
    (few, changed_few), (many, changed_many) = taken
    assert many - few <= 6 * (changed_many - changed_few)


COLD = """
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner
planner = Planner(read_domain(sys.argv[1]))
while not planner.step().adaptations:
    pass
print(*sys.modules)
"""
LATER = {f"planner_reactor.{name}" for name in ("analysis.adaptations", "analysis.forms", "rs.parser", "rs.evolves")}
LATER |= {"dataclasses", "json", "difflib", "pathlib"}


def test_the_first_adaptation_needs_neither_the_verifier_nor_the_parser_of_rs() -> None:
    """A process that begins with nothing has it sooner: what is not needed yet is not loaded."""
    command = [sys.executable, "-S", "-c", PATHS + COLD, str(CAFE)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "planner_reactor.planner.issuing" in done.stdout.split()
    assert not LATER & {*done.stdout.split()}


PATHS = f"import sys; sys.path[:] = {sys.path!r}"
CAFE = Path(__file__).parents[2] / "examples" / "09_cafe.itl"


class Calls:
    """How many Python functions are called meanwhile."""

    def __enter__(self) -> Calls:
        self.count = 0
        sys.setprofile(self._note)
        return self

    def __exit__(self, *_: object) -> None:
        sys.setprofile(None)

    def _note(self, frame: FrameType, event: str, argument: object) -> None:
        self.count += event == "call"


def counted(planner: Planner) -> list[tuple[int, Step]]:
    """Every step with the calls that it makes, until there is nothing to do."""
    found = []
    while True:
        with Calls() as calls:
            step = planner.step()
        if step is None:
            return found
        found.append((calls.count, step))
        for adaptation in step.adaptations:
            planner.perceive(perception("adaptation_applied", str(adaptation.id)))


def test_no_step_makes_many_calls_verification_included() -> None:
    """The most are made where what all thirty kinds have in common is written, and read, at once."""
    domain = with_kinds(*(f"p{n}" for n in range(30)))
    calls = sorted(count for count, _ in counted(Planner(domain, relax="all")))
    assert calls[-1] <= 4_000
    assert calls[int(len(calls) * 0.99)] <= 3_500


def test_an_adaptation_that_is_like_the_one_before_is_cheap() -> None:
    made = []
    for count in (10, 40):
        planner, _ = planned(count)
        planner.perceive(perception("assumption_failure", "AQ"))
        made.append(sum(calls for calls, _ in counted(planner)))
    assert made[1] - made[0] <= 30 * 200


def test_a_perception_in_the_middle_of_a_thought_is_acted_on_in_the_next_step() -> None:
    planner, _ = planned(40)
    planner.perceive(perception("assumption_failure", "ADT"))
    step = planner.step()
    while step is not None and step.situation != "FillTray":  # takes several steps
        for adaptation in step.adaptations:
            planner.perceive(perception("adaptation_applied", str(adaptation.id)))
        step = planner.step()
    planner.perceive(perception("situation_failure", "LacksP7"))
    step = planner.step()
    assert step is not None
    assert step.situation == "LacksP7"


@pytest.mark.parametrize("name", ["ACT", "ADD", "AO"])
def test_a_failure_is_answered_before_a_long_thought_is_thought_to_its_end(name: str) -> None:
    """The largest situation is still a stub: what is short goes first, and what was thought so far is not lost."""
    domain = with_kinds(*(f"p{n}" for n in range(100)))
    planner = Planner(domain, relax=(), verify=False)
    first_adaptations(planner, 1)
    planner.perceive(perception("assumption_failure", name))
    before = units(planner)
    (answer,) = first_adaptations(planner, 1)
    assert "FillTray" not in [change.situation for change in answer.changes]
    assert units(planner) - before <= PATIENCE + 2 * UNITS
    settle_on(planner)
    assert texts(planner) == texts(planner_of_failed(domain, [name]))


@pytest.mark.parametrize("name", NINE)
def test_what_was_foreseen_is_not_worked_out_when_it_happens(name: str) -> None:
    planner, _ = planned(5, foresight=True)
    before = planner.statistics()["refinements"]
    planner.perceive(perception("assumption_failure", name))
    assert first_adaptations(planner, 1)
    step = planner.step()
    while step is not None and step.kind != "foresee":
        for adaptation in step.adaptations:
            planner.perceive(perception("adaptation_applied", str(adaptation.id)))
        step = planner.step()
    assert planner.statistics()["refinements"] == before


def test_thinking_ahead_issues_nothing_and_comes_to_an_end() -> None:
    domain = kitting()
    plain, ahead = Planner(domain, relax=()), Planner(domain, relax=(), foresight=True)
    assert [a.definitions for a in settle(plain)] == [a.definitions for a in settle(ahead)]
    assert ahead.step() is None


def test_a_reaction_filled_in_is_the_reaction_written_for_itself() -> None:
    """The sheet of one kind serves for the others; each alone would have been written the same."""
    names = ("motor", "cap", "body")
    together = texts(planner_of(with_kinds(*names)))
    for name in names:
        alone = texts(planner_of(with_kinds(name)))
        assert together[f"Lacks{name.title()}"] == alone[f"Lacks{name.title()}"]


def planner_of_failed(domain: Domain, names: list[str]) -> Planner:
    planner = planner_without(domain, names, verify=False)
    settle_on(planner)
    return planner


def settle_on(planner: Planner) -> None:
    """Until there is nothing to do; a book would have to know what was issued before."""
    while (step := planner.step()) is not None:
        for adaptation in step.adaptations:
            planner.perceive(perception("adaptation_applied", str(adaptation.id)))


def planner_of(domain: object) -> Planner:
    planner = planner_without(domain, ["AQ", "ACP"])  # type: ignore[arg-type]
    settle(planner)
    return planner
