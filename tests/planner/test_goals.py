"""Goals given and withdrawn while the planner runs, and another text in the place of the first: as adaptations."""

from __future__ import annotations

import random
import re
from collections.abc import Iterator
from typing import Any

import pytest
from msgspec.structs import replace

from planner_reactor.errors import InputError
from planner_reactor.experiments.loop import Loop
from planner_reactor.link.messages import Adaptation
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner
from planner_reactor.planner.because import Because
from planner_reactor.planner.verifying import Gate
from planner_reactor.runtime import Host, Scheduler
from tests.planner.driving import KITTING, TENDING, Book, applied, image, kitting, perception, settle, texts
from tests.planner.test_altered_domains import with_kinds

TEXT = """
atp_assumption Dry() likelihood 0.4 monitor flag 1000;
atp_assumption Light() likelihood 0.6 monitor flag 1000;
atp_goal Front Swept(hall) and Swept(stairs);
atp_goal Back  Swept(yard) and Swept(stairs);
atp_rule forall x, i, j: Dry() @ j => Safe(x) @ i;
atp_actionschema Clean <x><>
intervals i1;
    effects: Swept(x) @ i1 and ITL(Clean, meets, i1);
    expansions: Swept(x) @ i1;
endactionschema
atp_actionschema Sweep <x><>
intervals i1, i2;
    executability: Safe(x) @ i2 and ITL(i2, [m o si e di fi], Sweep);
    effects: Swept(x) @ i1 and ITL(Sweep, meets, i1);
endactionschema
atp_actionschema Mop <x><>
    effects: Safe(x);
endactionschema
"""
DOMAIN = read_domain(TEXT)


def planned(*goals: str, **options: Any) -> tuple[Planner, Book]:
    planner, book = Planner(DOMAIN, goal=goals[0], **{"relax": (), "verify": False, **options}), Book(DOMAIN)
    for goal in goals[1:]:
        planner.pursue(goal)
    settle(planner, book)
    return planner, book


def test_a_second_goal_is_added_beside_the_first_and_shares_what_they_have_in_common() -> None:
    planner, book = planned("Front")
    before = dict(book.reactions)
    planner.pursue("Back")
    assert planner.expectation == ("Back",)
    issued = settle(planner, book)
    assert planner.ideal
    assert planner.goals == ("Front", "Back")
    assert before.items() <= book.reactions.items()  # nothing that was there was touched
    assert sorted(book.served()) == ["Back", "CleanHall", "CleanStairs", "CleanYard", "Front"]
    assert planner.explain(issued[0].id).because == (Because("goal", "Back"),)


def test_two_goals_one_after_the_other_or_together_come_to_the_same() -> None:
    one_by_one, book = planned("Front")
    one_by_one.pursue("Back")
    settle(one_by_one, book)
    together, _ = planned("Front", "Back")
    assert image(one_by_one) == image(together)


def test_a_goal_withdrawn_takes_away_what_stands_for_it_alone() -> None:
    planner, book = planned("Front", "Back")
    planner.withdraw("Front")
    (issued,) = settle(planner, book)
    assert issued.purpose == "withdraw goal Front"
    assert set(issued.removed) == {"Front", "CleanHall"}
    assert image(planner) == image(planned("Back")[0])
    assert sorted(book.served()) == ["Back", "CleanStairs", "CleanYard"]
    assert planner.explain(issued.id).because == (Because("withdrawn", "Front"),)


def test_the_last_goal_withdrawn_leaves_nothing_not_even_a_monitor() -> None:
    planner, book = planned("Front")
    assert book.monitors("ASSUMONITOR") == {"Dry"}
    planner.withdraw("Front")
    settle(planner, book)
    assert book.reactions == {}
    assert planner.assumptions_in_use == ()
    planner.pursue("Front")
    settle(planner, book)
    assert image(planner) == image(planned("Front")[0])


def test_a_withdrawal_that_is_refused_is_tried_again() -> None:
    planner, book = planned("Front", "Back")
    planner.withdraw("Back")
    step = planner.step()
    assert step is not None
    planner.perceive(perception("adaptation_refused", str(step.adaptations[0].id), cause="pending"))
    (again,) = settle(planner, book)
    assert again.purpose == "withdraw goal Back"
    assert image(planner) == image(planned("Front")[0])


def test_a_withdrawal_that_is_always_refused_is_given_up_and_the_goal_stays() -> None:
    planner, book = planned("Front", "Back")
    planner.withdraw("Back")
    steps = 0
    while (step := planner.step()) is not None:
        for adaptation in step.adaptations:
            planner.perceive(perception("adaptation_refused", str(adaptation.id), cause="never"))
        steps += 1
        assert steps < 100
    assert planner.goals == ("Front", "Back")
    planner.withdraw("Back")
    settle(planner, book)
    assert planner.goals == ("Front",)


