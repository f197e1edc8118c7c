"""What the old one can do the new one can: traces under hiding, and the shortest run that shows when not."""

from __future__ import annotations

import random

import pytest
from msgspec.structs import replace

from planner_reactor.analysis.labels import show_label
from planner_reactor.analysis.observing import Atom
from planner_reactor.analysis.refinement import Refinement, refines
from planner_reactor.analysis.systems import build
from planner_reactor.rs.configurations import World
from planner_reactor.rs.evolves import started
from planner_reactor.rs.parser import parse_process
from tests.analysis.random_runs import any_system

PORTS = tuple(Atom("sent", name) for name in ("p", "q", "r"))
SINK = "(IN[p]<x> :; STOP) | (IN[q]<y> :; STOP) | (IN[r]<z> :; STOP)"


def compared(new: str, old: str, *atoms: Atom, limit: int = 1_000) -> Refinement:
    world = World()
    seen = atoms or PORTS
    starts = [started(parse_process(f"({text}) | {SINK}"), world) for text in (new, old)]
    return refines(*(build(start, world, seen, limit=limit) for start in starts))


def test_what_can_do_more_refines_what_can_do_less_and_not_the_other_way() -> None:
    choice, one = "OUT[p, 1] # OUT[q, 1]", "OUT[p, 1]"
    assert compared(choice, one).holds
    back = compared(one, choice)
    assert back.holds is False
    assert back.trace == ((Atom("sent", "q"),),)
    assert list(map(show_label, back.run)) == ["q!1"]


def test_hidden_steps_do_not_count_and_the_run_that_shows_it_is_shortest() -> None:
    slow = "Delay[1] : OUT[p, 1] : Delay[2] : OUT[q, 1]"
    assert compared("OUT[p, 1] : OUT[q, 1]", slow).holds
    assert compared(slow, "OUT[p, 1] : OUT[q, 1]").holds
    found = compared("OUT[p, 1] : Delay[1] : OUT[r, 1]", slow)
    assert [a.name for (a,) in found.trace] == ["p", "q"]
    assert len(found.run) == 6


def test_how_it_ends_can_be_made_visible() -> None:
    stops, stays = "OUT[p, 1]", "OUT[p, 1] : NIL"
    assert compared(stops, stays).holds
    ends = (*PORTS, Atom("ended"), Atom("stuck"))
    world = World()
    alone = [build(started(parse_process(f"({t}) | IN[p]<x>"), world), world, ends) for t in (stops, stays)]
    assert refines(alone[0], alone[1]).holds is False
    assert refines(alone[0], alone[0]).holds


def test_what_a_choice_was_made_for_is_not_seen_in_traces() -> None:
    early, late = "(Try : OUT[p, 1]) # NIL", "OUT[p, 1] # NIL"
    assert compared(early.replace("Try", "Delay[0]"), late).holds


def test_beyond_the_limit_nothing_is_claimed() -> None:
    assert compared("(OUT[p, 1] ; Delay[1]) :; STOP", "(OUT[p, 1] ; Delay[1]) :; STOP").holds
    assert compared("(OUT[p, 1] ; Delay[1]) :; STOP", "(OUT[p, 1] ; Delay[1]) :; STOP", limit=1).holds is None


def test_only_steps_can_be_compared() -> None:
    with pytest.raises(ValueError, match="on s is not a step"):
        compared("STOP", "STOP", Atom("on", "s"))


def test_inclusion_agrees_with_comparing_the_traces_themselves() -> None:
    """Up to a length at which two systems of three states must have differed."""
    dice = random.Random(4)
    verdicts = []
    for _ in range(150):
        new, old = (replace(any_system(dice, 3), atoms=PORTS) for _ in range(2))
        found = refines(new, old)
        mine, theirs = _traces(old, 7), _traces(new, 7)
        verdicts.append(found.holds)
        assert found.holds == (mine <= theirs) or (not found.holds and len(found.run) > 7)
        if found.holds is False and len(found.run) <= 7:
            shown = tuple(sum(1 << PORTS.index(a) for a in seen) for seen in found.trace)
            assert shown in mine - theirs
            assert not _traces(old, len(found.run) - 1) - theirs  # no shorter run of the old one shows it
    assert 0 < sum(map(bool, verdicts)) < 150


def _traces(system: object, length: int) -> set[tuple[int, ...]]:
    """The visible traces of all runs of so many steps."""
    found: set[tuple[int, ...]] = {()}
    ways: set[tuple[int, tuple[int, ...]]] = {(0, ())}
    for _ in range(length):
        ways = {
            (m.after, (*trace, m.seen) if m.seen else trace)
            for state, trace in ways
            for m in system.leaving(state)  # type: ignore[attr-defined]
        }
        found |= {trace for _, trace in ways}
    return found
