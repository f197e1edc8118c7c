"""Who has a resource when: no order takes more than there is, and of the orders that can be the shortest is taken."""

from __future__ import annotations

import random

import pytest

from planner_reactor.logic.allen import relations
from planner_reactor.logic.domain import ActionSchema, Demand, Duration
from planner_reactor.logic.formulas import Atom
from planner_reactor.logic.problems import Capacity, Lasts, Lies, Statement, Uses
from planner_reactor.logic.reader import read_domain
from planner_reactor.logic.solving import solve
from planner_reactor.planner import Planner
from planner_reactor.planner.plan import BEFORE, CONTAINS, Plan
from planner_reactor.planner.sharing import Sharing, share_out
from planner_reactor.planner.thinking import finish
from tests.planner.driving import Book, settle, texts

ARM = Atom("arm")


def plan_of(lasts: dict[str, float], uses: dict[str, dict[str, int]], orders: list[tuple[str, str]]) -> Plan:
    plan, names = Plan(), list(lasts)
    for name in names:
        demands = tuple(Demand(Atom(r), users[name]) for r, users in uses.items() if name in users)
        plan.add(ActionSchema(name, duration=Duration(lasts[name], lasts[name]), uses=demands))
    for first, second in orders:
        assert plan.order(names.index(first), names.index(second), BEFORE)
    return plan


def sharing(plan: Plan, capacity: dict[str, int]) -> Sharing:
    users: dict[Atom, dict[int, int]] = {}
    for step in plan.steps:
        for demand in step.schema.uses:
            users.setdefault(demand.resource, {})[step.number] = demand.amount
    return Sharing(plan, users, {Atom(name): amount for name, amount in capacity.items()})


def said(plan: Plan, capacity: dict[str, int], deadline: float) -> list[Statement]:
    """The same in the words of the logic."""
    found: list[Statement] = [Capacity(resource=name, amount=amount) for name, amount in capacity.items()]
    found.append(Lasts(interval="all", least=0, most=deadline))
    for step in plan.steps:
        assert step.schema.duration is not None
        found.append(Lasts(interval=step.number, least=step.schema.duration.least, most=step.schema.duration.most))
        found.append(Lies(first=step.number, relation=relations(["s", "d", "f", "e"]), second="all"))
        found += [Uses(interval=step.number, resource=d.resource.predicate, amount=d.amount) for d in step.schema.uses]
    return found + [Lies(first=a, relation=r, second=b) for a, b, r in plan.network.edges()]


def drawn(seed: int, steps: int) -> tuple[Plan, dict[str, int]]:
    rng = random.Random(seed)
    names = "abcdef"[:steps]
    capacity = {"arm": 1, "bench": rng.randrange(1, 3)}
    uses = {r: {n: rng.randrange(1, capacity[r] + 1) for n in names if rng.random() < 0.6} for r in capacity}
    orders = [(x, y) for n, x in enumerate(names) for y in names[n + 1 :] if rng.random() < 0.3]
    return plan_of({n: rng.randrange(1, 9) * 1e3 for n in names}, uses, orders), capacity


@pytest.mark.parametrize("seed", range(60))
def test_no_order_at_all_is_shorter_says_the_complete_search(seed: int) -> None:
    """With four steps every order of those that compete is tried; the logic finds none that is done sooner."""
    plan, capacity = drawn(seed, 4)
    shares = sharing(plan, capacity)
    schedule = finish(shares.best())
    assert schedule is not None
    assert schedule.makespan >= shares.bound
    assert solve(said(plan, capacity, schedule.makespan)).times is not None
    assert solve(said(plan, capacity, schedule.makespan - 1)).times is None
    turns = [Lies(first=a, relation=BEFORE, second=b) for a, b in schedule.turns]
    assert solve([*said(plan, capacity, schedule.makespan), *turns]).times is not None


@pytest.mark.parametrize("seed", range(40))
def test_whoever_follows_the_turns_never_takes_too_much(seed: int) -> None:
    """Each step as soon as the orders and the turns let it; nobody looks at resources any more."""
    plan, capacity = drawn(seed, 6)
    schedule = finish(sharing(plan, capacity).best())
    assert schedule is not None
    before = {s.number: [o.number for o in plan.steps if plan.is_before(o.number, s.number)] for s in plan.steps}
    for first, second in schedule.turns:
        before[second].append(first)
    starts: dict[int, float] = {}
    while len(starts) < len(plan.steps):
        for step in plan.steps:
            if step.number not in starts and all(n in starts for n in before[step.number]):
                ends = [starts[n] + plan.step(n).schema.duration.most for n in before[step.number]]  # type: ignore[union-attr]
                starts[step.number] = max(ends, default=0.0)
    for now in starts.values():
        taken = dict.fromkeys(capacity, 0)
        for step in plan.steps:
            assert step.schema.duration is not None
            if starts[step.number] <= now < starts[step.number] + step.schema.duration.most:
                for demand in step.schema.uses:
                    taken[demand.resource.predicate] += demand.amount
        assert all(taken[name] <= capacity[name] for name in capacity), taken