def test_a_goal_with_much_below_it_is_withdrawn_and_that_is_verified() -> None:
    """More reactions than are looked at as a whole: its root, which serves nothing, was held to ask for ever."""
    planner, book = Planner(kitting(), relax="none"), Book(kitting())
    settle(planner, book)
    planner.withdraw("Kitting")
    (issued,) = settle(planner, book)
    assert issued.purpose == "withdraw goal Kitting"
    assert not planner.withheld
    assert book.reactions == {}


def test_a_withdrawal_that_leaves_the_root_behind_does_not_hold() -> None:
    planner = Planner(kitting(), relax="none", verify=False)
    gate, book = Gate(), Book(planner.domain)
    sent = settle(planner, book)
    planner.withdraw("Kitting")
    for adaptation in sent:
        assert gate.examine(adaptation).holds
        gate.perceive(applied(adaptation))
    (issued,) = settle(planner, book)
    assert 0 in issued.kills
    wrong = replace(issued, kills=tuple(label for label in issued.kills if label != 0))
    assert not gate.examine(wrong).consistent
    assert gate.examine(issued).holds


def test_a_goal_that_is_not_pursued_or_not_there_is_named() -> None:
    planner, _ = planned("Front")
    with pytest.raises(InputError, match="Back is not pursued, but"):
        planner.withdraw("Back")
    with pytest.raises(InputError, match="no goal Bakc, did you mean Back"):
        planner.pursue("Bakc")


@pytest.mark.parametrize("seed", range(25))
def test_goals_and_failures_in_any_order_come_to_what_planning_anew_gives(seed: int) -> None:
    """Adaptations are applied late, refused or time out meanwhile."""
    rng = random.Random(seed)
    planner, book = Planner(DOMAIN, goal="Front", relax=(), verify=False), Book(DOMAIN)
    waiting: list[Adaptation] = []
    for _ in range(14):
        for _ in range(rng.randrange(4)):
            step = planner.step()
            waiting.extend(step.adaptations if step else ())
            if waiting and rng.random() < 0.6:
                answer(planner, book, waiting.pop(0), rng)
        goal = rng.choice(["Front", "Back"])
        if goal not in planner.goals:
            planner.pursue(goal)
        elif len(planner.goals) > 1:
            planner.withdraw(goal)
        if rng.random() < 0.2:
            planner.perceive(perception("assumption_failure", "Dry"))
    for _ in range(500):
        step = planner.step()
        waiting.extend(step.adaptations if step else ())
        if waiting:
            answer(planner, book, waiting.pop(0), rng, always=True)
        elif step is None:
            break
    fresh, anew = planned(*planner.goals)
    for name in planner.relaxed:
        fresh.perceive(perception("assumption_failure", name))
    settle(fresh, anew)
    assert image(planner) == image(fresh)
    assert set(book.served()) == set(image(fresh))


def answer(planner: Planner, book: Book, adaptation: Adaptation, rng: random.Random, *, always: bool = False) -> None:
    if always or rng.random() < 0.8:
        book.apply(adaptation)
        planner.perceive(applied(adaptation))
    else:
        kind = rng.choice(["adaptation_refused", "adaptation_timed_out"])
        planner.perceive(perception(kind, str(adaptation.id), cause="x"))  # type: ignore[arg-type]


# ------------------------------------------------------------------------------------------------ another text


def test_another_kit_is_adapted_to_while_the_first_is_made() -> None:
    """A kind more and a kind less: what they have in common is not touched."""
    planner, book = Planner(with_kinds("motor", "cap", "body"), relax=(), verify=False), Book(kitting())
    settle(planner, book)
    before = texts(planner)
    planner.adopt(with_kinds("motor", "label", "body"))
    issued = settle(planner, book)
    after = texts(planner)
    fresh = Planner(with_kinds("motor", "label", "body"), relax=(), verify=False)
    settle(fresh)
    assert image(planner) == image(fresh)
    changed = {change.situation for adaptation in issued for change in adaptation.changes}
    assert changed == {"FillTray", "LacksLabel"}
    assert {name for adaptation in issued for name in adaptation.removed} == {"LacksCap"}
    assert before["LacksMotor"] == after["LacksMotor"]


def test_another_text_that_says_the_same_changes_nothing() -> None:
    planner, book = Planner(kitting(), relax=(), verify=False), Book(kitting())
    settle(planner, book)
    planner.adopt(read_domain(KITTING.read_text() + "\n// nothing new\n"))
    assert settle(planner, book) == []
    assert planner.ideal


def test_what_was_given_up_stays_given_up_with_another_text() -> None:
    planner, book = Planner(kitting(), relax=(), verify=False), Book(kitting())
    planner.perceive(perception("assumption_failure", "AQ"))
    settle(planner, book)
    planner.adopt(with_kinds("motor", "cap"))
    settle(planner, book)
    assert "AQ" in planner.relaxed
    assert "REASSERT[FindGoodPartMotor]" in texts(planner)["LacksMotor"]


