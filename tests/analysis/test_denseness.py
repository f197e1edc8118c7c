"""Denseness is read off what processes do (X §4.4, App. A), and what is read off is met by runs."""

from __future__ import annotations

from collections.abc import Sequence

import pytest
from msgspec.structs import replace

from planner_reactor.analysis.conditions import text
from planner_reactor.analysis.denseness import Denseness, Failure, dense, opened
from planner_reactor.analysis.durations import greatest, least, less, valued
from planner_reactor.analysis.equivalence import branching_bisimilar
from planner_reactor.analysis.offering import Local, Refusal, local
from planner_reactor.analysis.rounds import Rounds
from planner_reactor.errors import InputError
from planner_reactor.rs.configurations import Label, World
from planner_reactor.rs.loading import load
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.prelude import QUANTUM
from planner_reactor.rs.terms import Value
from planner_reactor.rs.unknowns import Unknown
from planner_reactor.rs.vocabulary import BUILT_IN
from planner_reactor.runtime import Scheduler, VirtualClock
from planner_reactor.workcell.environments.dynamics import host, model
from tests.analysis.timed_runs import ALIKE, Station, analysed, met, network, run

SOURCE = "T[v] = Term[gamma] ; ((STREAM[x, v] # Term[tau]) ; T[v])\n"
ST = "ST = (IN[x]<v> ; Delay[go]) :; (STREAM[y, v] # Delay[to])\n"
AT = "AT = (Delay[to] ; IN[x]<v> ; Delay[go]) :: (STREAM[y, v] # Delay[to])\n"
GIVEN = {"x": ("gi", "ti")}


def shown(source: str, process: str, port: str, supplied: dict[str, tuple[str, str]] | None = None) -> str:
    """`(γ, τ) form`, or why not."""
    inputs = {p: tuple(map(Unknown, pair)) for p, pair in (supplied or {}).items()}
    found = dense(opened(parse_program(source), host.signatures), parse_process(process), port, supplied=inputs)  # type: ignore[arg-type]
    if isinstance(found, Failure):
        return str(found)
    return f"({found.delay!r}, {found.resolution!r}) {found.form}"


def found(source: str, process: str, port: str) -> Denseness:
    answer = dense(opened(parse_program(source), host.signatures), process, port)
    assert isinstance(answer, Denseness), answer
    return answer


def test_definition_1_a_source_offers_again_and_again() -> None:
    assert shown(SOURCE, "T[0]", "x") == "(gamma, tau) Definition 1"


def test_a_source_is_known_by_what_it_does_however_it_is_written() -> None:
    loop = "T = Term[gamma] :; (STREAM[x, 1] # Term[tau])\n"
    parts = "T[v] = Quiet ; Loud[v]\nQuiet = Delay[a] ; Delay[b]\nLoud[v] = (Term[tau] # STREAM[x, v]) ; T[v + 1]\n"
    assert shown(loop, "T", "x") == "(gamma, tau) Definition 1"
    assert shown(parts, "T[0]", "x") == "(a + b, tau) Definition 1"


def test_definition_2_a_value_is_taken_and_then_offered() -> None:
    local = "T = IN[x]<v> : (Term[go] ; (STREAM[y, v] # Term[to])) ; T\n"
    assert shown(local, "T", "y", GIVEN) == "(gi + go, max(ti, to)) Definition 2"


def test_lemma_5_a_loop_is_of_the_form_of_definition_2() -> None:
    assert shown(ST, "ST", "y", GIVEN) == "(gi + go, max(ti, to)) Lemma 5"


def test_theorem_6_a_delay_keeps_the_reading_off_until_the_offer_has_ended() -> None:
    assert shown(AT, "AT", "y", GIVEN) == "(gi + go, max(ti, to)) Theorem 6"


def test_without_the_delay_of_theorem_6_old_and_new_are_offered_together() -> None:
    source = AT.replace("(Delay[to] ; IN[x]<v>", "(IN[x]<v>")
    answer = dense(opened(parse_program(source)), "AT", "y", supplied={"x": (0, 0)})
    assert isinstance(answer, Denseness)
    assert (repr(answer.delay), repr(answer.overlap)) == ("go", "max(-go + to, 0)")
    periodic = dense(opened(parse_program(AT)), "AT", "y", supplied={"x": (0, 0)})
    assert isinstance(periodic, Denseness)
    assert periodic.overlap == 0


