"""The complete search: its verdicts are those of brute force, its worlds hold, its cores contradict."""

from __future__ import annotations

import os
import random
from itertools import combinations

import pytest

from planner_reactor.errors import BudgetError
from planner_reactor.logic.allen import BASES, BIT, inverse, relations
from planner_reactor.logic.network import Network
from planner_reactor.logic.problems import Apart, Capacity, Lasts, Lies, Statement, Uses
from planner_reactor.logic.solving import Answer, closure, solve
from tests.logic import worlds
from tests.logic.worlds import Relations, fitting, relation_of

NETWORKS = int(os.environ.get("NETWORKS", "2500"))


def lies(network: Relations) -> list[Statement]:
    return [Lies(first=i, relation=relation, second=j) for (i, j), relation in network.items()]


def holds(network: Relations, answer: Answer) -> bool:
    assert answer.times is not None
    spans = {i: (int(a), int(b)) for i, (a, b) in answer.times.items()}
    return all(relation & BIT[relation_of(spans[i], spans[j])] for (i, j), relation in network.items())


def check(network: Relations) -> bool:
    """One network against brute force; True if it is consistent."""
    answer = solve(lies(network), range(4))
    consistent = fitting(network) != 0
    assert (answer.times is not None) == consistent, network
    if consistent:
        assert holds(network, answer)
    else:
        assert not fitting({pair: network[pair] for pair in (list(network)[n] for n in answer.core)})
    return consistent


