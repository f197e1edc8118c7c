"""A network of cells does what `evolves` does; enumeration and reduction keep what they promise; SPIN agrees."""

from __future__ import annotations

import os
import re
from collections.abc import Hashable, Sequence
from functools import cache
from pathlib import Path

import pytest

from planner_reactor.analysis import networks, stubborn
from planner_reactor.analysis.automata import Automata, compiled
from planner_reactor.analysis.cells import Entangled
from planner_reactor.analysis.enumeration import enumerated
from planner_reactor.analysis.explore import explore
from planner_reactor.analysis.exports import graph as drawn
from planner_reactor.analysis.exports import one_process
from planner_reactor.analysis.networks import Vector, networked, whole
from planner_reactor.analysis.partitions import strong
from planner_reactor.analysis.promela import promela
from planner_reactor.analysis.stubborn import reduced
from planner_reactor.analysis.transitions import build
from planner_reactor.errors import BudgetError
from planner_reactor.experiments import copies, spin
from planner_reactor.rs.configurations import Label
from planner_reactor.rs.states import Ended, InstanceNumber
from tests.analysis.nets import Nets, begun

NETS = int(os.environ.get("SPIN_NETS", "0"))
"""Random nets that SPIN is asked about one by one."""

LIMIT = 3_000


def net(seed: int) -> tuple[str, Automata] | None:
    """The net with this number, compiled; None if it is too large."""
    text = Nets(seed).text()
    config, world = begun(text)
    try:
        return text, compiled(networked(config, world, limit=LIMIT))
    except Entangled:
        return text, compiled(whole(config, world, limit=LIMIT))
    except BudgetError:
        return None


def everything(automata: Automata, limit: int = LIMIT) -> dict[Vector, list[Vector]]:
    """The whole composition, by the plainest search."""
    found: dict[Vector, list[Vector]] = {}
    waiting = [automata.start]
    while waiting:
        vector = waiting.pop()
        if vector not in found:
            found[vector] = [after for _, after in automata.moves(vector)]
            waiting += found[vector]
            if len(found) > limit:
                return {}
    return found


def nameless(label: Label) -> Label:
    """Numbers of instances are given out in a cell, or in the whole: only that it is one counts."""
    name, arguments, status, values = label

    def plain(given: Sequence[object]) -> tuple[object, ...]:
        return tuple("k" if isinstance(v, InstanceNumber) else v for v in given)

    return name, plain(arguments), status, plain(values)


@pytest.mark.parametrize("delays", [False, True])
def test_a_network_of_cells_is_bisimilar_to_the_plain_reading_of_evolves(delays: bool) -> None:
    split = 0
    for seed in range(60):
        config, world = begun(Nets(seed, delays=delays).text())
        plain = explore(config, world, limit=300)
        if not plain.complete:
            continue
        ours = build(config, world, limit=LIMIT)
        split += len(ours.network.cells) > 1
        shift = len(plain.states)
        moves = [[(nameless(label), s) for label, s in m] for m in plain.moves]
        moves += [[(nameless(label), s + shift) for label, s in m] for m in ours.moves]
        ends: list[Hashable] = [_ended(s.root(1)) for s in plain.states]
        ends += [ours.outcomes(n)[0] for n in range(len(ours))]
        classes = strong(moves, [e and e[0] for e in ends])  # type: ignore[index]
        assert classes[0] == classes[shift], seed
        assert len(set(classes[:shift])) == len(set(classes[shift:])), seed
    assert split > 20


def _ended(term: object) -> tuple[bool, object] | None:
    return (term.ok, term.bindings) if isinstance(term, Ended) else None


def test_a_vector_stands_for_a_configuration_that_goes_on_as_it_does() -> None:
    """Decoded states, asked again through `evolves`, have the labels of the network's moves."""
    for seed in range(40):
        config, world = begun(Nets(seed).text())
        ours = build(config, world, limit=LIMIT)
        for state in range(0, len(ours), 17):
            again = explore(ours.states[state], world, limit=0)
            assert sorted(str(nameless(label)) for label, _ in again.moves[0]) == sorted(
                str(nameless(label)) for label, _ in ours.moves[state]
            ), seed


@cache
def some_nets() -> list[tuple[str, Automata, dict[Vector, list[Vector]]]]:
    found = []
    for seed in range(250):
        if (given := net(seed)) is not None and (graph := everything(given[1])):
            found.append((*given, graph))
    return found


def stuck(automata: Automata, graph: dict[Vector, list[Vector]]) -> set[Vector]:
    return {v for v, after in graph.items() if not after and not automata.over(v)}


def test_enumeration_by_bits_counts_what_a_plain_search_counts() -> None:
    for text, automata, graph in some_nets():
        found = enumerated(automata)
        assert found.states == len(graph), text
        assert found.transitions == sum(map(len, graph.values())), text
        assert found.deadlocks == len(stuck(automata, graph)), text
        assert found.stuck is None or found.stuck in stuck(automata, graph), text


def test_reduction_keeps_every_deadlock_and_every_state_of_every_cell() -> None:
    smaller = 0
    for text, automata, graph in some_nets():
        for fair in (True, False):
            less = reduced(automata, fair=fair)
            assert set(less.deadlocks) == stuck(automata, graph), text
            assert less.states <= len(graph)
            smaller += less.states < len(graph)
        every = [{v[n] for v in graph} for n in range(len(automata.cells))]
        assert [set(states) for states in reduced(automata).local] == every, text
    assert smaller > 50


