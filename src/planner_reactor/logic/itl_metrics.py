"""What a domain says in numbers: how much there is of a resource, how long an action lasts and what it uses meanwhile.

Errors: a resource that does not exist or stands with other parameters than declared, one of which an action takes more
than there is, a duration that ends before it begins.
"""

from __future__ import annotations

from collections.abc import Iterable

from planner_reactor.errors import Diagnostic, nearest
from planner_reactor.logic.domain import Demand, Duration, Resource
from planner_reactor.logic.formulas import Atom
from planner_reactor.logic.itl_nodes import DemandNode, Name, ResourceNode, SchemaNode, Sentence
from planner_reactor.logic.itl_tokens import Source
from planner_reactor.logic.scope import Scope


class Metrics:
    """The resources of a domain, and what its schemas say of them; findings go to `wrong`."""

    def __init__(self, source: Source, wrong: list[Diagnostic], sentences: Iterable[Sentence]) -> None:
        self._source = source
        self._wrong = wrong
        self.resources: dict[str, Resource] = {}
        for node in sentences:
            if isinstance(node, ResourceNode):
                self.resources.setdefault(node.name.text, self._resource(node))

    def duration(self, node: SchemaNode) -> Duration | None:
        """How long an action may last, if it says so."""
        if node.duration is None:
            return None
        least, most = (float(name.text) for name in node.duration)
        if most < least or not most:
            hint = "expected at most as much as after .." if most < least else "expected more than 0"
            self._error(node.duration[0], "empty-duration", f"a duration of {least:g} .. {most:g} ms", hint)
        return Duration(least, most)

    def uses(self, node: SchemaNode, scope: Scope) -> tuple[Demand, ...]:
        """What an action takes; nothing twice."""
        found: dict[Atom, Demand] = {}
        for demand in node.uses:
            resource = self.resources.get(demand.resource.text)
            if resource is None:
                hint = nearest(demand.resource.text, self.resources)
                hint = hint or f"known: {', '.join(self.resources) or 'none, atp_resource declares one'}"
                self._error(demand.resource, "unknown-resource", f"{demand.resource.text} is not a resource", hint)
                continue
            atom = Atom(resource.name, tuple(map(scope.term, demand.arguments)))
            amount = (found[atom].amount if atom in found else 0) + self._amount(demand, resource)
            if amount > resource.capacity:
                message = f"{node.name.text} uses {amount} of {atom_text(demand)}"
                self._error(demand.resource, "over-capacity", message, f"there is {resource.capacity} of it")
            found[atom] = Demand(atom, amount)
        return tuple(found.values())

    def _resource(self, node: ResourceNode) -> Resource:
        capacity = self._whole(node.capacity)
        return Resource(node.name.text, len(node.parameters), capacity, self._source.place(node.name.offset))

    def _amount(self, node: DemandNode, resource: Resource) -> int:
        if len(node.arguments) != resource.parameters:
            message = f"{resource.name} with {len(node.arguments)} arguments"
            self._error(node.resource, "arity", message, f"expected {resource.parameters}, as the resource declares")
        return self._whole(node.amount)

    def _whole(self, name: Name | None) -> int:
        if name is None:
            return 1
        if "." in name.text or int(name.text) == 0:
            self._error(name, "not-whole", f"{name.text} of a resource", "expected a whole number above 0")
            return 1
        return int(name.text)

    def _error(self, where: Name, code: str, message: str, hint: str) -> None:
        self._wrong.append(self._source.diagnostic(where.offset, code, message, hint))


def atom_text(node: DemandNode) -> str:
    """`slots(t)`, as it stands in the text."""
    return node.resource.text + (f"({', '.join(n.text for n in node.arguments)})" if node.arguments else "")
