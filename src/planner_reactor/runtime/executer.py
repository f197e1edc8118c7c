"""The executer: starts processes, loads and unloads definitions while they run, and says how things stand.

RS-L3 of R §9.1, in Python: definitions are passed to a running executer as they are made. It is driven by its
scheduler alone; between events nothing runs. The reactor extends it by `Control`s and speaks to it by `end`, `wake`,
`resting` and `watch`.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from contextlib import contextmanager

import msgspec

from planner_reactor.errors import InputError, nearest
from planner_reactor.rs.prelude import PRELUDE
from planner_reactor.rs.terms import Call, Process, Program, Schema, Value, Variable, calls
from planner_reactor.rs.vocabulary import BUILT_IN
from planner_reactor.runtime.apart import Workers
from planner_reactor.runtime.basic import Basic
from planner_reactor.runtime.budgets import Budgets
from planner_reactor.runtime.compiler import Compiler
from planner_reactor.runtime.definitions import Clause
from planner_reactor.runtime.host import Host
from planner_reactor.runtime.kernel import Kernel
from planner_reactor.runtime.leaves import Use
from planner_reactor.runtime.outcomes import Control, Label, Observer, Outcome
from planner_reactor.runtime.patience import Patience
from planner_reactor.runtime.ports import Port
from planner_reactor.runtime.rest import is_resting
from planner_reactor.runtime.scheduler import Scheduler
from planner_reactor.runtime.strands import WAITING, WOKEN, Body, Root, Strand
from planner_reactor.runtime.witnesses import Witness
from planner_reactor.trace import Trace

PATIENCE = 0.1
"""Seconds for which host code may hold up the loop, if nothing else is said."""


class Statistics(msgspec.Struct, frozen=True):
    """How things stand. `time` in seconds; `zeno` names the definition that last used up a budget of rounds."""

    time: float
    processes_live: int
    processes_ready: int
    basic_running: int
    bodies_in_service: int
    steps: int
    rendezvous: int
    zeno: str | None


class Executer:
    """Runs RS programs on a scheduler.

    `observer` is told the `Label` of every step; `trace` gets what is out of the ordinary (errors of a
    host's code, limits, budgets); `on_end` is called with each root that ends, inside the step that ends
    it.
    """

    def __init__(
        self,
        program: Program,
        *,
        scheduler: Scheduler,
        host: Host | None = None,
        controls: Iterable[Control] = (),
        observer: Observer | None = None,
        trace: Trace | None = None,
        budgets: Budgets | None = None,
        on_end: Callable[[Root], object] | None = None,
    ) -> None:
        self.scheduler = scheduler
        self.roots: list[Root] = []
        self._kernel = Kernel(scheduler, budgets or Budgets(), observer)
        workers = Workers()
        self._basics = [Basic(process, self._kernel, workers) for process in (host.processes.values() if host else ())]
        by_name: dict[str, Control] = {control.name: control for control in controls}
        by_name |= {basic.name: basic for basic in self._basics}
        self._controls: Mapping[str, Control] = by_name
        self.functions = host.functions if host else {}
        self._compiler = Compiler(self._kernel, by_name, self.functions)
        self._told = on_end
        self._witness: Witness | None = None
        self._killed: set[Root] = set()
        self._count = 0
        self._running = False
        self._kernel.on_end = self._ended
        if trace is not None:
            self._kernel.note = trace.record
        if host is not None:
            self._compiler.ports.adopt(host.ports)
        self._compiler.definitions.load(PRELUDE.schemas)
        self.load(program.schemas)

    # -- running

    def attend(self, witness: Witness) -> None:
        """From now on `witness` is told of everything that this executer does, the observer before it."""
        self._witness, observer = witness, self._kernel.observer

        def observe(label: Label) -> None:
            if observer is not None:
                observer(label)
            witness.took(label, self.sites)

        self._kernel.observer = observe

    def start(self, name: str, arguments: Iterable[Value] = ()) -> Root:
        """Start an instance of a schema (or of a basic process) beside what runs; its results are collected."""
        values = tuple(arguments)
        names = self._result_names(name, values)
        parameters = tuple(f"argument {i + 1}" for i in range(len(values)))
        call = Call(name, tuple(Variable(p) for p in parameters), names)
        return self._start(name, call, dict(zip(parameters, values, strict=True)))

    def start_process(self, process: Process, *, name: str = "root") -> Root:
        """Start a process beside what runs; the names that leave it are its results."""
        return self._start(name, process, {})

    def run(self, until: float | None = None) -> None:
        """Run until all roots have ended, nothing is left to do, or the instant `until` (seconds) is past."""
        if self.roots:
            self._kernel.arm()
            self._running = True
            try:
                self.scheduler.run(until)
            finally:
                self._running = False

    @contextmanager
    def patient(self, seconds: float = PATIENCE) -> Iterator[None]:
        """While it runs in here, a call of host code that holds up the loop for so many seconds is interrupted.

        On the wall clock, in the main thread; elsewhere without effect.
        """
        if self.scheduler.clock.jumps:
            yield
            return
        patience = self._kernel.patience = Patience(seconds)
        try:
            with patience.kept():
                yield
        finally:
            self._kernel.patience = None

    def kill(self, root: Root) -> None:
        """Abort a root, as soon as the present step is over; without effect on one that has ended."""
        if root.outcome is None:
            self._killed.add(root)
            self._kernel.kill_root(root)

    def compiled(self, schemas: Iterable[Schema]) -> tuple[Clause, ...]:
        """Definitions made ready to be loaded. May be called from any thread."""
        definitions = self._compiler.definitions
        return tuple([definitions.compiled(s, now=not _has_ports(s)) for s in schemas])

    def load(self, schemas: Iterable[Schema | Clause]) -> None:
        """Add definitions while everything runs: all of them, or none if two clauses have the same head."""
        given = tuple(schemas)
        new = tuple([g.schema if isinstance(g, Clause) else g for g in given])
        for schema in new:
            if schema.name in BUILT_IN or schema.name in self._controls:
                raise InputError(f"{schema.name} is a process already, a definition needs another name")
        self._compiler.definitions.load(given)
        if self._witness is not None:
            self._witness.loaded(new)

    def unload(self, schemas: Iterable[Schema]) -> None:
        """Forget definitions. Strands that run them go on; further calls abort (cause error)."""
        gone = tuple(schemas)
        self._compiler.definitions.unload(gone)
        if self._witness is not None:
            self._witness.unloaded(gone)

    def statistics(self) -> Statistics:
        kernel = self._kernel
        return Statistics(
            time=self.scheduler.now,
            processes_live=kernel.live,
            processes_ready=len(kernel.ready),
            basic_running=sum(basic.running for basic in self._basics),
            bodies_in_service=kernel.bodies,
            steps=kernel.steps,
            rendezvous=kernel.rendezvous,
            zeno=kernel.zeno,
        )

    @property
    def room(self) -> int:
        """How many more processes its budget allows."""
        return self._kernel.budgets.processes - self._kernel.live

    @property
    def processes_live(self) -> int:
        """Strands alive: one figure of the statistics, for those who ask after every step."""
        return self._kernel.live

    @property
    def killing(self) -> bool:
        """Is a root still to be aborted, as soon as the present step is over?"""
        return bool(self._killed)

    @property
    def sites(self) -> tuple[Hashable, ...]:
        """Where in the text the leaves stand whose step the observer is told of: one, or a writer and its reader."""
        return self._kernel.sites

    @property
    def definitions(self) -> tuple[str, ...]:
        """The names that can be called now."""
        return self._compiler.definitions.names

    def ports(self) -> Mapping[Value, str]:
        """At which ports something waits, and which side ("IN" or "OUT")."""
        return self._compiler.ports.waiting()

    def share(self, *names: str) -> dict[str, Port]:
        """These ports, for a host's `ports`: programs of that host then meet at them what runs here."""
        return {name: self._compiler.ports.share(name) for name in names}

    # -- for controls

    def end(self, strand: Strand, outcome: Outcome) -> None:
        """The control in which this strand waits ends, within the present step (or now, if there is none)."""
        if strand.state == WAITING or strand.state == WOKEN:
            leaf: Use = strand.pc  # type: ignore[assignment]  # it waits in a control
            self._kernel.queue(strand, leaf.take(strand, outcome))
            self._kernel.arm()

    def wake(self, strand: Strand) -> None:
        """The control in which this strand waits is started again, as a step of its own."""
        self._kernel.wake(strand)

    def cut(self, body: Body, cause: str) -> None:
        """Abort a body in service, as a part of the present step: its basic processes are abandoned (N9)."""
        self._kernel.cut(body, cause)
        self._kernel.arm()

    def resting(self, strand: Strand) -> bool:
        """Is nothing below this strand (a part of a guarded `#`) in service?

        Every leaf is in a resting control, or in the condition of an outermost loop, and no body is open.
        """
        return is_resting(strand)

    def after_step(self, told: Callable[[], object]) -> None:
        """Call `told` once, as soon as everything that belongs to the present step is done."""
        self._kernel.after_step(told)

    def watch(self, label: Value, told: Callable[[], object]) -> None:
        """Call `told` after each step in which something below the guard `label` may have come to rest."""
        self._kernel.watch(label, told)

    def unwatch(self, label: Value) -> None:
        self._kernel.unwatch(label)

    # -- inside

    def _start(self, name: str, process: Process, bound: Mapping[str, Value]) -> Root:
        self._count += 1
        root = Root(name, self._count)
        # whoever looks at the places of leaves tells the roots apart by them
        shared = None if self._kernel.observer is not None or bound else self._compiler.script(process)
        entry, frame = shared or self._compiler.root(name, process, bound)
        strand = root.strand = Strand(entry, frame, root)
        self.roots.append(root)
        self._kernel.live += 1
        self._kernel.queue(strand, entry)
        self._kernel.arm()
        if self._witness is not None:
            self._witness.began(root, process, bound)
        return root

    def _result_names(self, name: str, values: tuple[Value, ...]) -> tuple[str, ...]:
        control = self._controls.get(name)
        if control is not None:
            return control.signature.results
        if name in BUILT_IN and name not in PRELUDE.names:
            return BUILT_IN[name].results
        definition = self._compiler.definitions.named(name)
        clause = definition.select(values)
        if clause is not None:
            return clause.schema.results
        if definition:
            raise InputError(f"no clause of {name} applies to {len(values)} arguments {list(values)!r}")
        hint = nearest(name, (*self.definitions, *self._controls))
        raise InputError(f"unknown process {name}" + (f", {hint}" if hint else ""))

    def _ended(self, root: Root) -> None:
        self.roots.remove(root)
        if self._witness is not None:
            self._witness.ended(root, killed=root in self._killed and root.cause == "cancelled")
        self._killed.discard(root)
        if self._told is not None:
            self._told(root)
        if self._running and not self.roots:
            self.scheduler.stop()


def _has_ports(schema: Schema) -> bool:
    """Ports are the loop's own: what has any is compiled there, when it is first called."""
    return any(call.name in ("IN", "OUT") for call in calls(schema.body))
