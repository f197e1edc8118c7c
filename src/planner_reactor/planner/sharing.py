"""Resources: of steps that together would take too much, not all can go on at once (R §7.1, resource use).

Steps of one plan that share a resource are ordered so that no more than its capacity is ever taken, in the order in
which they stand otherwise: what uses other resources, or none, goes on meanwhile. What an abstract action takes is
taken by the basic ones of its own plan, when they run; between situations the host serves one after the other.
"""

from __future__ import annotations

from planner_reactor.logic.domain import Domain
from planner_reactor.logic.formulas import Atom
from planner_reactor.planner.plan import BEFORE, Plan, Step


def share_out(domain: Domain, plan: Plan) -> bool:
    """Order the steps that share resources; False if they cannot be."""
    claims: dict[Atom, list[tuple[Step, int]]] = {}
    for step in plan.steps:
        for demand in step.schema.uses:
            resource = plan.bindings.ground(demand.resource.shifted(step.offset))
            claims.setdefault(resource, []).append((step, demand.amount))
    return all(_in_turns(plan, users, domain.resources[r.predicate].capacity) for r, users in claims.items())


def _in_turns(plan: Plan, users: list[tuple[Step, int]], capacity: int) -> bool:
    if sum(amount for _, amount in users) <= capacity:
        return True
    place = {step.number: _early(plan, step, users) for step, _ in users}
    queue = sorted(users, key=lambda user: (place[user[0].number], user[0].number))
    for n, (step, amount) in enumerate(queue):
        left = capacity - amount
        for other, taken in reversed(queue[:n]):
            if plan.is_before(other.number, step.number):
                continue
            left -= taken
            if left < 0 and not plan.order(other.number, step.number, BEFORE):
                return False
    return True


def _early(plan: Plan, step: Step, users: list[tuple[Step, int]]) -> int:
    """How many of the others must come before it."""
    return sum(plan.is_before(other.number, step.number) for other, _ in users)