def test_stubborn_sets_that_look_at_the_present_only_lose_something(monkeypatch: pytest.MonkeyPatch) -> None:
    """A seeded defect: what a cell may come to offer later is forgotten."""
    monkeypatch.setattr(stubborn, "_later", lambda cell, now: now)
    lost = 0
    for _, automata, whole_graph in some_nets():
        found = reduced(automata)
        every = [{v[n] for v in whole_graph} for n in range(len(automata.cells))]
        lost += set(found.deadlocks) != stuck(automata, whole_graph) or [set(s) for s in found.local] != every
    assert lost > 0


def test_cells_that_forget_the_labels_of_reactions_are_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    """A seeded defect: guards and who kills them are taken apart."""
    text = "(E[1] # NIL) | KILL[1]"
    right = build(*begun(text))
    monkeypatch.setattr(networks, "STORE_KINDS", ("situation",))
    wrong = build(*begun(text))
    assert len(right.network.cells) == 1
    assert {str(label) for label in right.labels} != {str(label) for label in wrong.labels}


def test_reduction_without_the_proviso_loses_states_of_cells() -> None:
    """What the proviso is for: with it removed, some cell's states are never seen."""
    config, world = begun("(a :; a) | (b ; b)")
    automata = compiled(networked(config, world, limit=100))
    assert sum(map(len, reduced(automata, fair=False).local)) < sum(map(len, reduced(automata).local))


WITHOUT_SPIN = pytest.mark.skipif(bool(spin.missing()), reason=spin.missing() or "SPIN is there")


@WITHOUT_SPIN
@pytest.mark.parametrize("chunk", range(10))
def test_spin_finds_the_same_states_and_deadlocks_in_random_nets(chunk: int) -> None:
    """Ten nets are one model, of which SPIN first chooses one: its counts are sums, and one more for the choice."""
    nets = [given for seed in range(chunk * 10, chunk * 10 + 10) if (given := net(seed)) is not None]
    ours = [enumerated(automata) for _, automata in nets]
    states, transitions = sum(o.states for o in ours), sum(o.transitions for o in ours)
    found = spin.searched(one_of([promela(automata) for _, automata in nets]), fast=False, expected=states)
    assert found.states == states + 1
    assert found.transitions == transitions + len(nets) + 1
    assert found.deadlocks == sum(o.deadlocks for o in ours)


@WITHOUT_SPIN
@pytest.mark.skipif(NETS == 0, reason="SPIN_NETS says how many nets are asked one by one (make nets)")
@pytest.mark.timeout(3600)
def test_spin_agrees_on_each_random_net() -> None:
    """States, transitions (SPIN counts the first state as one) and deadlocks of every net, one by one."""
    asked, deadlocked, seed = 0, 0, 1_000
    while asked < NETS:
        given, seed = net(seed), seed + 1
        if given is None:
            continue
        text, automata = given
        ours = enumerated(automata)
        found = spin.searched(promela(automata), fast=False, expected=ours.states)
        same = (ours.states, ours.transitions + 1, ours.deadlocks)
        assert (found.states, found.transitions, found.deadlocks) == same, (seed - 1, text)
        asked += 1
        deadlocked += ours.deadlocks > 0
    print(f"{asked} nets agree, {deadlocked} of them with deadlocks")


@WITHOUT_SPIN
def test_spin_agrees_where_time_passes() -> None:
    """Then the whole system is exported as one process, and SPIN looks at each of its states."""
    whole_systems = []
    for seed in range(16):
        config, world = begun(Nets(seed, delays=True).text())
        found = build(config, world, limit=LIMIT)
        if any(label[0] == "TIME" for label in found.labels):
            whole_systems.append(found)
    assert len(whole_systems) > 4
    model = one_of([one_process(drawn(found), title="timed") for found in whole_systems])
    states = sum(map(len, whole_systems))
    asked = spin.searched(model, fast=False, expected=states)
    assert asked.states == states + 1
    assert asked.deadlocks == sum(len(found.deadlocks) for found in whole_systems)


def one_of(models: list[str]) -> str:
    """A model that is one of these, whichever SPIN chooses at first."""
    texts, choices = [], []
    for n, model in enumerate(models):
        own = re.sub(r"\b(cell_|port_|system\b)", rf"net{n}_\1", model.replace("active proctype", "proctype"))
        texts.append(own)
        runs = "; ".join(f"run {name}()" for name in re.findall(r"proctype (\w+)\(", own))
        choices.append(f"  :: true -> {runs}")
    return "\n".join([*texts, "init {", " atomic {", "  if", *choices, "  fi }", "end_chosen: false", "}"])


@WITHOUT_SPIN
@pytest.mark.parametrize("coupled", [False, True])
def test_spin_agrees_on_safe_adaptations_side_by_side(coupled: bool) -> None:
    automata = compiled(networked(*copies.begun(2, coupled=coupled), limit=LIMIT))
    ours, less = enumerated(automata), reduced(automata)
    found = spin.searched(promela(automata), fast=False, expected=ours.states)
    assert (found.states, found.deadlocks) == (ours.states, ours.deadlocks)
    assert less.states <= spin.searched(promela(automata), fast=False, reduction=True, expected=ours.states).states


@pytest.mark.parametrize(("k", "coupled"), [(2, False), (2, True), (3, False), (3, True), (4, False)])
def test_the_published_models_are_what_is_exported(k: int, coupled: bool) -> None:
    name = f"copies_{k}{'_coupled' * coupled}"
    models = Path(__file__).parents[2] / "benchmarks" / "models"
    assert (models / f"{name}.rsl").read_text() == copies.text(k, coupled=coupled)
    automata = compiled(networked(*copies.begun(k, coupled=coupled), limit=LIMIT))
    assert (models / f"{name}.pml").read_text() == promela(automata, title=name)
