"""Ports and rendezvous: IN[p]<x> and OUT[p,v] (rule COM).

A write and a read meet pairwise, first come first served on both sides: at any time only one side waits.
Those who wait are linked through the strands themselves, so that one that is aborted leaves in constant
time and an idle port costs next to nothing.
"""

from __future__ import annotations

from collections.abc import Hashable

from planner_reactor.rs.expressions import EvaluationError
from planner_reactor.rs.terms import Value
from planner_reactor.runtime.kernel import Kernel
from planner_reactor.runtime.leaves import Setting
from planner_reactor.runtime.strands import SILENT, WAITING, Instruction, Strand

SWEEP_FROM = 1024


class Port:
    """The strands that wait at one port: all of them writers, or all of them readers."""

    __slots__ = ("first", "last", "writers")

    def __init__(self) -> None:
        self.first: Strand | None = None
        self.last: Strand | None = None
        self.writers = False

    def append(self, strand: Strand) -> None:
        strand.link = self
        strand.before = last = self.last
        if last is None:
            self.first = strand
        else:
            last.after = strand
        self.last = strand

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
                self._by_name = {n: p for n, p in self._by_name.items() if p.first is not None}
                self._sweep_at = max(SWEEP_FROM, 2 * len(self._by_name))
            port = self._by_name[name] = Port()
        return port

    def waiting(self) -> dict[Value, str]:
        """At which ports something waits, and which side of it."""
        return {n: "OUT" if p.writers else "IN" for n, p in self._by_name.items() if p.first is not None}


class Out:
    """OUT[p,v] writes v once a reader is there."""

    __slots__ = ("arguments", "kernel", "ok", "ports", "setting", "site", "zone")
    silent = False
    resting = False

    def __init__(self, setting: Setting, ports: Ports) -> None:
        self.setting = setting
        self.kernel = setting.kernel
        self.ports = ports
        self.arguments = setting.arguments
        self.ok = setting.ok
        self.zone: int = setting.zone
        self.site: Hashable = setting.site

    def run(self, strand: Strand) -> Instruction | None:
        try:
            name, value = self.arguments(strand.frame)
            port = self.ports.named(name)
        except (EvaluationError, ValueError, TypeError):
            return self.setting.failed.run(strand)
        reader = port.first
        if reader is None or port.writers:
            port.writers = True
            strand.pc = self
            strand.state = WAITING
            strand.value = value
            port.append(strand)
            return None
        port.unlink(reader)
        leaf: In = reader.pc  # type: ignore[assignment]  # readers wait in an IN
        for slot in leaf.targets:
            reader.frame[slot] = value
        communicated(self.kernel, name, value)
        reader.pc = leaf.ok
        reader.state = SILENT
        strand.pc = self.ok
        strand.state = SILENT
        self.kernel.silent.extend((strand, reader))
        return None

    def cancel(self, strand: Strand) -> None:
        strand.link.unlink(strand)


class In:
    """IN[p]<x> reads x once a writer is there."""

    __slots__ = ("arguments", "kernel", "ok", "ports", "setting", "site", "targets", "zone")
    silent = False
    resting = False

    def __init__(self, setting: Setting, ports: Ports) -> None:
        self.setting = setting
        self.kernel = setting.kernel
        self.ports = ports
        self.arguments = setting.arguments
        self.targets = setting.targets[:1]
        self.ok = setting.ok
        self.zone: int = setting.zone
        self.site: Hashable = setting.site

    def run(self, strand: Strand) -> Instruction | None:
        try:
            (name,) = self.arguments(strand.frame)
            port = self.ports.named(name)
        except (EvaluationError, ValueError, TypeError):
            return self.setting.failed.run(strand)
        writer = port.first
        if writer is None or not port.writers:
            port.writers = False
            strand.pc = self
            strand.state = WAITING
            port.append(strand)
            return None
        port.unlink(writer)
        value, writer.value = writer.value, None
        for slot in self.targets:
            strand.frame[slot] = value
        communicated(self.kernel, name, value)
        leaf: Out = writer.pc  # type: ignore[assignment]  # writers wait in an OUT
        writer.pc = leaf.ok
        writer.state = SILENT
        strand.pc = self.ok
        strand.state = SILENT
        self.kernel.silent.extend((writer, strand))
        return None

    def cancel(self, strand: Strand) -> None:
        strand.link.unlink(strand)


def communicated(kernel: Kernel, name: Value, value: Value) -> None:
    kernel.steps += 1
    kernel.rendezvous += 1
    if kernel.observer is not None:
        kernel.observer(("COM", (name, value), "ok", ()))