def test_theorem_6_is_not_so_for_delays_that_are_upper_bounds() -> None:
    """The paper claims the non-periodic case for a more complex network; for AT itself the silence grows by τo."""
    assert shown(AT.replace("Delay", "Term"), "AT", "y", GIVEN) == "(gi + go + to, max(ti, to)) Theorem 6"


HANDSHAKE = (
    "HS = Rounds | OUT[go_on, 1]\n"
    "Rounds = (IN[go_on]<u> ; IN[x]<v> ; Term[0.02]) :: ((STREAM[y, v] # Term[0.03]) ; OUT[go_on, 1])\n"
)
BESIDE = (
    "Src = (STREAM[x, 1] # Delay[0.05]) ; (Delay[0.03] ; Src)\nRd = IN[y]<v> :; Delay[0.04]\n"
    "ST = (IN[x]<v> ; Delay[0.02]) :; (STREAM[y, v] # Delay[0.03])\n"
    "D2 = IN[x]<v> : (Delay[0.02] ; (STREAM[y, v] # Delay[0.03]) ; D2)\n"
    "AT = (Delay[0.03] ; IN[x]<v> ; Delay[0.02]) :: (STREAM[y, v] # Delay[0.03])\n"
    "Late = (Delay[0.035] ; IN[x]<v> ; Delay[0.02]) :: (STREAM[y, v] # Delay[0.03])\n"
    "STlate = Delay[0.035] ; ((IN[x]<v> ; Delay[0.02]) :; ((STREAM[y, v] # Delay[0.03]) ; Delay[0.005]))\n"
    "STterm = (IN[x]<v> ; Term[0.02]) :; (STREAM[y, v] # Term[0.03])\n"
    "Delayed = Delay[0.03] ; ST\n" + HANDSHAKE
)


def _unseen(label: Label) -> bool:
    return label[0] in ("Delay", "Term") or (label[0] == "COM" and label[1][0] == "go_on")


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        ("ST", "D2", True),  # Lemma 5
        ("AT", "Delayed", True),  # Theorem 6
        ("Late", "STlate", True),  # Theorem 6, the delay longer than the offer
        ("HS", "STterm", True),  # the non-periodic case: an answer keeps the reading off, not a delay
        ("AT", "ST", False),
        ("AT", "STterm", False),
    ],
)
def test_the_forms_are_the_same_to_whoever_sees_their_ports_and_the_time(one: str, other: str, same: bool) -> None:
    """Branching bisimilarity, delays hidden: nothing is argued, all states are looked at."""
    world = World(parse_program(BESIDE), BUILT_IN)
    sides = (parse_process(f"Src | {name} | Rd") for name in (one, other))
    assert branching_bisimilar(*sides, world, hidden=_unseen, limit=20_000) is same


def test_definition_3_delays_add_up_and_the_greater_resolution_stays() -> None:
    chain = SOURCE + ST + "Second = (IN[y]<v> ; Delay[g2]) :; (STREAM[z, v] # Delay[t2])\n"
    assert shown(chain, "T[0] | ST | Second", "z") == "(g2 + gamma + go, max(t2, tau, to)) Lemma 5"


def test_several_ports_side_by_side_wait_for_the_slowest_one_after_the_other_for_all() -> None:
    other = SOURCE.replace("T[v]", "U[v]").replace("[x", "[w").replace("gamma", "g2").replace("tau", "t2")
    both = SOURCE + other + "B = ((IN[x]<v> & IN[w]<u>) ; Delay[go]) :; (STREAM[y, v] # Delay[to])\n"
    assert shown(both, "T[0] | U[0] | B", "y") == "(go + max(g2, gamma), max(min(t2, tau), to)) Lemma 5"
    after = both.replace("(IN[x]<v> & IN[w]<u>)", "IN[x]<v> ; IN[w]<u>")
    assert shown(after, "T[0] | U[0] | B", "y").startswith("(g2 + gamma + go, ")


