"""Terms while they run: what they keep, how small they stay, in which order they are settled and aborted.

The fine print of the rules: `test_evolves` asks what each says; here is what a rule with a small mistake would still
get right there (docs/analysis.md, Mutants).
"""

from __future__ import annotations

import pytest

from planner_reactor.errors import BudgetError
from planner_reactor.rs.evolves import killed
from planner_reactor.rs.leaves import steps
from planner_reactor.rs.states import (
    Await,
    Chain,
    Ended,
    Export,
    Keep,
    Leaf,
    Spawning,
)
from tests.rs.driving import SERVED, begun, explored, following, inside
from tests.rs.test_evolves import STOPS, run, world


def chain_of(calls: int) -> str:
    """D0 calls D1, … up to the last, which waits for a reader."""
    return "\n".join([*(f"D{n} = D{n + 1}" for n in range(calls)), f"D{calls} = IN[p]<x>"])


def released(*roots: str) -> list[str]:
    """In which order two held situations s and t become instances, when these roots let them go."""
    holding = "(SIT[s]<k> :; NIL) | (SIT[t]<j> :; NIL) | ASSERT[s, 1] | ASSERT[t, 1]"
    late = [f"({root})" for root in roots]
    delayed = [root.replace("IN[p]", "Delay[3] ; IN[p]").replace("OUT[p, 1]", "Delay[3] ; OUT[p, 1]") for root in late]
    spaced = [root.replace("DRAIN", "Delay[1] ; DRAIN") for root in delayed]
    grouped = [regrouped(root) for root in spaced]
    config = following(holding, *grouped, "Delay[2] ; (ASSERT[s, 2] | ASSERT[t, 2])", until=4)
    return [i.situation for i in config.store.instances if i.arguments == (2,)]


def regrouped(text: str) -> str:
    """Sequences inside a `#` stand in parentheses."""
    for situation in "st":
        text = text.replace(f"Delay[1] ; DRAIN[{situation}]", f"(Delay[1] ; DRAIN[{situation}])")
    return text.replace("Delay[3] ; IN[p]<x>", "(Delay[3] ; IN[p]<x>)").replace(
        "Delay[3] ; OUT[p, 1]", "(Delay[3] ; OUT[p, 1])"
    )


def test_n7_a_hundred_calls_may_unfold_without_a_process_between_and_no_more() -> None:
    assert run("D0", "OUT[p, 1]", program=chain_of(100)) == STOPS
    for text in ("D0", "D0 ; STOP", "D0 : STOP", "~D0", "D0 | NIL", "D0 # NIL", "D0 & NIL", "D0 :; STOP", "D0 :: STOP",
                 "if D0 then STOP else STOP"):  # fmt: skip
        with pytest.raises(BudgetError):
            run(text, program=chain_of(101))


def test_n7_each_round_of_a_loop_may_unfold_as_many_calls() -> None:
    for loop in (":;", "::"):
        config = following(f"D0 {loop} STOP", "OUT[p, 1] ; OUT[p, 2]", program=chain_of(100), until=1)
        assert config.root(2) == Ended(True)


def test_n7_parameters_have_the_values_of_the_arguments() -> None:
    program = "T[b, a] = OUT[p, b - a] ; OUT[p, a]"
    assert run("T[5, 2]", "IN[p]<x> ; IN[p]<y>", program=program) == {(True, (("x", 3), ("y", 2)))}


def test_n7_constants_of_a_head_bind_nothing() -> None:
    assert run("T[1, 5]", "IN[p]<x>", program="T[1, n] = OUT[p, n]") == {(True, (("x", 5),))}


def test_bindings_are_sorted_so_that_equal_states_are_equal() -> None:
    config = following("T[1, 2] & NIL", until=0, program="T[z, y] = IN[w]<v> ; OUT[y, z]")
    (chain,) = [t for t in inside(config.root(1)) if isinstance(t, Chain)]
    assert chain.scope == (("y", 2), ("z", 1))
    assert run("T<z, y>", program="T<v, u> = yes<v> ; no<u>") == {(False, (("y", 0), ("z", 1)))}
    served = "SIT[s]<k, x> :; (UPDATE[s, k, 8, 9] ; SUCCEED[s, k])"
    assert run(served, "ASSERT[s, 1]<z, y>") == {(True, (("y", 9), ("z", 8)))}


