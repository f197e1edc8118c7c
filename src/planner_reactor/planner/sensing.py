"""Perception requests (ΔP, R §7.1): which sensing action could tell whether an unknown condition holds."""

from __future__ import annotations

from collections.abc import Iterable

from planner_reactor.link.messages import Perception
from planner_reactor.logic.domain import Domain
from planner_reactor.logic.formulas import Atom, Bindings
from planner_reactor.planner.beliefs import Beliefs
from planner_reactor.planner.model import Segment
from planner_reactor.planner.structure import Action


def observer_of(domain: Domain, atom: Atom) -> Action | None:
    """The first sensing action that needs nothing itself and has the ground atom as its effect."""
    for schema, effect in domain.producers.get(atom.predicate, ()):
        if not schema.senses or schema.executability or schema.outputs:
            continue
        bindings = Bindings()
        if bindings.unify(effect.atom.arguments, atom.arguments):
            arguments = tuple(bindings.walk(variable) for variable in schema.inputs)
            if not any(type(argument) is int for argument in arguments):
                return Action(schema.name, False, arguments)
    return None


def to_ask(domain: Domain, segments: Iterable[Segment], beliefs: Beliefs) -> dict[Atom, Action]:
    """What nobody knows, that plans would need, and that a sensing action could tell."""
    found = {}
    for segment in segments:
        for atom in (*segment.asked, *(segment.refinement.asked if segment.refinement else ())):
            action = observer_of(domain, atom)
            if action is not None and beliefs.known(atom) is None:
                found[atom] = action
    return found


def answer(perception: Perception) -> tuple[Atom, bool] | None:
    """What a perception request was answered: the condition, and whether it holds; None if it is no answer."""
    *arguments, verdict = perception.values or ("",)
    return (Atom(perception.subject, tuple(arguments)), verdict == "holds") if verdict in ("holds", "fails") else None