def test_a_value_that_waits_for_its_reader_is_held_as_long_as_the_reader_is_busy() -> None:
    text = SOURCE + "Once = IN[x]<v> :; OUT[y, v]\nR = (IN[y]<v> ; Delay[busy]) :; Delay[more]\n"
    assert shown(text, "T[0] | Once | R", "y") == "(gamma, max(busy + more, tau)) on demand"


@pytest.mark.parametrize(
    ("step", "trend", "change"),
    [
        ("v + 1", "increasing", "1"),
        ("v - mu", "decreasing", "-mu"),
        ("v", "constant", "0"),
    ],
)
def test_definition_4_a_source_increases_or_decreases(step: str, trend: str, change: str) -> None:
    answer = found(f"T[v] = Delay[g] ; (STREAM[x, v] # Delay[t]) ; T[{step}]\n", "T[0]", "x")
    assert (answer.trend, repr(answer.change)) == (trend, change)


def test_a_random_step_has_a_direction_if_its_range_has_one() -> None:
    source = "T[v] = Delay[g] ; (STREAM[x, v] # Delay[t]) ; (Ran[low, high]<d> : T[v + d])\n"
    for low, high, trend in ((0.1, 2, "increasing"), (-3, -0.5, "decreasing"), (-1, 1, "either")):
        world = opened(parse_program(source), given={"low": low, "high": high})
        answer = dense(world, "T[0]", "x")
        assert isinstance(answer, Denseness)
        assert (answer.trend, answer.most) == (trend, high if high > 0 else 3) or trend == "decreasing"


def test_definition_4_is_carried_through_what_transforms() -> None:
    base = "T[v] = Delay[g] ; (STREAM[x, v] # Delay[t]) ; T[v + 1]\n"
    for f, trend in (("v", "increasing"), ("3 * v", "increasing"), ("5 - v", "decreasing")):
        assert found(base + ST.replace("[y, v]", f"[y, {f}]"), "T[0] | ST", "y").trend == trend


def test_what_is_dense_only_under_a_condition_says_so() -> None:
    belt = found(model("belt"), "BeltObject[p]", "op")
    assert (text(belt.given), belt.trend) == ("p < nu", "increasing")
    assert text(found(model("tracking"), "TEM[p, a]", "pos").given) == "InView[p, a]"


def test_the_ports_of_the_tracking_environment() -> None:
    pos = found(model("tracking"), "TEM[p, a]", "pos")
    assert (repr(pos.delay), repr(pos.resolution), pos.form) == ("ts1", "max(t0, ts0)", "Theorem 6")
    assert (pos.cut_by, repr(pos.restart)) == (("angle",), "ts0 + ts1")
    assert [stage.process for stage in pos.stages] == ["Object", "Camera"]


@pytest.mark.parametrize(
    ("source", "process", "port", "said"),
    [
        (ST, "ST", "y", "x is not dense: the world outside does not write it: nobody writes it"),
        ("T = OUT[x, 1] : Delay[g]\n", "T", "x", "x is not dense: T writes it, and then ends or goes on without it"),
        ("T = Delay[g] : (OUT[x, 1] ; NIL)\n", "T", "x", "x is not dense: T writes it, and then ends"),
        (SOURCE + "U[v] = (STREAM[x, v] # Delay[t]) ; U[v]\n", "T[0] | U[0]", "x", "T, U all write it"),
        ("A = IN[x]<v> :; (STREAM[y, v] # Delay[t])\nB = IN[y]<v> :; (STREAM[x, v] # Delay[t])\n", "A | B", "y",
         "waits for itself"),
        ("T = ((IN[a]<u> ; IN[b]<v>) | (Delay[t] ; Delay[s])) :; (STREAM[y, 1] # Delay[t])\n", "T", "y",
         "its parts do more than one thing side by side"),
    ],
)  # fmt: skip
def test_what_is_not_dense_is_told_with_the_process_and_the_reason(
    source: str, process: str, port: str, said: str
) -> None:
    assert said in shown(source, process, port)


