"""Perception requests (ΔP, R §7.1): which sensing action could tell whether an unknown condition holds."""

from __future__ import annotations

from planner_reactor.logic.domain import Domain
from planner_reactor.logic.formulas import Atom, Bindings
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
