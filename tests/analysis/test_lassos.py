"""The search for fair lassos, held against looking at every part of a small system."""

from __future__ import annotations

import random
from itertools import combinations, pairwise

import pytest

from planner_reactor.analysis import lassos
from planner_reactor.analysis.lassos import Lasso, accepted
from planner_reactor.analysis.products import Justice, components, product
from planner_reactor.analysis.systems import System
from planner_reactor.analysis.tableau import Automaton, Edge, automaton
from planner_reactor.analysis.temporal import FALSE, Here, Negation, always, eventually, holds
from planner_reactor.rs.configurations import Label
from tests.analysis.random_runs import ATOMS, any_system, formula, system

ANY = Automaton(((Edge(0, 0, 0, 0),),), 0)
KINDS = {"a": 0, "b": 1, "c": 2}


def fairness(weak: str = "", strong: str = "") -> Justice:
    def bits(names: str) -> int:
        return sum(1 << KINDS[name] for name in names)

    return Justice(lambda label: KINDS.get(label[0], -1), bits(weak), bits(strong))


def is_fair(made: System, found: Lasso, justice: Justice) -> bool:
    if found.decided:
        return True
    cycle_states = found.states[len(found.prefix) :]
    taken = {label[0] for label in found.cycle}
    possible = [{m.label[0] for m in made.moves[s]} for s in cycle_states]
    return just(taken, possible, justice)


def just(taken: set[str], possible: list[set[str]], justice: Justice) -> bool:
    """Weak: taken, or somewhere impossible. Strong: taken, or nowhere possible."""
    neglected = {name: k for name, k in KINDS.items() if name not in taken}
    return all(
        not (justice.weak >> k & 1 and all(name in p for p in possible))
        and not (justice.strong >> k & 1 and any(name in p for p in possible))
        for name, k in neglected.items()
    )


def is_a_run(made: System, found: Lasso) -> bool:
    steps = list(zip(found.states, (*found.prefix, *found.cycle), strict=True))
    back = found.states[len(found.prefix)]
    goes = [*pairwise(found.states), (found.states[-1], back)]
    return found.states[0] == 0 and all(
        any(m.label == label and m.after == after for m in made.moves[state])
        for (state, label), (_, after) in zip(steps, goes, strict=True)
    )


def somewhere_fair(made: System, justice: Justice) -> bool:
    """Is there a set of states, all connected, with a fair way through all of it? By trying every set."""
    for size in range(1, len(made.states) + 1):
        for chosen in map(set, combinations(range(len(made.states)), size)):
            inner = {n: [m for m in made.moves[n] if m.after in chosen] for n in chosen}
            if not all(_reach(inner, n) == chosen for n in chosen) or not chosen & _reachable(made):
                continue
            taken = {m.label[0] for moves in inner.values() for m in moves}
            possible = [{m.label[0] for m in made.moves[n]} for n in chosen]
            if just(taken, possible, justice):
                return True
    return False


def _reach(inner: dict[int, list], start: int) -> set[int]:  # type: ignore[type-arg]
    found, waiting = set(), [start]
    while waiting:
        for move in inner[waiting.pop()]:
            if move.after not in found:
                found.add(move.after)
                waiting.append(move.after)
    return found


def _reachable(made: System) -> set[int]:
    return {0} | _reach(dict(enumerate(map(list, made.moves))), 0)


@pytest.mark.parametrize(("weak", "strong"), [("", ""), ("abc", ""), ("", "abc"), ("ab", "c"), ("", "ab")])
def test_a_fair_run_is_found_exactly_if_there_is_one(weak: str, strong: str) -> None:
    dice = random.Random(11)
    verdicts = []
    for _ in range(120):
        made, justice = any_system(dice, 5), fairness(weak, strong)
        found = accepted(made, ANY, justice)
        verdicts.append(found is not None)
        assert verdicts[-1] == somewhere_fair(made, justice)
        if found is not None:
            assert is_a_run(made, found)
            assert is_fair(made, found, justice)
    assert any(verdicts)


def test_a_found_run_is_one_of_which_the_formula_holds() -> None:
    dice = random.Random(5)
    count = 0
    for _ in range(300):
        made, asked = any_system(dice, 4), formula(dice, 3)
        if (found := accepted(made, automaton(asked, ATOMS), fairness("abc"))) is None:
            continue
        count += 1
        labels = (*found.prefix, *found.cycle)
        assert is_fair(made, found, fairness("abc"))
        if found.decided:
            labels, found = goes_on(made, found)
        assert any(holds(asked, list(moments), len(found.prefix)) for moments in readings(made, found.states, labels))
    assert count > 50


def goes_on(made: System, found: Lasso) -> tuple[tuple[Label, ...], Lasso]:
    """A run that is decided after its prefix, continued in any way until it comes back to a state."""
    labels, states = list(found.prefix), list(found.states)
    while states[-1] not in states[len(found.prefix) : -1]:
        move = made.moves[states[-1]][0]
        labels.append(move.label)
        states.append(move.after)
    back = states.index(states[-1], len(found.prefix))
    return tuple(labels), Lasso(tuple(labels[:back]), tuple(labels[back:]), tuple(states[:-1]))


def readings(made: System, states: tuple[int, ...], labels: tuple[Label, ...]) -> list[list[frozenset[object]]]:
    """What may have been seen along these states and labels: several moves may have the same label."""
    found: list[list[frozenset[object]]] = [[]]
    for state, label in zip(states, labels, strict=True):
        seen = {m.seen for m in made.moves[state] if m.label == label}
        found = [[*way, frozenset(a for n, a in enumerate(ATOMS) if s >> n & 1)] for way in found for s in seen][:64]
    return found


def test_the_lasso_is_the_shortest() -> None:
    """A long way round that is found first, and a short one behind it."""
    made = system([[("a", 1, 0), ("b", 4, 0)], [("a", 2, 0)], [("a", 3, 0)], [("a", 1, 1)], [("b", 4, 1)]])
    found = accepted(made, automaton(always(eventually(Here(ATOMS[0]))), ATOMS), fairness())
    assert found is not None
    assert (len(found.prefix), len(found.cycle)) == (1, 1)


def test_with_no_effort_left_a_lasso_is_still_a_fair_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lassos, "EFFORT", 0)
    dice = random.Random(2)
    for _ in range(200):
        made, justice = any_system(dice, 5), fairness("a", "bc")
        if (found := accepted(made, ANY, justice)) is not None:
            assert is_a_run(made, found)
            assert is_fair(made, found, justice)


def test_a_run_that_ends_goes_on_doing_nothing() -> None:
    made = system([[("a", 1, 1)], []])
    quiet = always(eventually(Negation(Here(ATOMS[0]))))
    found = accepted(made, automaton(quiet, ATOMS), fairness("abc", ""))
    assert found is not None
    assert (found.prefix, found.cycle, found.decided) == ((("a", (), "ok", ()),), (), False)
    assert accepted(made, automaton(FALSE, ATOMS), fairness()) is None


def test_components_are_those_of_a_graph_with_a_bridge() -> None:
    made = system([[("a", 1, 0)], [("a", 0, 0), ("a", 2, 0)], [("a", 3, 0)], [("a", 2, 0)]])
    both = product(made, ANY, fairness())
    assert set(components(both.arcs, frozenset(range(4)))) == {frozenset({0, 1}), frozenset({2, 3})}