@pytest.mark.timeout(600 if NETWORKS > 5000 else 20)
@pytest.mark.parametrize("kind", ["sizes", "half", "hard", "planted", "sparse"])
def test_the_verdict_is_that_of_brute_force_over_end_points(kind: str) -> None:
    """Random networks of uniform and of hard relations, through the phase transition, and consistent ones."""
    rng = random.Random(kind)
    verdicts = []
    for n in range(NETWORKS // 5):
        at = n % 4
        network = {
            "sizes": lambda at=at: worlds.uniform(rng, (2.0, 2.6, 3.2, 4.5)[at]),
            "half": lambda: worlds.uniform(rng, 6.5),
            "hard": lambda at=at: worlds.hard(rng, (13, 2, 3, 3)[at]),
            "planted": lambda: worlds.planted(rng, 2.5),
            "sparse": lambda: worlds.uniform(rng, 2.2, 0.9),
        }[kind]()
        verdicts.append(check(network))
    if kind in ("sizes", "hard", "sparse"):
        assert 0.1 < sum(verdicts) / len(verdicts) < 0.9


def weak_networks(count: int) -> list[Relations]:
    """Networks that are path-consistent and that no world satisfies, found by a walk from a known one."""
    start = ("m di", "o", "s fi", "o f", "oi s", "di f")
    here: Relations = dict(zip(worlds.PAIRS, (relations(text.split()) for text in start), strict=True))
    rng = random.Random(7)
    found: dict[tuple[int, ...], Relations] = {}
    while len(found) < count:
        changed = dict(here)
        pair = rng.choice(worlds.PAIRS)
        changed[pair] ^= BIT[rng.choice(BASES)]
        network = Network()
        if (
            changed[pair]
            and network.extend((i, j, relation) for (i, j), relation in changed.items())
            and not fitting(changed)
        ):
            here = changed
            found[tuple(here.values())] = here
    return list(found.values())


def test_what_path_consistency_accepts_in_error_is_refused() -> None:
    for network in weak_networks(150):
        answer = solve(lies(network))
        assert answer.times is None
        assert answer.guesses > 0
        assert not fitting({pair: network[pair] for pair in (worlds.PAIRS[n] for n in answer.core)})


def test_a_larger_network_has_a_world_that_holds() -> None:
    """60 intervals with 6.5 neighbours: about a third of the relations have to be split."""
    rng = random.Random(3)
    network = {pair: worlds.one(rng, 6.5) for pair in combinations(range(60), 2) if rng.random() < 0.11}
    answer = solve(lies(network), range(60))
    assert holds(network, answer)
    assert 0 < answer.guesses < 200


def test_an_inconsistent_larger_network_is_refused_with_a_core_that_contradicts() -> None:
    rng = random.Random(5)
    network = {pair: worlds.one(rng, 6.5) for pair in combinations(range(40), 2) if rng.random() < 0.3}
    said = lies(network)
    answer = solve(said)
    assert answer.times is None
    assert len(answer.core) < len(said)
    assert solve([said[n] for n in answer.core]).times is None


def test_the_budget_is_kept() -> None:
    with pytest.raises(BudgetError, match="within 1 guesses"):
        solve(lies(weak_networks(1)[0]), limit=1)


def test_an_interval_lies_to_itself_as_equal() -> None:
    assert solve([Lies(first="i", relation=BIT["b"], second="i")]).core == (0,)
    assert solve([Lies(first="i", relation=BIT["b"] | BIT["e"], second="i")]).times == {"i": (0, 1)}


# ------------------------------------------------------------------------------------------------- resources


def peak(spans: worlds.Spans, amounts: list[int]) -> int:
    return max(sum(a for (s, e), a in zip(spans, amounts, strict=True) if s <= t < e) for t in range(8))


def test_resources_are_shared_as_brute_force_says() -> None:
    rng = random.Random(11)
    verdicts = []
    for _ in range(150):
        network = worlds.uniform(rng, 2.8)
        amounts = [rng.randint(1, 2) for _ in range(4)]
        capacity = rng.randint(2, 4)
        said = [*lies(network), Capacity(resource="arm", amount=capacity)]
        said += [Uses(interval=i, resource="arm", amount=amount) for i, amount in enumerate(amounts)]
        bits = fitting(network)
        truth = any(
            bits >> n & 1 and peak(world, amounts) <= capacity for n, world in enumerate(worlds.scenarios()[0]) if bits
        )
        answer = solve(said)
        assert (answer.times is not None) == truth
        if answer.times is not None:
            spans = tuple((int(answer.times[i][0]), int(answer.times[i][1])) for i in range(4))
            assert peak(spans, amounts) <= capacity
        verdicts.append(truth)
    assert 20 < sum(verdicts) < 130


def test_one_arm_serves_one_at_a_time_and_two_cameras_two() -> None:
    said: list[Statement] = [Capacity(resource="arm", amount=1)]
    said += [Uses(interval=i, resource="arm") for i in range(5)]
    said += [Uses(interval=i, resource="camera") for i in range(5, 10)] + [Capacity(resource="camera", amount=2)]
    times = solve(said).times
    assert times is not None
    for i, j in combinations(range(5), 2):
        assert times[i][1] <= times[j][0] or times[j][1] <= times[i][0]
    assert all(sum(times[i][0] <= at < times[i][1] for i in range(5, 10)) <= 2 for at in range(20))


# ------------------------------------------------------------------------------------------------- durations


def lies_text(first: str, names: str, second: str) -> Lies:
    return Lies(first=first, relation=relations(names.split()), second=second)


def test_what_is_longer_does_not_fit_into_what_is_shorter() -> None:
    said = [Lasts(interval="i", least=5, most=6), Lasts(interval="j", least=2, most=4), lies_text("i", "d s f e", "j")]
    assert solve(said).core == (0, 1, 2)
    times = solve([said[0], said[1], lies_text("i", "d s f e di", "j")]).times
    assert times is not None
    assert times["i"][0] < times["j"][0] < times["j"][1] < times["i"][1]


def test_durations_decide_what_relations_leave_open() -> None:
    """Three tasks of 4 s for one arm do not fit into 11 s, but into 12."""
    said: list[Statement] = [Capacity(resource="arm", amount=1)]
    for i in "abc":
        said += [Lasts(interval=i, least=4000, most=4000), Uses(interval=i, resource="arm")]
        said += [lies_text(i, "d s f", "day")]
    assert solve([*said, Lasts(interval="day", least=0, most=11_999.999)]).times is None
    times = solve([*said, Lasts(interval="day", least=0, most=12_000)]).times
    assert times is not None
    assert sorted(times[i][0] for i in "abc") == pytest.approx([0, 4000, 8000])


Gap = tuple[int, int, int, int]


def brute_force_metric(network: Relations, lengths: list[tuple[int, int]], gaps: list[Gap]) -> bool:
    """Is there an order of the six end points that suits the relations and that times can have?"""
    bounds = [(2 * i, 2 * i + 1, least, most) for i, (least, most) in enumerate(lengths)] + gaps
    return any(
        all(relation & BIT[relation_of(order[i], order[j])] for (i, j), relation in network.items())
        and has_times([point for span in order for point in span], bounds)
        for order in worlds.of_three()
    )


def has_times(order: list[int], bounds: list[Gap]) -> bool:
    """Bellman and Ford on pairs (length, minus the number of strict comparisons)."""
    edges = [(p, q, (most, 0)) for p, q, _, most in bounds] + [(q, p, (-least, 0)) for p, q, least, _ in bounds]
    for p in range(6):
        for q in range(6):
            if p != q and order[p] <= order[q]:
                edges.append((q, p, (0, -int(order[p] < order[q]))))
    far = [(0, 0)] * 6
    for _ in range(7):
        before = list(far)
        for p, q, (length, strict) in edges:
            far[q] = min(far[q], (far[p][0] + length, far[p][1] + strict))
        if far == before:
            return True
    return False


def test_metric_verdicts_are_those_of_brute_force() -> None:
    rng = random.Random(13)
    verdicts = []
    for _ in range(150):
        network = {p: r for p, r in worlds.uniform(rng, 3.0).items() if p[1] < 3}
        lengths = [rng.choice([(0, 7), (7, 7), (7, 14)]) for _ in range(3)]
        gaps = [(rng.choice((0, 1)), rng.choice((2, 3, 4, 5)), -7, rng.choice((0, 7)))]
        said = [*lies(network)]
        said += [Lasts(interval=i, least=least, most=most) for i, (least, most) in enumerate(lengths)]
        said += [
            Apart(first=(p >> 1, p & 1), second=(q >> 1, q & 1), least=least, most=most) for p, q, least, most in gaps
        ]
        truth = brute_force_metric(network, lengths, gaps)
        answer = solve(said)
        assert (answer.times is not None) == truth
        if answer.times is None:
            assert solve([said[n] for n in answer.core]).times is None
        verdicts.append(truth)
    assert 30 < sum(verdicts) < 120


def test_before_leaves_a_gap_however_small() -> None:
    """Between a and c there are 7 s, and x lasts 7 s: it meets both, and is not before or after them."""
    gap = Apart(first=("a", 1), second=("c", 0), least=7000, most=7000)
    lasts = Lasts(interval="x", least=7000, most=7000)
    assert solve([gap, lasts, lies_text("a", "m", "x"), lies_text("x", "m", "c")]).times is not None
    assert solve([gap, lasts, lies_text("a", "b", "x"), lies_text("x", "b m", "c")]).core == (0, 1, 2, 3)


def test_what_durations_rule_out_is_known_by_propagation() -> None:
    lasting = [Lasts(interval="i", least=5, most=6), Lasts(interval="j", least=2, most=4)]
    said = [*lasting, lies_text("i", "d s di e b", "j")]
    assert closure(said) == [("i", relations(["di", "b"]), "j")]
    assert closure([*said, lies_text("j", "di si e", "i")]) is None


def test_what_relations_say_bounds_durations() -> None:
    """A task within another is no longer than it, and with what precedes it there it is shorter."""
    said: list[Statement] = [lies_text("i", "d", "day"), lies_text("j", "d", "day"), lies_text("i", "b m", "j")]
    said += [Lasts(interval="i", least=3, most=None), Lasts(interval="j", least=4, most=None)]
    assert solve([*said, Lasts(interval="day", least=0, most=7)]).core == (0, 1, 2, 3, 4, 5)
    assert solve([*said, Lasts(interval="day", least=0, most=7.001)]).times is not None


def test_inverse_statements_say_the_same() -> None:
    one = solve([Lies(first="i", relation=BIT["m"], second="j")]).times
    other = solve([Lies(first="j", relation=inverse(BIT["m"]), second="i")], ["i"]).times
    assert one == other
