"""Terms compiled to linked instructions.

A process is compiled from its end: given where to go on when it stops (`ok`) and when it aborts (`ab`), the compiler
returns where it begins. So `;` compiles its left part with both exits on the right part's beginning, `:` only its
stop, `~` swaps them, and none of these leaves an instruction behind.

Each name that is bound has a slot of the frame. Names are bound within *regions*: a definition's body, the body of a
loop (its bindings are hidden), each part of a `#` (only the winner's leave). Rounds forget the slots of their loop.
"""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

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
    Symbol,
    Value,
    Variable,
)
from planner_reactor.rs.vocabulary import BUILT_IN
from planner_reactor.runtime import forks, instructions
from planner_reactor.runtime.built_in import LEAVES
from planner_reactor.runtime.definitions import Code, Definitions
from planner_reactor.runtime.kernel import Kernel
from planner_reactor.runtime.leaves import Mistake, Setting, Use
from planner_reactor.runtime.outcomes import Control, Guards
from planner_reactor.runtime.ports import Ports
from planner_reactor.runtime.regions import Region, exported
from planner_reactor.runtime.strands import OUTSIDE, SENSING, SERVING, UNBOUND, Frame, Instruction, Where
from planner_reactor.runtime.values import CONSTANTS, Functions, frames, reader, tuples

MOST_FORMS = 256
"""Forms of scripts that are kept compiled."""


class Exits(msgspec.Struct, frozen=True):
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
        self._scripts: dict[tuple[tuple[str, int], ...], tuple[Instruction, Frame]] = {}
        self.part = _ends(forks.PartEnd(kernel, ok=True, settles=True), forks.PartEnd(kernel, ok=False, settles=False))
        self.share = _ends(forks.PartEnd(kernel, ok=True, settles=False), forks.PartEnd(kernel, ok=False, settles=True))
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
        entry = body.process(schema.body, region, exits, body.outside)
        body.straighten()
        return Code(entry, tuple(region.blank[len(schema.head) :]))

    def script(self, process: Process) -> tuple[Instruction, Frame] | None:
        """A root that is a chain `A[1] : B[s] : …` of constants: compiled once for all of its form; None if it is not.
        """
        if not isinstance(process, Cond):
            return None
        form, values = _form(process)
        if len(form) < len(process.parts):
            return None
        if (compiled := self._scripts.get(form)) is None:
            names = iter([f"argument {i + 1}" for i in range(len(values))])
            general = [Call(name, tuple([Variable(next(names)) for _ in range(count)])) for name, count in form]
            bound = dict.fromkeys((f"argument {i + 1}" for i in range(len(values))), None)
            if len(self._scripts) >= MOST_FORMS:
                self._scripts.clear()
            compiled = self._scripts[form] = self.root("script", Cond(tuple(general)), bound)
        entry, frame = compiled
        return entry, [*values, *frame[len(values) :]]

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
        body = _Body(self, name, tail=None)
        entry = body.process(process, region, exits, body.outside)
        body.straighten()
        return entry, [*bound.values(), *region.blank[len(bound) :]]


