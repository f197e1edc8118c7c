"""Check on ports: a rendezvous needs two (X §4.1.2).

In a complete program a port that is read must be written somewhere and the reverse, or the process waits for
ever. What a definition is given from outside, or calculates, may be any port. Processes of a host that take a
port may do either, and a host may serve ports by itself: those are told to the check.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator

from planner_reactor.errors import Diagnostic
from planner_reactor.rs.linking import Linked, error
from planner_reactor.rs.uses import Sink, Uses
from planner_reactor.rs.vocabulary import BUILT_IN

READS: tuple[Sink, ...] = (("IN", 0),)
WRITES: tuple[Sink, ...] = (("OUT", 0), ("STREAM", 0))
SIDES = (
    (READS, WRITES, "read but never written", "writes"),
    (WRITES, READS, "written but never read", "reads"),
)


def check_ports(linked: Linked, used: Uses, served: Collection[str]) -> Iterator[Diagnostic]:
    """Errors "unserved-port"."""
    by_host = tuple(_ports_of_host(linked))
    either = {*served, *used.of(by_host)}
    for here, there, one_sided, lacking in SIDES:
        if used.open_sinks.intersection((*there, *by_host)):
            continue  # some port that only the run will tell may be served there
        ours, others = used.of(here), used.of(there)
        meant = [port for port in others if port not in ours]
        for port, place in ours.items():
            if port not in others and port not in either:
                hint = linked.nearest(port, meant) or f"nothing here {lacking} it"
                yield error(place, "unserved-port", f"port {port} is {one_sided}", hint)


def _ports_of_host(linked: Linked) -> Iterator[Sink]:
    for signature in linked.signatures.values():
        for position, kind in enumerate(signature.inputs):
            if kind == "port" and signature.name not in BUILT_IN:
                yield signature.name, position
