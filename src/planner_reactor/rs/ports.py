"""Check on ports: a rendezvous needs two (X §4.1.2).

In a complete program a port that is read must be written somewhere and the reverse, or the process waits for
ever. What a definition is given from outside, or calculates, may be any port. Processes of a host that take a
port may do either, and a host may serve ports by itself: those are told to the check.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator

from planner_reactor.errors import Diagnostic, nearest
from planner_reactor.rs.linking import Linked, error
from planner_reactor.rs.uses import Sink, Uses
from planner_reactor.rs.vocabulary import BUILT_IN

READS: tuple[Sink, ...] = (("IN", 0),)
WRITES: tuple[Sink, ...] = (("OUT", 0), ("STREAM", 0))


def check_ports(linked: Linked, used: Uses, served: Collection[str]) -> Iterator[Diagnostic]:
    """Errors "unserved-port"."""
    of_host = tuple(
        (signature.name, position)
        for signature in linked.signatures.values()
        for position, kind in enumerate(signature.inputs)
        if kind == "port" and signature.name not in BUILT_IN
    )
    either = {*served, *used.of(of_host)}
    if not used.open_sinks.intersection(of_host):
        yield from _one_sided(used, READS, WRITES, either, "read", "written")
        yield from _one_sided(used, WRITES, READS, either, "written", "read")


def _one_sided(
    used: Uses,
    here: tuple[Sink, ...],
    there: tuple[Sink, ...],
    either: Collection[str],
    is_: str,
    is_not: str,
) -> Iterator[Diagnostic]:
    ours, others = used.of(here), used.of(there)
    if used.open_sinks.intersection(there):
        return
    for name, place in ours.items():
        if name not in others and name not in either:
            meant = nearest(name, [port for port in others if port not in ours])
            hint = meant or f"nothing here {'writes' if is_not == 'written' else 'reads'} it"
            yield error(place, "unserved-port", f"port {name} is {is_} but never {is_not}", hint)
