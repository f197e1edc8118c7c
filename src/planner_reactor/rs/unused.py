"""What a program has but does not use: definitions that nothing calls, parameters that nothing reads.
Warnings only.

With `roots` given, every definition must be reachable from them. Without, a definition that no other calls is
taken for a root, unless it needs arguments or gives results while others need none.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator

from planner_reactor.errors import Diagnostic
from planner_reactor.rs.facts import names
from planner_reactor.rs.graphs import reachable
from planner_reactor.rs.linking import Linked, error, warning
from planner_reactor.rs.printer import show_head
from planner_reactor.rs.terms import Parameter


def check_unused(linked: Linked, roots: Collection[str]) -> Iterator[Diagnostic]:
    """Warnings "unreachable" and "unused-parameter"; error "unknown-process" for a root that is not there."""
    for root in roots:
        if not linked.clauses(root):
            hint = linked.nearest(root, linked.names)
            yield error(None, "unknown-process", f"unknown process {root}", hint)
    reached = reached_from(linked, roots) if roots else reachable(linked.calls, _plausible_roots(linked))
    for number, schema in enumerate(linked.schemas):
        if number not in reached and schema.name not in linked.families:
            message = f"nothing calls {show_head(schema)}"
            yield warning(schema.place, "unreachable", message, "remove it, or call it")
    for name in linked.names:
        yield from _parameters(linked, linked.clauses(name))


def reached_from(linked: Linked, roots: Collection[str]) -> Collection[int]:
    """The definitions that can be reached from these names; all, if there are none."""
    if not roots:
        return range(len(linked.schemas))
    return reachable(linked.calls, [number for root in roots for number in linked.clauses(root)])


def _plausible_roots(linked: Linked) -> list[int]:
    called = {t for number, targets in linked.calls.items() for t in targets if t != number}
    uncalled = [number for number in range(len(linked.schemas)) if number not in called]
    startable = [n for n in uncalled if not linked.schemas[n].parameters and not linked.schemas[n].results]
    below = reachable(linked.calls, uncalled)
    in_circles = [number for number in range(len(linked.schemas)) if number not in below]
    return (startable or uncalled) + in_circles


def _parameters(linked: Linked, clauses: list[int]) -> Iterator[Diagnostic]:
    """A parameter that one clause ignores may be what another is chosen by, or uses."""
    wanted: set[int] = set()
    for number in clauses:
        used = {name.name for call in linked.facts[number].calls for name in names(call.arguments)}
        for position, head in enumerate(linked.schemas[number].head):
            if not isinstance(head, Parameter) or head.name.startswith("_") or head.name in used:
                wanted.add(position)
    first = linked.schemas[clauses[0]]
    for position, head in enumerate(first.head):
        if isinstance(head, Parameter) and position not in wanted:
            message = f"parameter {head.name} of {first.name} is not used"
            yield warning(first.place, "unused-parameter", message, f"_{head.name} says that it is meant so")