def test_what_waits_keeps_only_the_bindings_that_it_uses() -> None:
    config = following("yes<x> ; (yes<y> ; (IN[w]<v> ; OUT[q, x]))", until=0)
    (chain,) = [t for t in inside(config.root(1)) if isinstance(t, Chain)]
    assert isinstance(chain, Chain)
    assert chain.scope == (("x", 1),)
    for body in ("{} :; OUT[q, x]", "{} :: OUT[q, x]", "if {} then OUT[q, x] else STOP", "{} : OUT[q, x]"):
        config = following("T[1, 2] # NIL", until=0, program=f"T[x, y] = {body.format('IN[w]<v>')}")
        (scope,) = [t.scope for t in inside(config.root(1)) if hasattr(t, "scope")]
        assert scope == (("x", 1),)


def test_n6_nested_results_are_merged() -> None:
    config = following("yes<x> ; (yes<y> ; (no<z> ; NIL))", until=0)
    kept = [t for t in inside(config.root(1)) if isinstance(t, Keep)]
    assert [t.bindings for t in kept] == [(("x", 1), ("y", 1), ("z", 0))]
    assert not any(
        isinstance(t, Keep) and not t.bindings for t in inside(following("STOP ; IN[w]<v>", until=0).root(1))
    )


@pytest.mark.parametrize(
    "body", ["Delay[1] ; T", "Delay[1] : T", "(yes<x> ; Delay[1]) ; T", "if Delay[1] then T else T"]
)
def test_n6_tail_calls_take_no_space(body: str) -> None:
    assert len(explored("T", program=f"T = {body}").states) < 8


def test_n6_an_export_of_nothing_hides_what_is_kept_and_what_is_exported_below() -> None:
    config = following("T", until=3.5, program="T = yes<x> ; Delay[1] ; T")
    assert sum(isinstance(t, Export) for t in inside(config.root(1))) == 1
    assert not any(isinstance(t, Export) and isinstance(t.body, Export | Keep) for t in inside(config.root(1)))


def test_n6_a_result_that_was_never_bound_is_not_exported() -> None:
    assert run("T<y>", program="T<r> = (yes<r> ; NIL) # STOP") == STOPS


def test_n8_ended_bodies_are_merged_away_and_the_newest_stands_last() -> None:
    text = "(IN[p]<x> :: Delay[x]) | (OUT[p, 1] ; OUT[p, 5] ; OUT[p, 3])"
    for until, delays in ((0.5, [1, 5, 3]), (2, [5, 3]), (4, [5]), (6, [])):
        (spawning,) = [t for t in inside(following(text, until=until).root(1)) if isinstance(t, Spawning)]
        found = [t.arguments[0] for b in spawning.bodies for t in inside(b) if isinstance(t, Leaf)]
        assert found == delays
        assert len(spawning.bodies) == len(delays)
        assert spawning.stopped == (len(delays) < 3)


@pytest.mark.parametrize(("first", "second"), [("yes", "no"), ("no", "yes"), ("no", "no"), ("yes", "yes")])
def test_n8_spawning_remembers_that_a_body_stopped(first: str, second: str) -> None:
    body = f"if Equal[x, 1] then {first} else (Delay[3] ; {second})"
    text = f"(((IN[p]<x> : GTR[x, 0]) :: ({body})) | ((OUT[p, 1] ; OUT[p, 2] ; OUT[p, 0]) : ABORT))"
    assert {end for end, _ in run(text)} == {"yes" in (first, second)}


def test_n10_both_branches_see_the_results_of_the_test() -> None:
    for test, value in (("yes", 1), ("no", 0)):
        text = f"if {test}<x> then OUT[p, x] else OUT[p, x]"
        assert run(text, "IN[p]<y>") == {(True, (("y", value),))}
        assert run(f"if {test}<x> then STOP else STOP") == {(True, (("x", value),))}


def test_n10_the_branches_see_what_is_in_scope() -> None:
    assert run("yes<z> ; (if yes<x> then OUT[p, z] else STOP)", "IN[p]<y>") == {(True, (("y", 1),))}


def test_n5_disablings_of_one_depth_are_decided_from_the_left_and_from_the_first_root() -> None:
    """Seen in the order in which two drains let their queues go."""
    for reactor in (
        ("(IN[p]<x> # DRAIN[s])", "(OUT[p, 1] # DRAIN[t])"),
        ("(IN[p]<x> # DRAIN[s]) | (OUT[p, 1] # DRAIN[t])",),
    ):
        assert released(*reactor) == ["s", "t"]
    for reactor in (
        ("(OUT[p, 1] # DRAIN[t])", "(IN[p]<x> # DRAIN[s])"),
        ("(OUT[p, 1] # DRAIN[t]) | (IN[p]<x> # DRAIN[s])",),
    ):
        assert released(*reactor) == ["t", "s"]