def test_a_text_whose_actions_need_something_else_is_no_successor() -> None:
    planner = Planner(kitting(), verify=False)
    text = re.sub(r"executability: Held\(x\) @ i1 and ITL\(i1, \[m o si e di fi\], Move\);", "", KITTING.read_text())
    with pytest.raises(InputError, match="action Move takes, gives or needs something else"):
        planner.adopt(read_domain(text))


# ------------------------------------------------------------------------------------------- in a real reactor


class Rooms:
    """A World that counts who swept what, and ends after a hundred seconds."""

    def __init__(self) -> None:
        self.swept: list[tuple[float, str]] = []
        self.scheduler: Scheduler | None = None

    def start(self, scheduler: Scheduler) -> None:
        self.scheduler = scheduler

    def strike(self, kind: str, **parameters: Any) -> bool:
        return False

    def ledger(self) -> dict[str, int]:
        return {}

    def balanced(self) -> bool:
        return True

    def finished(self) -> bool:
        return False

    def report(self) -> dict[str, object]:
        return {}


def test_a_running_reactor_takes_a_new_goal_and_loses_an_old_one_without_a_stop() -> None:
    rooms = Rooms()

    def make(scheduler: Scheduler, trace: object) -> Host:
        host = Host("rooms")
        host.world = rooms

        @host.process(window=(3.0, 3.0))
        def Sweep(room: str) -> Iterator[float]:
            yield 3.0
            rooms.swept.append((scheduler.now, room))

        @host.process(window=(1.0, 1.0))
        def Mop(room: str) -> Iterator[float]:
            yield 1.0

        host.assumption("Dry")(lambda: True)
        host.assumption("Light")(lambda: True)
        return host

    planner = Planner(DOMAIN, goal="Front", relax=())
    loop = Loop(planner, make, seed=1)
    given = loop.scheduler.call_after

    def tell(what: Any, goal: str) -> None:
        what(goal)
        loop.perceptions.arrived()

    given(20.0, lambda: tell(planner.pursue, "Back"))
    given(60.0, lambda: tell(planner.withdraw, "Front"))
    loop.run(until=100.0)

    def when(room: str) -> list[float]:
        return [time for time, name in rooms.swept if name == room]

    assert loop.reactor.laws.violations == []
    assert loop.reactor.laws.interruptions == 0
    assert loop.reactor.counts["refused"] == loop.reactor.counts["timed_out"] == 0
    assert when("hall")[0] < 5
    assert 55 < when("hall")[-1] < 65
    assert 20 < when("yard")[0] < 25
    assert when("yard")[-1] > 95
    gaps = [later - earlier for earlier, later in zip(when("hall"), when("hall")[1:], strict=False)]
    assert max(gaps) <= 6  # the stairs are swept for one goal after the other; nothing else waits
    assert planner.goals == ("Back",)
    assert "hall" not in loop.reactor.text()


# ------------------------------------------------------------------------------------------------------ advice


def tending(**options: Any) -> tuple[Planner, Book]:
    planner = Planner(kitting(TENDING), relax="none", verify=False, **options)
    book = Book(planner.domain)
    settle(planner, book)
    return planner, book


def test_a_machine_that_is_down_is_planned_without_until_it_is_back() -> None:
    planner, book = tending()
    before = texts(planner)
    planner.tell("Machine(mill)", holds=False)
    issued = settle(planner, book)
    assert {name for adaptation in issued for name in adaptation.removed} == {"LoadMill", "UnloadMill"}
    assert texts(planner)["LoadLathe"] == before["LoadLathe"]
    planner.tell("Machine(mill)", holds=True)
    settle(planner, book)
    assert texts(planner) == before
    with pytest.raises(InputError, match=r"Machine\(mil\) is no fact, did you mean Machine\(mill\)"):
        planner.tell("Machine(mil)", holds=False)


def test_an_assumption_that_somebody_doubts_is_done_without_until_somebody_trusts_it() -> None:
    """Before any sensor says so; and no sensor takes it back."""
    planner, book = tending()
    before = image(planner)
    planner.doubt("INTIME")
    settle(planner, book)
    assert "AwaitLamp[mill]" in texts(planner)["Tending"]
    planner.perceive(perception("assumption_holds", "INTIME"))
    settle(planner, book)
    assert "INTIME" in planner.relaxed
    planner.trust("INTIME")
    settle(planner, book)
    assert image(planner) == before
    with pytest.raises(InputError, match="INTIMES is not an assumption"):
        planner.doubt("INTIMES")


def test_a_second_goal_that_wants_the_same_arm_is_told() -> None:
    planner, book = tending()
    assert not planner.warnings
    planner.pursue("Cleaning")
    settle(planner, book)
    assert planner.warnings == (
        "what goes on side by side in Tending and Cleaning may take 2 of arm, and there is 1: the host must serve one "
        "after the other, or the actions say that they use it",
    )
