"""Safe adaptation explored: drain × REASSERT × disable × cancel on small reactors (R §5.5, docs/language.md)."""

from __future__ import annotations

import pytest

from planner_reactor.analysis.explore import Exploration, explore
from planner_reactor.rs.configurations import Config, World
from planner_reactor.rs.evolves import started
from planner_reactor.rs.leaves import Step, resting
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.states import Ended, Leaf, parts_of
from planner_reactor.rs.vocabulary import Signature

OPEN = (0.0, float("inf"))
LEAVES = {n: Signature(n, (), (), window=OPEN) for n in ("RSB", "RSX", "RSY", "Q", "Late")}

REACTOR = """
R = (E[1] # P[1]) | (E[2] # P[2]) | (E[3] # P[3]) | (ADD<m> :: (E[m] # P[m]))
P[1] = Q :; ASSERT[sa]
P[2] = SIT[sa]<k> :; (~(REASSERT[sb] : SUCCEED[sa, k]) : FAIL[sa, k])
P[3] = SIT[sb]<k> :; (~(RSB : SUCCEED[sb, k]) : FAIL[sb, k])
P[4] = SIT[sa]<k> :; (~(ASSERT[sx] : SUCCEED[sa, k]) : FAIL[sa, k])
P[5] = SIT[sx]<k> :; (~(RSX : SUCCEED[sx, k]) : FAIL[sx, k])
"""
SURGERY = "KILL[2] : KILL[3] : POST[5] : POST[4] : UNINHIBIT[sa]"


def ends_either_way(name: str, arguments: tuple[object, ...]) -> list[tuple[bool, tuple[object, ...]]]:
    return [(True, ()), (False, ())] if name in ("RSB", "RSX") else [(True, ())]


WORLD = World(parse_program(REACTOR), LEAVES, endings=ends_either_way)


def explored(*scripts: str, limit: int = 20_000, reactor: str = "R") -> Exploration:
    config = started(parse_process(reactor), WORLD)
    for script in scripts:
        config = started(parse_process(script), WORLD, config=config)
    return explore(config, WORLD, laws=LAWS, limit=limit)


def no_body_is_cut(before: Config, step: Step) -> bool:
    return step.after.store.cut == 0


def an_instance_sees_one_version(before: Config, step: Step) -> bool:
    guards: dict[int, set[object]] = {}
    for reaction, number in step.after.store.served:
        guards.setdefault(number, set()).add(reaction.guard)
    return all(len(g) == 1 for g in guards.values())


def every_inhibition_has_a_live_owner(before: Config, step: Step) -> bool:
    live = {n for n, term in step.after.roots if not isinstance(term, Ended)}
    return all(h.owner in live or isinstance(h.owner, tuple) for h in step.after.store.inhibitions)


def a_kill_is_legal_when_it_is_reached(before: Config, step: Step) -> bool:
    spots = list(step.after.spots())
    labels = {s.leaf.arguments for s in spots if isinstance(s.leaf, Leaf) and s.leaf.name == "KILL"}
    for spot in spots:
        if isinstance(spot.leaf, Leaf) and spot.leaf.name == "E" and spot.leaf.arguments in labels:
            group = step.after.root(spot.root)
            for index in spot.path[:-1]:
                group = parts_of(group)[index]
            if not all(resting(p) for i, p in enumerate(parts_of(group)) if i != spot.path[-1]):
                return False
    return True


LAWS = {
    "safe": no_body_is_cut,
    "consistent": an_instance_sees_one_version,
    "owned": every_inhibition_has_a_live_owner,
    "legal": a_kill_is_legal_when_it_is_reached,
}


def script_has_ended(config: Config) -> bool:
    return isinstance(config.root(2), Ended)


def adapted(config: Config) -> bool:
    """The script has ended, the old reactions are gone, the new ones are there, nothing is inhibited."""
    labels = {s.guard for s in config.spots()}
    held = [h for h in config.store.inhibitions if not isinstance(h.owner, tuple)]
    return script_has_ended(config) and {4, 5} <= labels and not {2, 3} & labels and not held


def test_draining_is_safe_consistent_and_always_comes_to_its_end() -> None:
    found = explored(f"DRAIN[sa] : {SURGERY}")
    assert found.complete
    assert not found.violations
    assert found.trapped(adapted) is None