def test_n5_deeper_disablings_are_decided_first_wherever_they_stand() -> None:
    deep = "((((OUT[p, 1] # DRAIN[t]) ; NIL) # NIL) | NIL)"
    assert released(f"(IN[p]<x> # DRAIN[s]) | {deep}") == ["t", "s"]
    assert released(f"{deep} | (IN[p]<x> # DRAIN[s])") == ["t", "s"]
    assert released("(IN[p]<x> # DRAIN[s])", deep) == ["t", "s"]


def test_n9_an_aborted_assert_leaves_the_queue() -> None:
    config = following("DRAIN[s] ; NIL", "Delay[1] ; (ASSERT[s] # Delay[1])", until=3)
    assert config.store.queue == ()
    assert config.root(2) == Ended(True)


def test_n9_an_aborted_drain_lets_its_queue_go_at_once() -> None:
    config = following(
        "(SIT[s]<k> :; NIL) | ASSERT[s, 1]", "(Delay[1] ; DRAIN[s]) # Delay[3]", "Delay[2] ; ASSERT[s, 2]", until=4
    )
    assert config.store.drains == ()
    assert config.store.queue == ()
    assert [i.arguments for i in config.store.instances] == [(1,), (2,)]


def test_n9_an_aborted_body_is_counted_and_leaves_the_store() -> None:
    config = following("(SIT[s]<k> :; NIL) # Delay[2]", "ASSERT[s]", until=3)
    assert config.store.cut == 1
    assert config.store.run == ()
    twice = following("((SIT[s]<k> :; NIL) | (SIT[s]<j> :; NIL)) # Delay[2]", "ASSERT[s]", until=3)
    assert twice.store.cut == 2
    assert following(SERVED, "ASSERT[s]", until=9).store.cut == 0


def test_testing_keeps_its_scope_for_every_round() -> None:
    text = "yes<y> ; ((IN[p]<x> : GTR[x, 0]) :; OUT[q, y + x])"
    assert run(f"({text}) | (OUT[p, 1] ; OUT[p, 2] ; OUT[p, 0])", "IN[q]<v> ; IN[q]<w>") == {
        (True, (("v", 2), ("w", 3)))
    }
    spawned = text.replace(":;", "::")
    assert run(f"({spawned}) | (OUT[p, 1] ; Delay[1] ; OUT[p, 2] ; OUT[p, 0])", "IN[q]<v> ; IN[q]<w>") == {
        (True, (("v", 2), ("w", 3)))
    }
    (testing,) = [t for t in inside(following("IN[w]<v> :; b", until=0).root(1)) if hasattr(t, "condition")]
    assert testing.scope == ()


def test_n9_a_root_that_is_aborted_from_outside_ends_alone_and_lets_go_of_what_it_held() -> None:
    w = world()
    config = following("INHIBIT[t] ; ASSERT[s]", "ASSERT[s]", "WAIT[s]", until=1)
    after = killed(config, 1, w)
    assert after.root(1) == Ended(False)
    assert isinstance(after.root(1), Ended)
    assert after.root(1).cause == "cancelled"  # type: ignore[union-attr]
    assert isinstance(after.root(2), Await)
    assert not isinstance(after.root(3), Ended)
    assert after.store.inhibitions == ()
    assert [i.number for i in after.store.instances] == [2]
    assert killed(after, 2, w).root(3) == Ended(True)


def test_results_of_a_leaf_are_sorted_by_name() -> None:
    w = world()
    config = begun("SIT[s]<z, y>", "ASSERT[s, 5]", w=w)
    config = next(steps(config, w)).after
    config = next(steps(config, w)).after
    end = config.root(1)
    assert isinstance(end, Ended)
    assert end.bindings == (("y", 5), ("z", 1))


def test_n5_of_two_roots_the_first_is_decided_first_wherever_it_stands_in_it() -> None:
    assert released("(NIL & (IN[p]<x> # DRAIN[s]))", "((OUT[p, 1] # DRAIN[t]) & NIL)") == ["s", "t"]
    assert released("(NIL & (OUT[p, 1] # DRAIN[t]))", "((IN[p]<x> # DRAIN[s]) & NIL)") == ["t", "s"]


def test_n5_only_disablings_count_for_the_depth_of_a_disabling() -> None:
    assert released("(IN[p]<x> # DRAIN[s]) | (NIL & ((OUT[p, 1] # DRAIN[t]) | NIL))") == ["s", "t"]
    assert released("(NIL & ((IN[p]<x> # DRAIN[s]) | NIL)) | (OUT[p, 1] # DRAIN[t])") == ["s", "t"]
