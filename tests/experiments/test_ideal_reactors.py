"""The planner's kitting reactors are ω-ideal, and the check can say no (R §6.2, equations (8), (10) to (12))."""

from __future__ import annotations

from functools import cache

import pytest
from msgspec.structs import replace

from planner_reactor.analysis.ideal import (
    Partial,
    Reactor,
    achieves,
    converges,
    ideal,
    idle,
    partially_ideal,
    side_by_side,
)
from planner_reactor.analysis.refinement import refines
from planner_reactor.analysis.systems import System
from planner_reactor.calls.replaying import replay
from planner_reactor.experiments.ideal_reactors import GOAL, NOTHING, chain, environment, planned, regimes
from planner_reactor.rs.configurations import World, spawned_situations
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.workcell.environments import ASSUMPTIONS

ONE = ("cap",)
SINGLE = tuple(name for name in ASSUMPTIONS if name != "AO")


@cache
def reactor(*without: str) -> Reactor:
    return planned(ONE, without)


@pytest.mark.parametrize("name", SINGLE)
def test_equations_8_and_12_about_each_assumption(name: str) -> None:
    """Built on it, the reactor works where it holds and not where it fails; relaxed, it works in both."""
    found = regimes(name, ONE)
    assert found["rests_on_it"]
    assert found["resting_where_it_holds"] is True
    assert found["resting_where_it_fails"] is False
    assert found["relaxed_where_it_holds"] is True
    assert found["relaxed_where_it_fails"] is True
    assert found["counterexample"]


def test_the_order_of_placing_is_asked_of_two_kinds() -> None:
    world = environment(("cap", "motor"))
    found = achieves(planned(("cap", "motor")).text, world(frozenset({"AO"})), GOAL)
    assert found.holds is False
    assert found.counterexample is not None
    assert not found.counterexample.cycle  # whoever took the arm waits for a part that will not come


def test_the_reactor_without_assumptions_works_wherever_one_fails_and_where_all_do() -> None:
    relaxed = reactor(*SINGLE)
    assert relaxed.rests_on <= {"AO"}
    worlds = [NOTHING, *(frozenset({name}) for name in SINGLE), frozenset(SINGLE)]
    verdicts = ideal(relaxed, environment(ONE), GOAL, worlds)
    assert len(verdicts) == len(worlds)
    assert all(verdict.holds for verdict in verdicts.values())


@pytest.mark.parametrize("name", ["AQ", "AF"])
def test_a_counterexample_runs_in_the_executer(name: str) -> None:
    world = environment(ONE)(frozenset({name}))
    found = achieves(reactor().text, world, GOAL).counterexample
    assert found is not None
    program, process = parse_program(world + reactor().text), parse_process("EM | REACTOR")
    rules = World(program, spawned=spawned_situations(program, process))
    assert replay([process], rules, (*found.prefix, *found.cycle)).done
    assert not replay([process], rules, (*found.prefix[1:], *found.cycle), tries=30).done


def test_equation_12_asks_only_for_worlds_in_which_all_of_omega_holds() -> None:
    worlds = [NOTHING, frozenset({"AQ"}), frozenset({"ADD"})]
    assert set(ideal(reactor("AQ"), environment(ONE), GOAL, worlds)) == {NOTHING, frozenset({"AQ"})}


def test_no_assumption_of_the_first_ideal_reactor_is_idle() -> None:
    first = reactor()
    assert first.rests_on >= set(SINGLE)
    asked = replace(first, rests_on=first.rests_on - {"AO"})
    assert idle(asked, environment(ONE), GOAL) == ()
    assert idle(Reactor(reactor("AQ").text, frozenset({"AQ"})), environment(ONE), GOAL) == ("AQ",)


def test_equations_10_and_11_from_one_ideal_reactor_to_the_next() -> None:
    partials = chain(ONE, "AQ")
    given_up = partials[0].unfinished
    assert [sorted(p.unfinished) for p in partials] == [["AQ(cap)", "AQ(tray)"], ["AQ(cap)"], []]
    assert converges(partials, given_up)
    assert all(v.holds for v in partially_ideal(partials, environment(ONE), GOAL, given_up))


@pytest.mark.parametrize("name", SINGLE)
def test_equation_10_every_reactor_on_the_way_works_where_the_first_did_and_the_last_everywhere(name: str) -> None:
    """f(e_j) is the assumption, as long as anything of it is not finished; e_j: `planner/test_convergence.py`."""
    world = environment(ONE)
    partials = chain(ONE, name)
    assert len(partials) > 1
    assert all(achieves(partial.text, world(NOTHING), GOAL).holds for partial in partials)
    assert achieves(partials[-1].text, world(frozenset({name})), GOAL).holds
    assert not partials[-1].unfinished


def test_what_is_not_finished_is_needed() -> None:
    """(10) without f(e_j): the partial reactor fails where what it still rests on fails."""
    half = chain(ONE, "AQ")[1]
    claimed = [Partial(half.text, NOTHING)]
    (verdict,) = partially_ideal(claimed, environment(ONE), GOAL, frozenset({"AQ(cap)", "AQ(tray)"}))
    assert verdict.holds is False


def test_a_chain_that_stands_still_or_does_not_end_does_not_converge() -> None:
    steps = [frozenset({"AQ(cap)", "AQ(tray)"}), frozenset({"AQ(cap)"}), NOTHING]
    assert converges([Partial("", e) for e in steps], steps[0])
    for wrong in (steps[:2], [steps[0], *steps], [steps[0], steps[0], NOTHING], steps[1:], []):
        assert not converges([Partial("", e) for e in wrong], steps[0])


@pytest.mark.parametrize(("printed", "defect"), [
    ("Test[cap, x1] : ", ""),  # what was found is not tested
    ("SUCCEED[FindGoodPartCap", "FAIL[FindGoodPartCap"),  # a reaction never succeeds (R0 and R1 as printed)
    ("Insert[x2, x1]", "STOP"),  # what was found is not placed
])  # fmt: skip
def test_a_defect_of_the_reactor_is_found(printed: str, defect: str) -> None:
    text = reactor("AQ").text
    assert printed in text
    assert achieves(text.replace(printed, defect), environment(ONE)(frozenset({"AQ"})), GOAL).holds is False


def test_the_improved_reactor_can_do_at_least_what_the_old_one_did() -> None:
    """Trace refinement of what downstream sees, where the assumption holds; where it fails the old one does worse."""

    def seen(which: Reactor, *fails: str) -> System:
        return side_by_side(which.text, environment(ONE)(frozenset(fails)), GOAL)

    old, new = reactor(), reactor("AQ")
    assert refines(seen(new), seen(old)).holds
    assert refines(seen(old), seen(new)).holds
    worse = refines(seen(new, "AQ"), seen(old, "AQ"))
    assert worse.holds is False
    assert [str(atom) for atom in worse.trace[-1]] == ["sent kit[refused]"]