def test_draining_with_a_failed_assumption_at_any_moment() -> None:
    found = explored(f"DRAIN[sa] : {SURGERY}", "Late : DISABLE[sb, A] : DISABLE[sa, A] : Late : ENABLE[sa, A]")
    assert found.complete
    assert not found.violations
    assert found.trapped(adapted) is None


def test_a_drain_that_is_cancelled_at_any_moment_leaves_nothing_inhibited() -> None:
    found = explored("DRAIN[sa] # Late")
    assert found.complete
    assert not found.violations
    over = [s for s in found.states if script_has_ended(s)]
    assert over
    assert all(not s.store.inhibitions and not s.store.drains for s in over)
    assert found.trapped(lambda s: any(i.situation == "sb" for i in s.store.instances)) is None


def test_a_situation_whose_child_is_disabled_can_still_be_drained() -> None:
    found = explored(f"DRAIN[sa] : {SURGERY}", "DISABLE[sb, A]")
    assert not found.violations
    assert found.trapped(adapted) is None


def test_two_drains_top_down_come_to_their_end() -> None:
    found = explored("DRAIN[sa] : DRAIN[sb] : KILL[2] : KILL[3] : POST[5] : POST[4] : UNINHIBIT[sb] : UNINHIBIT[sa]")
    assert not found.violations
    assert found.trapped(adapted) is None


def test_two_adaptations_of_a_parent_and_its_child_at_once_both_come_to_their_end() -> None:
    found = explored("DRAIN[sa] : UNINHIBIT[sa]", "DRAIN[sb] : UNINHIBIT[sb]")
    assert not found.violations
    assert found.trapped(lambda s: all(isinstance(s.root(n), Ended) for n in (2, 3))) is None


def test_wait_then_inhibit_is_unsafe() -> None:
    """An instance slips in between: the KILL is reached while its body is in service."""
    found = explored(f"WAIT[sa] : INHIBIT[sa] : {SURGERY}")
    assert {v.law for v in found.violations} == {"legal"}
    assert len(found.violations[0].path) <= 6


def test_inhibit_then_wait_deadlocks() -> None:
    found = explored(f"INHIBIT[sa] : WAIT[sa] : {SURGERY}")
    stuck = found.trapped(script_has_ended)
    assert stuck is not None
    assert len(found.path(stuck)) <= 3


def test_waitinhibit_is_safe_and_may_be_overtaken_for_ever() -> None:
    """With one instance at a time it can always still be granted; that it need not be is shown with a lasso."""
    found = explored(f"WAITINHIBIT[sa] : {SURGERY}")
    assert not found.violations
    assert found.trapped(script_has_ended) is None


@pytest.mark.parametrize("assertion", ["ASSERT[sb]", "~((~ASSERT[sb]) :; STOP)"])
def test_a_printed_reassert_would_keep_a_drained_parent_for_ever(assertion: str) -> None:
    """REASSERT as a macro does not give up: an ASSERT below a drained owner fails at once, again and again."""
    text = REACTOR.replace("REASSERT[sb]", assertion)
    world = World(parse_program(text), LEAVES, endings=ends_either_way)
    config = started(parse_process("DRAIN[sa] : UNINHIBIT[sa]"), world, config=started(parse_process("R"), world))
    found = explore(config, world, laws=LAWS, limit=5_000)
    trapped = found.trapped(script_has_ended)
    assert (trapped is None) == (assertion == "ASSERT[sb]")


def test_a_withdrawn_instance_is_not_served_again_so_that_two_reactions_cannot_keep_each_other_alive() -> None:
    two = parse_process("(SIT[s]<k> :; Q) | (SIT[s]<j> :; Q) | ASSERT[s]")
    config = started(parse_process("DRAIN[s]"), WORLD, config=started(two, WORLD))

    def served_while_withdrawn(before: Config, step: Step) -> bool:
        return not (step.label[0] == "SIT" and any(i.withdrawn for i in before.store.instances))

    found = explore(config, WORLD, laws={"not served again": served_while_withdrawn})
    assert found.complete
    assert not found.violations
    assert found.trapped(lambda state: isinstance(state.root(2), Ended)) is None
