"""The kernel: runs strands through linked instructions, in the order that the semantics asks for.

First everything *silent*: strands are advanced to their next leaves and endings are passed on, until nothing is left;
then one verdict of a `#`, innermost first, leftmost among equals (N5), and again what is silent; then the ready
strands, first in first out, each for a slice of instructions; then time (rule TIME, maximal progress). Neither endings
nor killing (N9) recurse: both keep explicit queues.

One rule makes the inner loop short: **an instruction that leaves anything silent behind queues its own strand as
silent too and returns None**. So whenever `run` returns an instruction, nothing else is due before it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Hashable
from typing import Any

from planner_reactor.rs.terms import Value
from planner_reactor.runtime.budgets import Budgets
from planner_reactor.runtime.killing import abort_body, cut_body, kill
from planner_reactor.runtime.outcomes import Label, Observer
from planner_reactor.runtime.patience import Patience
from planner_reactor.runtime.pause import Passing, Pause
from planner_reactor.runtime.scheduler import Entry, Scheduler
from planner_reactor.runtime.strands import (
    READY,
    RUNNING,
    SILENT,
    WAITING,
    WOKEN,
    Body,
    Fork,
    Instruction,
    Root,
    Strand,
)
from planner_reactor.runtime.verdicts import Verdicts, is_void, verdict


class Kernel:
    """Queues and counters. Instructions hold a reference to it; nothing outside `runtime` does."""

    def __init__(self, scheduler: Scheduler, budgets: Budgets, observer: Observer | None) -> None:
        self.scheduler = scheduler
        self.budgets = budgets
        self.observer = observer
        self.sites: tuple[Hashable, ...] = ()
        self.note: Callable[..., None] = lambda kind, **fields: None
        self.on_end: Callable[[Root], object] = lambda root: None
        self.patience: Patience | None = None  # how long host code may hold up the loop
        self.silent: deque[Strand] = deque()
        self.ready: deque[Strand] = deque()
        self.live = 0
        self.bodies = 0
        self.steps = 0
        self.rendezvous = 0
        self.turns = budgets.turns
        self.zeno: str | None = None
        self._slice = range(budgets.slice)
        self._patience = range(budgets.turns)
        self.verdicts = Verdicts()
        self.due = False  # is anything silent, undecided or put off to the end of the step?
        self.watched: dict[Value, Callable[[], object]] = {}
        self._moved: dict[Value, None] = {}
        self._later: deque[Callable[[], object]] = deque()
        self._draining = False
        self._armed = False

    def tell(self, label: Label, *sites: Hashable) -> None:
        """Tell the observer, who must be there, of a step of the leaves that stand at these places in the text."""
        self.sites = sites
        self.observer(label)  # type: ignore[misc]  # whoever calls this has looked

    # -- the loop

    def turn(self, strand: Strand, pc: Instruction) -> None:
        """Let a ready strand run, if its body or root has not used up its turns at this instant."""
        meter, now = strand.meter, self.scheduler.now
        if meter.instant != now:
            meter.instant = now
            meter.turns = 0
        meter.turns += 1
        if meter.turns > self.turns and meter.turns > self.turns + self.live:
            self.overrun(strand, pc)
            return
        strand.state = RUNNING
        following: Instruction | None = pc
        for _ in self._slice:  # as in `run`, which is for strands whose time has passed
            following = following.run(strand)  # type: ignore[union-attr]  # never None here
            if following is None:
                return
        meter.turns += self.budgets.slice - 1
        self.advance(strand, following)

    def run(self, strand: Strand, pc: Instruction) -> None:
        """Let a strand run for a slice, or until it waits, forks, ends, or something else comes first."""
        strand.state = RUNNING
        following: Instruction | None = pc
        for _ in self._slice:
            following = following.run(strand)  # type: ignore[union-attr]  # never None here
            if following is None:
                return
        strand.meter.turns += self.budgets.slice - 1
        self.advance(strand, following)

    def _retry(self, strand: Strand) -> None:
        """The control in which the strand waits is started again: it cannot be put off, it knows the strand."""
        strand.state = RUNNING
        if (following := strand.pc.run(strand)) is not None:
            self.turn(strand, following)

    def advance(self, strand: Strand, pc: Instruction | None) -> None:
        """Take a strand to its next leaf, where it will have a turn."""
        for _ in self._patience:
            if pc is None:
                return
            if not pc.silent:
                strand.pc = pc
                strand.state = READY
                self.ready.append(strand)
                return
            pc = pc.run(strand)
        if pc is not None:
            self.overrun(strand, pc)

    def settle(self) -> None:
        """Everything that belongs to the present step."""
        silent, verdicts = self.silent, self.verdicts
        while True:
            while silent:
                strand = silent.popleft()
                if strand.state == SILENT:
                    strand.state = RUNNING
                    self.advance(strand, strand.pc)
                    if self.watched:  # it may have ended, and never have a turn
                        self.moved(strand)
            if verdicts.new or verdicts.ranked:
                self.decide(verdicts.next())
            elif self._later:
                self._later.popleft()()
            else:
                self.due = False
                return

    def drain(self) -> None:
        """Run until every strand waits."""
        self._armed = False
        if self._draining:
            return
        self._draining = True
        ready = self.ready
        try:
            while True:
                if self.due:
                    self.settle()
                if not ready:
                    return
                strand = ready.popleft()
                if strand.state == READY:
                    self.turn(strand, strand.pc)
                elif strand.state == WOKEN:
                    self._retry(strand)
                if self.watched:
                    self.moved(strand)
        finally:
            self._draining = False

    def arm(self) -> None:
        """See to it that what was queued from outside a step gets done at the present instant."""
        if not self._draining and not self._armed:
            self._armed = True
            self.scheduler.soon(self.drain)

    def resume(self, strand: Strand, pc: Instruction) -> None:
        """A basic process has ended (a step, already observed), perhaps after no time: go on behind it.

        For what the scheduler calls, never from within a turn.
        """
        strand.link = None
        if self.due:
            self.queue(strand, pc)
            self.arm()
            return
        self.turn(strand, pc)
        if self.watched:
            self.moved(strand)
        if self.due or self.ready:
            self.drain()

    def elapsed(self, entry: Entry) -> None:
        """The time that a strand waits for has passed: a step of its leaf, as in `resume`."""
        strand = entry[1]
        if strand.link is not entry:
            return
        leaf: Passing = strand.pc
        self.steps += 1
        if self.observer is not None:
            leaf.observe(strand)
        strand.link = None
        if self.due:
            self.queue(strand, leaf.ok)
            self.arm()
            return
        self.run(strand, leaf.ok)
        if self.watched:
            self.moved(strand)
        if self.due or self.ready:
            self.drain()

    def awaits(self, entry: Entry) -> bool:
        """Does this strand still wait for this instant?"""
        return entry[1].link is entry

    def withdraw(self, strand: Strand) -> None:
        """A strand that waits for time is aborted."""
        strand.link = None
        self.scheduler.withdrawn()

    def queue(self, strand: Strand, pc: Instruction) -> None:
        """The strand will be advanced from here within the present step."""
        strand.pc = pc
        strand.state = SILENT
        self.silent.append(strand)
        self.due = True

    def wake(self, strand: Strand) -> None:
        """The strand that waits in a control will have a turn to try again."""
        if strand.state == WAITING:
            strand.state = WOKEN
            self.ready.append(strand)
            self.arm()

    # -- forks

    def decide(self, fork: Fork) -> None:
        """N5. `x.r # live Q` = x.r and Q is aborted; only what the winner has bound leaves."""
        if is_void(fork):
            return
        index, ok, cause = verdict(fork)
        kill(self, fork.strands())
        exits: Any = fork.exits
        if exits.exports:
            frame = fork.parent.frame
            for inner, outer in exits.exports[index]:
                frame[outer] = frame[inner]
        self.joined(fork, ok, cause)

    def undecided(self, fork: Fork) -> None:
        """A part of this `#` has ended."""
        self.verdicts.add(fork)
        self.due = True

    def joined(self, fork: Fork, ok: bool, cause: str) -> None:
        """A fork is over: the strand that met it goes on."""
        parent = fork.parent
        parent.link = None
        if not ok:
            parent.cause = cause
        self.queue(parent, fork.exits.ok if ok else fork.exits.ab)

    # -- budgets

    def overrun(self, strand: Strand, onward: Instruction) -> None:
        """The turns of one instant are used up: the nearest body aborts; a root goes on a quantum later."""
        self.zeno = onward.where.within
        self.note("zeno", name=self.zeno, root=strand.root.name)
        self.curb(strand, onward)

    def curb(self, strand: Strand, onward: Instruction) -> None:
        if strand.body is not None:
            abort_body(self, strand.body, "budget")
            return
        strand.pc = Pause(self, onward)
        strand.link = entry = (self, strand)
        strand.state = WAITING
        self.scheduler.wait(self.scheduler.now + self.budgets.quantum, entry)

    def cut(self, body: Body, cause: str) -> None:
        """Abort a body in service; its strand goes on behind it within the present step."""
        cut_body(self, body, cause)

    def crowded(self, strand: Strand, ab: Instruction) -> Instruction | None:
        """No further strand may come to life: the nearest body aborts; in a root, what would have forked."""
        self.note("crowded", root=strand.root.name)
        strand.cause = "budget"
        if strand.body is None:
            return ab
        abort_body(self, strand.body, "budget")
        return None

    def put_off(self, action: Callable[[], object]) -> None:
        """Do this when nothing silent is left of the present step."""
        self._later.append(action)
        self.due = True

    def after_step(self, action: Callable[[], object]) -> None:
        """The same, from wherever it is called."""
        self._later.append(action)
        self.due = True
        if not self._draining:
            self.arm()

    # -- what waits for something to come to rest

    def watch(self, label: Value, told: Callable[[], object]) -> None:
        """Call `told` after every step in which something below the guard `label` may have come to rest."""
        self.watched[label] = told

    def unwatch(self, label: Value) -> None:
        self.watched.pop(label, None)

    def moved(self, strand: Strand) -> None:
        """The strand has had a turn: what is below its guard may have come to rest."""
        if strand.guard in self.watched:
            if not self._moved:
                self.put_off(self._tell_watchers)
            self._moved[strand.guard] = None

    def _tell_watchers(self) -> None:
        moved, self._moved = self._moved, {}
        for label in moved:
            if label in self.watched:
                self.watched[label]()

    # -- roots

    def kill_root(self, root: Root) -> None:
        """Abort a root from outside, at the end of the present step."""
        self.put_off(lambda: self._kill_root(root))
        self.arm()

    def _kill_root(self, root: Root) -> None:
        strand = root.strand
        if strand is not None:
            root.outcome, root.cause, root.strand = "abort", "cancelled", None
            kill(self, [strand])
            self.on_end(root)

    def ended(self, root: Root, strand: Strand, *, ok: bool) -> None:
        """A root has ended."""
        root.outcome = "stop" if ok else "abort"
        root.cause = "" if ok else strand.cause
        root.strand = None
        self.live -= 1
        strand.release()
        self.on_end(root)