def test_what_most_waits_for_has_the_arm_first() -> None:
    """Loading the slow machine first takes 10 + 10 + 200 s less ten; in the order of the text it took ten longer."""
    lasts = {"load1": 10e3, "cut1": 100e3, "load2": 10e3, "cut2": 200e3}
    plan = plan_of(lasts, {"arm": {"load1": 1, "load2": 1}}, [("load1", "cut1"), ("load2", "cut2")])
    schedule = finish(sharing(plan, {"arm": 1}).best())
    assert schedule is not None
    assert (schedule.makespan, schedule.turns) == (210e3, ((2, 0),))


def test_sometimes_the_arm_had_better_wait() -> None:
    """The long job comes in a second. Whoever takes the short one first, because it is there, is done in 26, not 17."""
    lasts = {"short": 9e3, "comes": 1e3, "long": 2e3, "after": 14e3}
    plan = plan_of(lasts, {"arm": {"short": 1, "long": 1}}, [("comes", "long"), ("long", "after")])
    schedule = finish(sharing(plan, {"arm": 1}).best())
    assert schedule is not None
    assert schedule.makespan == 17e3


def test_what_lasts_through_another_cannot_share_its_arm() -> None:
    plan = plan_of({"hold": 1e3, "turn": 1e3}, {"arm": {"hold": 1, "turn": 1}}, [])
    assert plan.order(0, 1, CONTAINS)
    assert finish(sharing(plan, {"arm": 1}).best()) is None
    domain = read_domain(KIT)
    assert finish(share_out(domain, plan)) is False


KIT = """
atp_resource camera;
atp_resource arm;
atp_goal Kit Done(a) and Done(b) and Done(c);
atp_fact Thing(a);
atp_actionschema Clear <><>
    duration: 3000; uses: arm;
    effects: Clean(table);
endactionschema
atp_actionschema Find <k><x>
    duration: 2000; uses: camera;
    effects: Seen(k, x);
endactionschema
atp_actionschema Place <k, x><>
intervals i;
    duration: 3000; uses: arm;
    executability: Seen(k, x); Clean(table) @ i and ITL(i, encompasses, Place);
    effects: Done(k);
endactionschema
"""


def test_the_camera_looks_for_the_next_thing_while_the_arm_places_this_one() -> None:
    domain = read_domain(KIT)
    planner = Planner(domain, relax="none")
    settle(planner, Book(domain))
    assert texts(planner)["Kit"] == (
        "SIT[Kit]<k> :; (~((Find[a]<x1> & Clear) : (Place[a, x1] & Find[b]<x2>) : (Place[b, x2] & Find[c]<x3>) : "
        "Place[c, x3] : SUCCEED[Kit, k]) : FAIL[Kit, k])"
    )
    assert planner.forecast.of("Kit") == Duration(12e3, 12e3)


MACHINES = """
atp_resource arm;
atp_goal Parts Made(small) and Made(big);
atp_fact Blank(small) and Blank(big);
atp_actionschema Load <p><>
    duration: 10000; uses: arm;
    effects: Loaded(p);
endactionschema
atp_actionschema CutSmall <><>
    duration: 100000;
    executability: Loaded(small);
    effects: Made(small);
endactionschema
atp_actionschema CutBig <><>
    duration: 200000;
    executability: Loaded(big);
    effects: Made(big);
endactionschema
"""


def test_the_machine_that_takes_longest_is_loaded_first() -> None:
    """In the order of the text it took ten seconds more."""
    planner = Planner(read_domain(MACHINES), relax="none")
    settle(planner)
    assert "(~(Load[big] : (Load[small] : CutSmall & CutBig) : SUCCEED" in texts(planner)["Parts"]
    assert planner.forecast.of("Parts") == Duration(210e3, 210e3)


TWO = """
atp_resource arm;
atp_goal Both Done(a) and Done(b);
atp_fact Thing(a) and Thing(b);
atp_actionschema Do <x><>
    USED
    effects: Done(x);
    expansions: Done(x);
endactionschema
atp_actionschema Work <x><>
    duration: 1000 .. 3000;
    uses: arm;
    effects: Done(x);
endactionschema
"""


def test_two_branches_that_would_take_the_one_arm_at_once_are_told_or_take_turns() -> None:
    """What the plan of a sub-situation uses cannot be known before it is planned: its action says it, or the host sees
    to it.
    """
    at_once = Planner(read_domain(TWO.replace("USED", "")))
    in_turn = Planner(read_domain(TWO.replace("USED", "uses: arm;")))
    settle(at_once), settle(in_turn)
    assert "(REASSERT[DoA] & REASSERT[DoB])" in texts(at_once)["Both"]
    assert at_once.warnings == (
        "what goes on side by side in Both may take 2 of arm, and there is 1: the host must serve one after the "
        "other, or the actions say that they use it",
    )
    assert "REASSERT[DoA] : REASSERT[DoB]" in texts(in_turn)["Both"]
    assert in_turn.warnings == ()
    assert in_turn.forecast.of("Both") == Duration(2e3, 6e3)
