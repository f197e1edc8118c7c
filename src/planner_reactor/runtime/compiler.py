"""Terms compiled to linked instructions.

A process is compiled from its end: given where to go on when it stops (`ok`) and when it aborts (`ab`), the
compiler returns where it begins. So `;` compiles its left part with both exits on the right part's
beginning, `:` only its stop, `~` swaps them, and none of these leaves an instruction behind.

Each name that is bound has a slot of the frame. Names are bound within *regions*: a definition's body, the
body of a loop (its bindings are hidden), each part of a `#` (only the winner's leave). Rounds forget the
slots of their loop.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass

from planner_reactor.rs.terms import (
    All,
    Call,
    Cond,
    Disable,
    If,
    Loop,
    Not,
    Par,
    Parameter,
    Process,
    Schema,
    Seq,
    Spawn,
    Value,
)
from planner_reactor.rs.vocabulary import BUILT_IN
from planner_reactor.runtime import forks, instructions
from planner_reactor.runtime.built_in import LEAVES
from planner_reactor.runtime.definitions import Code, Definitions, blank
from planner_reactor.runtime.kernel import Kernel
from planner_reactor.runtime.leaves import Mistake, Setting, Use
from planner_reactor.runtime.outcomes import Control, Guards
from planner_reactor.runtime.ports import Ports
from planner_reactor.runtime.regions import Region, exported
from planner_reactor.runtime.strands import OUTSIDE, SENSING, SERVING, Frame, Instruction
from planner_reactor.runtime.values import Functions, tuples


@dataclass(frozen=True, slots=True)
class Exits:
    """Where a process goes on."""

    ok: Instruction
    ab: Instruction


class Compiler:
    """Compiles for one executer."""

    def __init__(self, kernel: Kernel, controls: Mapping[str, Control], functions: Functions) -> None:
        self.kernel = kernel
        self.controls = controls
        self.functions = functions
        self.ports = Ports()
        self.definitions = Definitions(self.schema)
        self.part = _ends(
            forks.PartEnd(kernel, ok=True, settles=True), forks.PartEnd(kernel, ok=False, settles=False)
        )
        self.share = _ends(
            forks.PartEnd(kernel, ok=True, settles=False), forks.PartEnd(kernel, ok=False, settles=True)
        )
        self.rival = _ends(forks.RivalEnd(kernel, ok=True), forks.RivalEnd(kernel, ok=False))
        self.spawned = _ends(forks.BodyEnd(kernel, ok=True), forks.BodyEnd(kernel, ok=False))
        self.head = forks.HeadEnd(kernel)

    def schema(self, schema: Schema, exporting: bool) -> Code:
        """The body of a definition. Without its results, a call at its very end is a tail call (N6)."""
        region = Region()
        for position, part in enumerate(schema.head):
            region.bind(part.name if isinstance(part, Parameter) else f"[{position}]")
        region.declare(schema.body)
        results = tuple(region.slot(name) for name in schema.results) if exporting else ()
        exits = Exits(instructions.Return(results, ok=True), instructions.Return(results, ok=False))
        body = _Body(self, _title(schema), tail=None if exporting else exits)
        entry = body.process(schema.body, region, exits, OUTSIDE)
        return Code(entry, blank(region.size - len(schema.head)))

    def root(self, name: str, process: Process, bound: Mapping[str, Value]) -> tuple[Instruction, Frame]:
        """A process on its own: where it begins, and its frame. Its results are all that leave it."""
        region = Region()
        for variable in bound:
            region.bind(variable)
        region.declare(process)
        names = tuple((n, region.slot(n)) for n in exported(process))
        exits = Exits(
            instructions.RootEnd(self.kernel, names, ok=True),
            instructions.RootEnd(self.kernel, names, ok=False),
        )
        entry = _Body(self, name, tail=None).process(process, region, exits, OUTSIDE)
        return entry, [*bound.values(), *blank(region.size - len(bound))]


class _Body:
    """The compilation of one definition's body, or of one root."""

    def __init__(self, compiler: Compiler, name: str, *, tail: Exits | None) -> None:
        self.compiler = compiler
        self.kernel = compiler.kernel
        self.name = name
        self.tail = tail
        self.calls = 0

    def process(self, term: Process, region: Region, exits: Exits, zone: int) -> Instruction:
        match term:
            case Call():
                return self.call(term, region, exits, zone)
            case Seq(parts):
                return self.chain(parts, region, exits, zone, on_abort=True)
            case Cond(parts):
                return self.chain(parts, region, exits, zone, on_abort=False)
            case Not(body):
                return self.process(body, region, Exits(instructions.Fail(exits.ab), exits.ok), zone)
            case If(test, then, otherwise):
                branches = [self.process(p, region, exits, zone) for p in (then, otherwise)]
                return self.process(test, region, Exits(*branches), zone)
            case Par(parts):
                return self.fork(parts, region, exits, zone, self.compiler.part, first=False)
            case All(parts):
                return self.fork(parts, region, exits, zone, self.compiler.share, first=True)
            case Disable(parts):
                return self.rivals(parts, region, exits, zone)
            case Loop():
                return self.loop(term, region, exits, zone)
            case Spawn():
                return self.spawn(term, region, exits, zone)

    def chain(
        self, parts: tuple[Process, ...], region: Region, exits: Exits, zone: int, *, on_abort: bool
    ) -> Instruction:
        """`;` (N1: goes on after stop and abort) and `:` (N2: after stop). A SIT opens a body to the
        chain's end.
        """
        last = len(parts) - 1
        opener = next((i for i, p in enumerate(parts[:last]) if self.opens(p)), None)
        if opener is None:
            entry = self.process(parts[last], region, exits, zone)
            before = last
        else:
            slot = region.new_slot()
            inner = self.closing(slot, exits)
            rest = self.chain(parts[opener + 1 :], region, inner, zone, on_abort=on_abort)
            entry = self.opening(
                parts[opener], region, Exits(rest, rest if on_abort else exits.ab), zone, slot, inner
            )
            before = opener
        for part in reversed(parts[:before]):
            entry = self.process(part, region, Exits(entry, entry if on_abort else exits.ab), zone)
        return entry

    # -- bodies that a SIT opens

    def opens(self, term: Process) -> bool:
        """Is this a direct call of a control that opens a body for what follows it?"""
        control = self.compiler.controls.get(term.name) if isinstance(term, Call) else None
        return control is not None and control.opens_body

    def closing(self, slot: int, exits: Exits) -> Exits:
        return Exits(
            instructions.CloseBody(self.kernel, slot, exits.ok, ok=True),
            instructions.CloseBody(self.kernel, slot, exits.ab, ok=False),
        )

    def opening(
        self, term: Process, region: Region, exits: Exits, zone: int, slot: int, closing: Exits | None
    ) -> Instruction:
        """The control itself; `closing` is None if the body is for a spawned strand."""
        leaf = self.process(term, region, exits, zone)
        if isinstance(leaf, Use):
            leaf.slot = slot
            leaf.close = None if closing is None else closing.ab
            leaf.spawns = closing is None
        return leaf

    # -- forks

    def fork(
        self, parts: tuple[Process, ...], region: Region, exits: Exits, zone: int, ends: Exits, *, first: bool
    ) -> Instruction:
        entries = tuple(self.process(p, region, ends, zone) for p in parts)
        return forks.ForkParts(
            self.kernel, entries, ok=exits.ok, ab=exits.ab, first=first, decisive=False, zone=zone
        )

    def rivals(self, parts: tuple[Process, ...], region: Region, exits: Exits, zone: int) -> Instruction:
        """`#`: each part binds in a region of its own, of which the winner's bindings leave."""
        entries, leaving = [], []
        for part in parts:
            own = Region(region)
            own.declare(part)
            entries.append(self.process(part, own, self.compiler.rival, zone))
            leaving.append(tuple((own.slot(n), region.slot(n)) for n in exported(part)))
        return forks.ForkParts(
            self.kernel,
            tuple(entries),
            ok=exits.ok,
            ab=exits.ab,
            first=False,
            decisive=True,
            zone=zone,
            exports=tuple(leaving) if any(leaving) else (),
            guard=self.guard(parts, region),
        )

    def guard(self, parts: tuple[Process, ...], region: Region) -> forks.Guard | None:
        for index, part in enumerate(parts):
            if isinstance(part, Call) and (control := self.compiler.controls.get(part.name)) is not None:
                if control.guards and part.arguments:
                    guards: Guards = control  # type: ignore[assignment]  # it says that it guards
                    return index, guards, tuples(part.arguments[:1], region.slot, self.compiler.functions)
        return None

    # -- loops (N8)

    def loop(self, term: Loop, region: Region, exits: Exits, zone: int) -> Instruction:
        sensing, serving = (SENSING, SERVING) if zone == OUTSIDE else (zone, zone)
        again = instructions.Round(self.kernel, zone=zone, name=self.name)
        before = region.size
        hidden = Region(region)
        hidden.declare(term.body)
        ends = Exits(again, again)
        if self.opens(term.condition):
            slot = region.new_slot()
            closing = self.closing(slot, ends)
            body = self.process(term.body, hidden, closing, serving)
            again.head = self.opening(term.condition, region, Exits(body, exits.ab), sensing, slot, closing)
        else:
            body = self.process(term.body, hidden, ends, serving)
            again.head = self.process(term.condition, region, Exits(body, exits.ab), sensing)
        again.slots = _fresh(term.condition, region, before)
        return again.head

    def spawn(self, term: Spawn, region: Region, exits: Exits, zone: int) -> Instruction:
        sensing, serving = (SENSING, SERVING) if zone == OUTSIDE else (zone, zone)
        fork = forks.ForkSpawn(self.kernel, ok=exits.ok, ab=exits.ab, zone=zone)
        before = region.size
        hidden = Region(region)
        hidden.declare(term.body)
        opens = self.opens(term.condition)
        slot = region.new_slot() if opens else -1
        spawn = forks.SpawnBody(self.kernel, zone=zone, name=self.name, slot=slot)
        condition = Exits(spawn, self.compiler.head)
        if opens:
            closing = self.closing(slot, self.compiler.spawned)
            spawn.close = closing.ab
            spawn.body = self.process(term.body, hidden, closing, serving)
            spawn.head = self.opening(term.condition, region, condition, sensing, slot, None)
            spawn.opener = getattr(spawn.head, "control", None)
        else:
            spawn.body = self.process(term.body, hidden, self.compiler.spawned, serving)
            spawn.head = self.process(term.condition, region, condition, sensing)
        spawn.slots = _fresh(term.condition, region, before)
        fork.head = spawn.head
        return fork

    # -- calls

    def call(self, call: Call, region: Region, exits: Exits, zone: int) -> Instruction:
        if call.name == "STOP":
            return exits.ok
        if call.name == "ABORT":
            return instructions.Fail(exits.ab)
        self.calls += 1
        site: Hashable = call.place or (self.name, self.calls)
        failed = Mistake(self.kernel, call.name, exits.ab, zone=zone, site=site)
        control = self.compiler.controls.get(call.name)
        signature = BUILT_IN[call.name] if call.name in LEAVES else control.signature if control else None
        if signature is not None and not (
            signature.takes(len(call.arguments)) and signature.returns(len(call.results))
        ):
            return failed
        arguments = tuples(call.arguments, region.slot, self.compiler.functions)
        targets = tuple(region.slot(name) for name in call.results)
        if signature is None:
            return self.schema_call(call, exits, zone, failed, instructions.Arguments(arguments, targets))
        setting = Setting(
            kernel=self.kernel, name=call.name, arguments=arguments, targets=targets, ok=exits.ok, ab=exits.ab,
            failed=failed, zone=zone, site=site,
        )  # fmt: skip
        if call.name in LEAVES:
            return LEAVES[call.name](setting, self.compiler.ports)
        assert control is not None
        return Use(setting, control)

    def schema_call(
        self, call: Call, exits: Exits, zone: int, failed: Mistake, passed: instructions.Arguments
    ) -> Instruction:
        definition = self.compiler.definitions.named(call.name)
        is_tail = self.tail is not None and exits.ok is self.tail.ok and exits.ab is self.tail.ab
        if is_tail and not passed.targets:
            return instructions.TailCall(
                self.kernel, definition, passed, failed=failed, zone=zone, name=self.name
            )
        return instructions.Call(
            self.kernel,
            definition,
            passed,
            ok=exits.ok,
            ab=exits.ab,
            failed=failed,
            zone=zone,
            name=self.name,
        )


def _ends(ok: Instruction, ab: Instruction) -> Exits:
    return Exits(ok, ab)


def _title(schema: Schema) -> str:
    constants = [str(h.value) for h in schema.head if not isinstance(h, Parameter)]
    return f"{schema.name}[{','.join(constants)}]" if constants else schema.name


def _fresh(condition: Process, region: Region, before: int) -> tuple[int, ...]:
    """The slots that a new round forgets: what the condition binds, and all that the loop has of its own."""
    bound = {region.slot(name) for name in exported(condition)}
    return tuple(sorted(bound | set(range(before, region.size))))
