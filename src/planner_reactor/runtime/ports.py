"""Ports and rendezvous: IN[p]<x> and OUT[p,v] (rule COM).

A write and a read meet pairwise, first come first served on both sides: at any time only one side waits. Those who
wait are linked through the strands themselves, so that one that is aborted leaves in constant time and an idle port
costs next to nothing.

A port can be shared by two executers on one scheduler (`Executer.share`): what waits there on one side meets what
comes on the other, and nothing else passes between the two.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from planner_reactor.rs.expressions import EvaluationError
from planner_reactor.rs.terms import Number, Symbol, Text, Value
from planner_reactor.runtime.leaves import Setting
from planner_reactor.runtime.outcomes import Label
from planner_reactor.runtime.strands import RUNNING, WAITING, Instruction, Strand

SWEEP_FROM = 1024


class Port:
    """The strands that wait at one port: all of them writers, or all of them readers."""

    __slots__ = ("first", "last", "name", "pinned", "writers")

    def __init__(self, name: Value) -> None:
        self.name = name
        self.first: Strand | None = None
        self.last: Strand | None = None
        self.writers = False
        self.pinned = False  # an instruction knows it

    def append(self, strand: Strand) -> None:
        strand.link = self
        strand.before = last = self.last
        if last is None:
            self.first = strand
        else:
            last.after = strand
        self.last = strand

    def serve(self, first: Strand) -> None:
        """The first of those who wait has met its partner."""
        self.first = after = first.after
        if after is None:
            self.last = None
        else:
            after.before = first.after = None
        first.link = None

    def waiting(self) -> Iterator[Strand]:
        """Those who wait, first come first."""
        strand = self.first
        while strand is not None:
            yield strand
            strand = strand.after

    def unlink(self, strand: Strand) -> None:
        before, after = strand.before, strand.after
        if before is None:
            self.first = after
        else:
            before.after = after
        if after is None:
            self.last = before
        else:
            after.before = before
        strand.before = strand.after = strand.link = None


class Ports:
    """All ports, by name (any value may name a port). Idle ones are swept away now and then."""

    __slots__ = ("_by_name", "_sweep_at")

    def __init__(self) -> None:
        self._by_name: dict[Value, Port] = {}
        self._sweep_at = SWEEP_FROM

    def named(self, name: Value) -> Port:
        if (port := self._by_name.get(name)) is None:
            if len(self._by_name) >= self._sweep_at:
                self._sweep()
            port = self._by_name[name] = Port(name)
        return port

    def _sweep(self) -> None:
        for idle in [n for n, p in self._by_name.items() if p.first is None and not p.pinned]:
            del self._by_name[idle]
        self._sweep_at = max(SWEEP_FROM, 2 * len(self._by_name))

    def share(self, name: Value) -> Port:
        """The port of this name, to be given to other executers."""
        port = self.named(name)
        port.pinned = True
        return port

    def adopt(self, ports: Mapping[str, Port]) -> None:
        """From now on these names mean ports of another executer. Before anything is compiled."""
        self._by_name.update(ports)

    def fixed(self, setting: Setting) -> Port | None:
        """The port of a call whose first argument is a constant."""
        if not isinstance(setting.terms[0], Symbol | Text | Number):
            return None
        port = self.named(setting.readers[0]([]))
        port.pinned = True
        return port

    def waiting(self) -> dict[Value, str]:
        """At which ports something waits, and which side of it."""
        return {n: "OUT" if p.writers else "IN" for n, p in self._by_name.items() if p.first is not None}


class Out:
    """OUT[p,v] writes v once a reader is there."""

    __slots__ = ("_name", "_port", "_value", "kernel", "ok", "ports", "setting", "where")
    silent = False
    resting = False

    def __init__(self, setting: Setting, ports: Ports) -> None:
        self.setting = setting
        self.kernel = setting.kernel
        self.ports = ports
        self.ok = setting.ok
        self.where = setting.where
        self._name, self._value = setting.readers
        self._port = ports.fixed(setting)

    def run(self, strand: Strand) -> Instruction | None:
        try:
            port = self._port or self.ports.named(self._name(strand.frame))
            value = self._value(strand.frame)
        except (EvaluationError, TypeError):
            return self.setting.failed.run(strand)
        reader = port.first
        if reader is None or port.writers:
            port.writers = True
            strand.pc = self
            strand.state = WAITING
            strand.value = value
            port.append(strand)
            return None
        port.serve(reader)
        leaf: In = reader.pc  # type: ignore[assignment]  # readers wait in an IN
        if leaf.target >= 0:
            reader.frame[leaf.target] = value
        return communicated(self, strand, reader, leaf, port.name, value)

    def port_of(self, strand: Strand) -> Port | None:
        """The port at which this strand would communicate; None if its name has no value."""
        try:
            return self._port or self.ports.named(self._name(strand.frame))
        except (EvaluationError, TypeError):
            return None

    def cancel(self, strand: Strand) -> None:
        strand.link.unlink(strand)


class In:
    """IN[p]<x> reads x once a writer is there."""

    __slots__ = ("_name", "_port", "kernel", "ok", "ports", "setting", "target", "where")
    silent = False
    resting = False

    def __init__(self, setting: Setting, ports: Ports) -> None:
        self.setting = setting
        self.kernel = setting.kernel
        self.ports = ports
        self.ok = setting.ok
        self.where = setting.where
        self.target = setting.targets[0] if setting.targets else -1
        (self._name,) = setting.readers
        self._port = ports.fixed(setting)

    def run(self, strand: Strand) -> Instruction | None:
        try:
            port = self._port or self.ports.named(self._name(strand.frame))
        except (EvaluationError, TypeError):
            return self.setting.failed.run(strand)
        writer = port.first
        if writer is None or not port.writers:
            port.writers = False
            strand.pc = self
            strand.state = WAITING
            port.append(strand)
            return None
        port.serve(writer)
        value, writer.value = writer.value, None
        if self.target >= 0:
            strand.frame[self.target] = value
        leaf: Out = writer.pc  # type: ignore[assignment]  # writers wait in an OUT
        return communicated(self, strand, writer, leaf, port.name, value)

    def port_of(self, strand: Strand) -> Port | None:
        """The port at which this strand would communicate; None if its name has no value."""
        try:
            return self._port or self.ports.named(self._name(strand.frame))
        except (EvaluationError, TypeError):
            return None

    def cancel(self, strand: Strand) -> None:
        strand.link.unlink(strand)


def communicated(
    own: In | Out, strand: Strand, partner: Strand, leaf: In | Out, name: Value, value: Value
) -> Instruction | None:
    """COM, a step of both: the partner is taken to its next leaf, then the one that came last goes on."""
    kernel = own.kernel
    if leaf.kernel is kernel:
        kernel.steps += 1
        kernel.rendezvous += 1
        if kernel.observer is not None:
            writer, reader = (own, leaf) if isinstance(own, Out) else (leaf, own)
            kernel.tell(("COM", (name, value), "ok", ()), writer.where.site, reader.where.site)
        partner.state = RUNNING
        kernel.advance(partner, leaf.ok)
        if kernel.watched:  # it may have come to its end
            kernel.moved(partner)
    else:
        _met_abroad(own, partner, leaf, name, value)
    if kernel.due:
        kernel.queue(strand, own.ok)
        return None
    return own.ok


def _met_abroad(own: In | Out, partner: Strand, leaf: In | Out, name: Value, value: Value) -> None:
    """COM between two executers: each sees its own side, and both have settled before anything else happens."""
    for side in (own, leaf):
        kernel = side.kernel
        kernel.steps += 1
        kernel.rendezvous += 1
        if kernel.observer is not None:
            wrote: Label = ("OUT", (name, value), "ok", ())
            read: Label = ("IN", (name,), "ok", (value,))
            kernel.tell(wrote if isinstance(side, Out) else read, side.where.site)
    abroad = leaf.kernel
    abroad.queue(partner, leaf.ok)
    abroad.settle()
    abroad.arm()