class _Body:
    """The compilation of one definition's body, or of one root."""

    def __init__(self, compiler: Compiler, name: str, *, tail: Exits | None) -> None:
        self.compiler = compiler
        self.kernel = compiler.kernel
        self.outside = Where(name, OUTSIDE)
        self.sensing = Where(name, SENSING)
        self.serving = Where(name, SERVING)
        self.tail = tail
        self.leaves: list[Instruction] = []

    def process(self, term: Process, region: Region, exits: Exits, where: Where) -> Instruction:
        match term:
            case Call():
                return self.call(term, region, exits, where)
            case Seq(parts):
                return self.chain(parts, region, exits, where, on_abort=True)
            case Cond(parts):
                return self.chain(parts, region, exits, where, on_abort=False)
            case Not(body):
                return self.process(body, region, Exits(instructions.Fail(exits.ab), exits.ok), where)
            case If(test, then, otherwise):
                branches = [self.process(p, region, exits, where) for p in (then, otherwise)]
                return self.process(test, region, Exits(*branches), where)
            case Par(parts):
                return self.fork(parts, region, exits, where, self.compiler.part, first=False)
            case All(parts):
                return self.fork(parts, region, exits, where, self.compiler.share, first=True)
            case Disable(parts):
                return self.rivals(parts, region, exits, where)
            case Loop():
                return self.loop(term, region, exits, where)
            case Spawn():
                return self.spawn(term, region, exits, where)

    def chain(
        self, parts: tuple[Process, ...], region: Region, exits: Exits, where: Where, *, on_abort: bool
    ) -> Instruction:
        """`;` (N1: goes on after stop and abort) and `:` (N2: after stop).

        A control that opens a body opens it to the end of the chain.
        """
        last = len(parts) - 1
        opener = next((i for i, p in enumerate(parts[:last]) if self.opens(p)), None)
        if opener is None:
            entry = self.process(parts[last], region, exits, where)
            before = last
        else:
            slot = region.new_slot()
            inside = parts[opener + 1 :]
            bound = (region.slot(name) for part in inside for name in exported(part))
            closing = self.closing(slot, exits, tuple(bound))
            rest = self.chain(inside, region, closing, where, on_abort=on_abort)
            onward = Exits(rest, rest if on_abort else exits.ab)
            entry = self.opening(self.process(parts[opener], region, onward, where), slot, closing)
            before = opener
        for part in reversed(parts[:before]):
            entry = self.process(part, region, Exits(entry, entry if on_abort else exits.ab), where)
        return entry

    # -- bodies that a control opens

    def opens(self, term: Process) -> bool:
        """Is this a direct call of a control that opens a body for what follows it?"""
        control = self.compiler.controls.get(term.name) if isinstance(term, Call) else None
        return control is not None and control.opens_body

    def closing(self, slot: int, exits: Exits, bound: tuple[int, ...] = ()) -> Exits:
        """Where a body ends; `bound` are the slots of the names that leave it."""
        return Exits(
            instructions.CloseBody(self.kernel, slot, exits.ok, ok=True),
            instructions.CloseBody(self.kernel, slot, exits.ab, ok=False, bound=bound),
        )

    def opening(self, leaf: Instruction, slot: int, closing: Exits | None) -> Instruction:
        """Let the control's leaf open a body; `closing` is None if that is the body of a spawned strand."""
        if isinstance(leaf, Use):
            leaf.slot = slot
            leaf.close = None if closing is None else closing.ab
            leaf.spawns = closing is None
        return leaf

    # -- forks

    def fork(
        self,
        parts: tuple[Process, ...],
        region: Region,
        exits: Exits,
        where: Where,
        ends: Exits,
        *,
        first: bool,
    ) -> Instruction:
        entries = tuple(self.process(p, region, ends, where) for p in parts)
        return forks.ForkParts(self.kernel, entries, ok=exits.ok, ab=exits.ab, first=first, decisive=False, where=where)

    def rivals(self, parts: tuple[Process, ...], region: Region, exits: Exits, where: Where) -> Instruction:
        """`#`: each part binds in a region of its own, of which the winner's bindings leave.

        Beside a guard loops count anew: what is at rest is asked of what the guard guards, not of what is around it.
        """
        entries, leaving = [], []
        guard = self.guard(parts, region)
        inside = where if guard is None else self.outside
        for part in parts:
            own = Region(region)
            own.declare(part)
            entries.append(self.process(part, own, self.compiler.rival, inside))
            leaving.append(tuple((own.slot(n), region.slot(n)) for n in exported(part)))
        return forks.ForkParts(
            self.kernel,
            tuple(entries),
            ok=exits.ok,
            ab=exits.ab,
            first=False,
            decisive=True,
            where=where,
            exports=tuple(leaving) if any(leaving) else (),
            guard=guard,
        )

    def guard(self, parts: tuple[Process, ...], region: Region) -> forks.Guard | None:
        for index, part in enumerate(parts):
            control = self.compiler.controls.get(part.name) if isinstance(part, Call) else None
            if control is not None and control.guards and isinstance(part, Call) and part.arguments:
                guards: Guards = control  # type: ignore[assignment]  # it says that it guards
                return index, guards, tuples(part.arguments[:1], region.slot, self.compiler.functions)
        return None

    # -- loops (N8)

    def loop(self, term: Loop, region: Region, exits: Exits, where: Where) -> Instruction:
        sensing, serving = (self.sensing, self.serving) if where is self.outside else (where, where)
        if self.opens(term.condition):
            return self.service(term, region, exits, sensing, serving)
        again = instructions.Round(where)
        before = region.size
        hidden = Region(region)
        hidden.declare(term.body)
        body = self.process(term.body, hidden, Exits(again, again), serving)
        again.head = self.process(term.condition, region, Exits(body, exits.ab), sensing)
        again.slots = _fresh(term.condition, region, before)
        return again.head

    def service(self, term: Loop, region: Region, exits: Exits, sensing: Where, serving: Where) -> Instruction:
        """`SIT :; B`, which comes and goes with adaptations: its frame knows its head, so that no code holds itself."""
        held = region.new_slot()
        again = instructions.Again(held, sensing)
        before = region.size
        hidden = Region(region)
        hidden.declare(term.body)
        slot = region.new_slot()
        closing = self.closing(slot, Exits(again, again))
        body = self.process(term.body, hidden, closing, serving)
        leaf = self.process(term.condition, region, Exits(body, exits.ab), sensing)
        region.blank[held] = head = self.opening(leaf, slot, closing)
        again.slots = _fresh(term.condition, region, before)
        return head

    def spawn(self, term: Spawn, region: Region, exits: Exits, where: Where) -> Instruction:
        sensing, serving = (self.sensing, self.serving) if where is self.outside else (where, where)
        fork = forks.ForkSpawn(self.kernel, ok=exits.ok, ab=exits.ab, where=where)
        before = region.size
        hidden = Region(region)
        hidden.declare(term.body)
        opens = self.opens(term.condition)
        slot = region.new_slot() if opens else -1
        spawn = forks.SpawnBody(self.kernel, slot, where)
        ends = self.compiler.spawned
        head = self.process(term.condition, region, Exits(spawn, self.compiler.head), sensing)
        if opens:
            ends = self.closing(slot, ends)
            spawn.close = ends.ab
            spawn.opener = getattr(self.opening(head, slot, None), "control", None)
        spawn.body = self.process(term.body, hidden, ends, serving)
        spawn.slots = _fresh(term.condition, region, before)
        fork.head = head
        return fork

    # -- calls

    def call(self, call: Call, region: Region, exits: Exits, where: Where) -> Instruction:
        if call.name == "STOP":
            return exits.ok
        if call.name == "ABORT":
            return instructions.Fail(exits.ab)
        at = Where(where.within, where.zone, call.place or (where.within, len(self.leaves)))
        control = self.compiler.controls.get(call.name)
        if control is None and call.name not in LEAVES:
            return self.schema_call(call, region, exits, at)
        signature = BUILT_IN[call.name] if control is None else control.signature
        if not (signature.takes(len(call.arguments)) and signature.returns(len(call.results))):
            return Mistake(self.kernel, call.name, exits.ab, at)
        functions = self.compiler.functions
        own = call.arguments if control is None else ()  # what only the executer's own leaves look at
        setting = Setting(
            kernel=self.kernel,
            name=call.name,
            where=at,
            terms=call.arguments,
            slots=tuple([region.slot(a.name) if isinstance(a, Variable) else -1 for a in own]),
            arguments=tuples(call.arguments, region.slot, functions),
            readers=tuple([reader(a, region.slot, functions) for a in own]),
            targets=tuple([region.slot(name) for name in call.results]),
            ok=exits.ok,
            ab=exits.ab,
        )
        leaf = LEAVES[call.name](setting, self.compiler.ports) if control is None else Use(setting, control)
        self.leaves.append(leaf)
        return leaf

    def straighten(self) -> None:
        """Let leaves go on past rounds that have nothing to forget."""
        for leaf in self.leaves:
            onward = getattr(leaf, "ok", None)
            while isinstance(onward, instructions.Round) and not onward.slots and onward.head is not onward:
                onward = leaf.ok = onward.head  # type: ignore[attr-defined]  # it has one

    def schema_call(self, call: Call, region: Region, exits: Exits, at: Where) -> Instruction:
        failed = Mistake(self.kernel, call.name, exits.ab, at)
        definition = self.compiler.definitions.named(call.name)
        passed = instructions.Arguments(
            frames(call.arguments, region.slot, self.compiler.functions),
            len(call.arguments),
            tuple(region.slot(name) for name in call.results),
        )
        is_tail = self.tail is not None and exits.ok is self.tail.ok and exits.ab is self.tail.ab
        if is_tail and not passed.targets:
            return instructions.TailCall(definition, passed, failed)
        return instructions.Call(self.kernel, definition, passed, failed, ok=exits.ok, ab=exits.ab)


def _form(chain: Cond) -> tuple[tuple[tuple[str, int], ...], list[Value]]:
    """The names of its calls with how many arguments they have, up to the first that is of another kind; the arguments.
    """
    form: list[tuple[str, int]] = []
    values: list[Value] = []
    for part in chain.parts:
        if not isinstance(part, Call) or part.results:
            break
        constants = [a.name if isinstance(a, Symbol) else a.value for a in part.arguments if isinstance(a, CONSTANTS)]
        if len(constants) < len(part.arguments):
            break
        form.append((part.name, len(constants)))
        values += constants
    return tuple(form), values


def _ends(ok: Instruction, ab: Instruction) -> Exits:
    return Exits(ok, ab)


def _title(schema: Schema) -> str:
    constants = [str(h.value) for h in schema.head if not isinstance(h, Parameter)]
    return f"{schema.name}[{','.join(constants)}]" if constants else schema.name


def _fresh(condition: Process, region: Region, before: int) -> tuple[int, ...]:
    """The slots that a new round forgets: what the condition binds, and all that the loop has of its own."""
    bound = {region.slot(name) for name in exported(condition)}
    own = {slot for slot in range(before, region.size) if region.blank[slot] is UNBOUND}
    return tuple(sorted(bound | own))