def test_a_port_that_nobody_uses_is_an_error_with_the_nearest_name() -> None:
    with pytest.raises(InputError, match=r"no component uses port poss, did you mean pos\?"):
        dense(parse_program(model("tracking")), "TEM[p, a]", "poss")


@pytest.mark.parametrize("first", range(0, 1_000, 250))
def test_a_thousand_random_runs_keep_to_the_bounds(first: int) -> None:
    """`python -m tests.analysis.timed_runs` does it for 100,000 (docs/dynamics.md)."""
    runs = [run(seed) for seed in range(first, first + 250)]
    assert [r.text for r in runs if not r.holds] == []
    assert sum(r.read for r in runs) > 1_000


def test_the_bounds_are_hardly_wider_than_they_must_be() -> None:
    """So that a bound which forgets a delay would be met, and passed, by some run."""
    runs = [run(ALIKE * number) for number in range(100)]
    assert max(r.waited / r.delay for r in runs if r.delay > 0.1) > 0.9
    assert max(r.oldest / r.age for r in runs if r.age > 0.1) > 0.8


@pytest.mark.parametrize("forgotten", ["delay", "lag"])
def test_a_bound_that_forgets_a_delay_is_passed_by_runs(forgotten: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The defect is put in on purpose: then the runs have to find it."""

    def forgetful(port: Value, rounds: Sequence[Rounds]) -> Local | Refusal:
        answer = local(port, rounds)
        return replace(answer, **{forgotten: 0}) if isinstance(answer, Local) else answer

    monkeypatch.setattr("planner_reactor.analysis.denseness.local", forgetful)
    analysed.cache_clear()
    wrong = [r for r in (run(ALIKE * number) for number in range(50)) if not r.holds]
    analysed.cache_clear()
    assert len(wrong) > 3


SLOW_CHAIN = """
Source[v] = Delay[0.02] ; ((STREAM[x, v] # Delay[0.02]) ; (Ended[v] ; Source[v + 1]))
First = (IN[x]<v> ; Delay[0.1]) :; (STREAM[y, v] # Delay[0.5])
Second = (IN[y]<v> ; Delay[0.1]) :; (STREAM[z, v] # Delay[0.33])
Reader = ((Delay[0] : Ready) : IN[z]<v> : Got[v]) :; Term[0.05]
Net = Source[0] | First | Second | Reader
"""


def test_the_period_of_definition_3_is_no_bound_on_how_old_a_value_is() -> None:
    """γ + max(τi, τo) is 0.72 s here; values are older, since resolutions add up in their age."""
    signatures = Station(Scheduler(VirtualClock())).host.signatures
    program = load(SLOW_CHAIN, signatures=signatures)
    found = dense(opened(program, signatures), "Net", "z")
    assert isinstance(found, Denseness)
    oldest = max(met(program, seed, 20.0).oldest for seed in range(5))
    assert found.period == pytest.approx(0.72)
    assert found.period + 0.1 < oldest <= found.age + 3 * QUANTUM
    assert found.age == pytest.approx(1.03)


def test_random_networks_have_all_shapes() -> None:
    from random import Random

    shapes = {shape for seed in range(200) for shape in network(Random(seed))[1].split()}
    assert shapes >= {"source", "ST", "AT", "both", "then", "until"}


def test_durations_choose_where_order_is_certain() -> None:
    a, b = Unknown("a"), Unknown("b")
    assert greatest(a, a + b, 0) == a + b
    assert least(a, a + b) == a
    assert repr(greatest(a, b, 0)) == "max(a, b)"
    assert (less(a, a + b), less(a, a), less(a, b)) == (True, False, None)
    assert valued(greatest(a, b) + 1, {"a": 2, "b": 5}) == 6


def test_lemma_5_as_printed_asks_for_the_wrong_port() -> None:
    """The lemma says "if y is dense then x is"; but x is what the network takes, and y what it makes of it."""
    assert "nobody writes it" in shown(ST, "ST", "x", {"y": ("gi", "ti")})
    assert shown(ST, "ST", "y", GIVEN).startswith("(gi + go")
