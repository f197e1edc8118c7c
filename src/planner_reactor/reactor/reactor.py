"""The reactor: equation (3) of R §5.3, running, and how it is changed.

    REACTOR = ADD<m> :: (E[m] # P[m])

It starts empty (the *null reactor*) and acts from its first reaction on, planner or no planner. Adaptations come in by
`receive`; what it perceives goes out through the channel; every structural change, situation and signal is in the
trace; the laws are asked after every event. A failed assumption disables, at once, the situations that rest on it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Mapping
from typing import Any

from planner_reactor.errors import InputError, RefusedError
from planner_reactor.link.channels import PerceptionChannel
from planner_reactor.link.messages import Adaptation, Enquiry, PerceptionKind
from planner_reactor.link.messages import Standing as Told
from planner_reactor.reactor.adaptation import Transaction, Transactions
from planner_reactor.reactor.admission import examine, is_text, standing_of
from planner_reactor.reactor.assumptions import Assumptions
from planner_reactor.reactor.built_ins import BuiltIns
from planner_reactor.reactor.composition import undone
from planner_reactor.reactor.disks import NoDisk
from planner_reactor.reactor.doubts import Doubts
from planner_reactor.reactor.enquiries import repeated, standing
from planner_reactor.reactor.forms import Durations
from planner_reactor.reactor.freezing import Freezer
from planner_reactor.reactor.heartbeat import Heartbeat
from planner_reactor.reactor.journal import Journal, Left
from planner_reactor.reactor.laws import WATCHES, Laws
from planner_reactor.reactor.life import Life
from planner_reactor.reactor.preparing import Prepared, Preparing, Vocabulary
from planner_reactor.reactor.reactions import Reactions
from planner_reactor.reactor.readings import Readings
from planner_reactor.reactor.storms import Intensity, Storms
from planner_reactor.reactor.structure import bound_of, text_of
from planner_reactor.reactor.versions import Lifetime
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.reactions import REACTION, Reaction
from planner_reactor.rs.terms import Value
from planner_reactor.rs.vocabulary import BUILT_IN
from planner_reactor.runtime import Budgets, Executer, Host, Root, Scheduler
from planner_reactor.runtime.sensing import Sensed
from planner_reactor.trace import Trace

EQUATION_3 = parse_program(f"REACTOR = ADD<m> :: (E[m] # {REACTION}[m])", file="<reactor>")

TOLD_CAUSES = frozenset({"failed", "error", "budget", "assumption"})
"""Causes of failed instances that the planner hears of; the others follow from what it knows already."""


class Reactor:
    """One running reactor on a scheduler. `host` brings its basic processes, functions and assumptions."""

    def __init__(
        self,
        scheduler: Scheduler,
        *,
        host: Host | None = None,
        perceptions: PerceptionChannel | None = None,
        trace: Trace | None = None,
        budgets: Budgets | None = None,
        observer: Any = None,
        journal: Journal | None = None,
        intensity: Intensity | None = None,
    ) -> None:
        self.scheduler = scheduler
        self.host = host or Host("none")
        self.perceptions = PerceptionChannel() if perceptions is None else perceptions
        self.trace = trace or Trace(lambda: scheduler.now, keep=False)
        self.budgets = budgets or Budgets()
        self.reactions = Reactions()
        self.journal = journal or Journal(NoDisk())
        self.counts: Counter[str] = Counter(received=0, applied=0, refused=0, timed_out=0, changes_applied=0)
        self.stub_triggers = 0
        self.vocabulary = Vocabulary({**BUILT_IN, **self.host.signatures}, self.host.functions, EQUATION_3)
        self._laws_due = False
        self._lifetimes: dict[int, Lifetime] = {}
        self._loaded: dict[int, Reaction] = {}
        self.last_applied: Transaction | None = None
        self.laws = Laws(self)
        self._watches: dict[str, Callable[..., None]] = {
            "added": self._reaction_added,
            "removed": self._reaction_removed,
            "retired": self._reaction_retired,
            "ended": self._instance_ended,
            "absent_guard": self._absent_guard,
        }
        built_in = BuiltIns(
            scheduler, self.host.assumptions, notice=self.notice, read=self.assumption_sensed,
            reached=self._stub_reached, told=self._information, commit=self._commit,
            by_itself=lambda label: self.transactions.left(label),
        )  # fmt: skip
        self.situations = built_in.situations
        self.executer = Executer(
            EQUATION_3,
            scheduler=scheduler,
            host=host,
            controls=built_in.controls,
            observer=observer,
            trace=self.trace,
            budgets=self.budgets,
            on_end=self._root_ended,
        )
        built_in.attach(self.executer)
        self._preparing = Preparing(self.vocabulary, self.executer.compiled)
        self._limits = {name: process.limit for name, process in self.host.processes.items()}
        self._durations: dict[int, Durations] = {}  # how long reactions may take, by label
        self.transactions: Transactions = Transactions(self.executer, scheduler, self.journal, self._finished)
        self.assumptions = Assumptions(scheduler, self.journal, self.situations, self._assumption_told)
        self.readings: Readings = Readings(scheduler, self.host, self.assumptions, self._assumption_told)
        self.host.listen(self.readings.noticed)
        self.freezer, self.storms, self.heartbeat = Freezer(self), Storms(self, intensity), Heartbeat(self)
        self._life, self.doubts = Life(self, EQUATION_3), Doubts(self)

    def start(self) -> Root:
        """Begin to act, on what the journal says: with no reactions yet, if it is new.

        `InputError` if the journal is none, `DiskError` if it cannot be read or written.
        """
        self.root = self._life.start()
        self.heartbeat.start()
        return self.root

    @property
    def halted(self) -> bool:
        """Was the stop button pressed, and not yet released by a reset? A crash does not release it."""
        return self._life.halted

    def halt(self) -> None:
        """The stop button (law 15): everything is aborted, nothing acts until a reset."""
        if not self.halted:
            self.root = self._life.halt()

    def reset(self) -> None:
        """Release the stop button: the reactor begins again on its committed structure. Never done by itself."""
        if self.halted:
            self._forget(list(self._loaded))  # what was coming to life as it was halted
            self.root = self._life.reset()

    # -- adaptation

    def prepare(self, adaptation: Adaptation) -> Prepared:
        """Read and check its text beforehand: most of what `receive` costs. May be called from any thread."""
        return self._preparing.prepare(adaptation)

    def receive(self, given: Adaptation | Prepared) -> None:
        """Take an adaptation: refused whole, with a reason, or begun (its outcome is a perception).

        A repeat of one that is under way says nothing new, of one that was applied it is acknowledged again.
        """
        before, adaptation = (given, given.adaptation) if isinstance(given, Prepared) else (None, given)
        sound = is_text(adaptation)
        if sound and repeated(self, adaptation):
            return
        self.counts["received"] += 1
        self.trace.record("adaptation_received", id=adaptation.id, purpose=adaptation.purpose if sound else "")
        try:
            if not sound:
                raise RefusedError("text", "it holds characters that are no text, or numbers beyond 64 bits")
            if self.halted:
                raise RefusedError("halted", "the reactor is halted, expected a reset first")
            pending = frozenset(s for t in self.transactions.staying(adaptation.epoch) for s in t.situations)
            stands = standing_of(self.journal.state.committed, self.reactions, pending, self.host.functions)
            prepared = examine(lambda: before or self.prepare(adaptation), adaptation, stands)
            killed = tuple([self.reactions[label] for label in adaptation.kills])
            self.transactions.examine(prepared, killed, self.reactions, self.situations.disabled_by)
            bound = self.bound(adaptation)
            self.transactions.revoke(adaptation.epoch)
            reactions = self.transactions.begin(prepared, killed, bound).reactions
        except RefusedError as refusal:
            spent = sound and self.doubts.spend(adaptation, refusal.reason)
            self._refused(adaptation, refusal.reason, str(refusal), doubtful=spent)
            return
        self._durations.update(prepared.durations)
        versions = self.journal.state.committed.versions
        self.loaded(reactions, {r.label: versions.get(r.situation or "", 0) + 1 for r in reactions})

    def enquire(self, enquiry: Enquiry) -> Told:
        """How it stands, for a planner that begins. `RefusedError` if its epoch cannot be made durable."""
        return standing(self, enquiry)

    def undo(self, *, number: int) -> None:
        """Undo the adaptation that was applied last, by one with this id (`InputError` if there is none)."""
        if self.last_applied is None:
            raise InputError("nothing was applied since the reactor was started: there is nothing to undo")
        committed = self.journal.state.committed
        last, first_label = self.last_applied, committed.highest_label + 1
        self.receive(
            undone(last.adaptation, last.before, number=number, epoch=committed.epoch, first_label=first_label)
        )

    def loaded(self, reactions: Iterable[Reaction], versions: Mapping[int, int]) -> None:
        """The definitions of these reactions are there; each belongs to its situation from this version on."""
        for reaction in reactions:
            self._loaded[reaction.label] = reaction
            self._lifetimes[reaction.label] = Lifetime(versions[reaction.label])
            if reaction.situation and reaction.spawns:
                self.situations.spawned.add(reaction.situation)

    def _refused(self, refused: Adaptation, reason: str, message: str, *, doubtful: bool = True) -> None:
        self.counts["refused"] += 1
        self.trace.record("adaptation_refused", id=refused.id, reason=reason, message=message)
        self.doubts.tell("adaptation_refused", refused, reason, message, doubtful=doubtful)

    def _commit(self, number: int) -> bool:
        """COMMIT[number]: from here on the adaptation counts, and what now rests on a failed assumption waits."""
        transaction = self.transactions.commit(number)
        if transaction is None:
            return False
        for reaction in transaction.killed:
            self._lifetimes[reaction.label].last = transaction.before.versions.get(reaction.situation or "", 0)
        self.assumptions.outlived(transaction.adaptation, transaction.before)
        self.assumptions.disable()
        return True

    def bound(self, adaptation: Adaptation) -> float:
        """Seconds in which the adaptation will have been applied (R §5.5, *bounded*)."""
        return bound_of(adaptation, self.reactions, self.vocabulary.signatures, self._limits, self._durations)

    def _root_ended(self, root: Root) -> None:
        self.situations.root_ended(root)
        self.transactions.ended(root)

    def _finished(self, transaction: Transaction) -> None:
        adaptation = transaction.adaptation
        if transaction.state == "applied":
            self._applied(transaction)
            return
        self._forget(r.label for r in transaction.reactions)
        if transaction.state == "refused":
            self._refused(adaptation, transaction.reason, transaction.problem)
            return
        self.counts["timed_out"] += 1
        self.trace.record("adaptation_timed_out", id=adaptation.id, bound=transaction.limit)
        self.doubts.tell("adaptation_timed_out", adaptation, "TIMEOUT")

    def _applied(self, transaction: Transaction) -> None:
        adaptation = transaction.adaptation
        self.counts["applied"] += 1
        self.laws.applied(transaction)
        self.last_applied = transaction
        if adaptation.mode != "versions":
            self._forget(adaptation.kills)
        self.assumptions.enable()
        self.storms.changed(transaction.situations)
        self.trace.record(
            "adaptation_applied", id=adaptation.id, purpose=adaptation.purpose, assumptions=self.assumptions_in_use
        )
        self.perceive("adaptation_applied", str(adaptation.id), epoch=adaptation.epoch)
        self.settle_laws()

    def _forget(self, labels: Iterable[int]) -> None:
        """Their definitions are not needed any more."""
        gone = [self._loaded.pop(label) for label in labels if label in self._loaded]
        self.executer.unload([reaction.schema for reaction in gone])
        for reaction in gone:
            self._lifetimes.pop(reaction.label, None)
            self._durations.pop(reaction.label, None)

    # -- what happens in it

    def notice(self, kind: str, **fields: Any) -> None:
        """One change of the situations or guards: traced, watched by the laws, and acted on."""
        self.trace.record(kind, **fields)
        if (law := WATCHES.get(kind)) is not None:
            law(self.laws, fields)
        if not self._laws_due:
            self._laws_due = True
            self.executer.after_step(self._ask_laws)
        if (watch := self._watches.get(kind)) is not None:
            watch(**fields)

    def settle_laws(self) -> None:
        """Ask the laws as soon as the present step is over."""
        if not self._laws_due:
            self._laws_due = True
            self.executer.after_step(self._ask_laws)

    def _ask_laws(self) -> None:
        self._laws_due = False
        self.laws.check()

    def perceive(
        self,
        kind: PerceptionKind,
        subject: str,
        *,
        cause: str = "",
        instance: int | None = None,
        values: tuple[Value, ...] = (),
        epoch: int = 0,
    ) -> None:
        """Tell the planner."""
        self.perceptions.report(
            kind, subject, time=self.scheduler.now, cause=cause, instance=instance, values=values, epoch=epoch
        )

    def _reaction_added(self, label: int) -> None:
        self.reactions[label] = self._loaded[label]
        self.counts["changes_applied"] += 1
        self.transactions.changed(label, added=True)

    def _reaction_retired(self, label: int) -> None:
        """It is of the structure no more, and serves what is left of its versions."""
        del self.reactions[label]
        self.transactions.changed(label, added=False)

    def _reaction_removed(self, label: int) -> None:
        if self.halted:
            self.reactions.pop(label, None)
            self._forget([label])
            return
        retired = self.reactions.pop(label, None) is None
        self.counts["changes_applied"] += 1
        changed = not retired and self.transactions.changed(label, added=False)
        if not changed and not retired:
            self.journal.note(Left(label, self.scheduler.now))
        if changed or retired:
            self.perceive("guard_kill", str(label))
        if not changed:
            self._forget([label])

    def _absent_guard(self, label: Value) -> None:
        self.perceive("error", str(label), cause="no such guard")

    def _instance_ended(self, situation: str, instance: int, ok: bool, cause: str) -> None:
        if not ok and cause in TOLD_CAUSES:
            self.perceive("situation_failure", situation, cause=cause, instance=instance)
            self.storms.failed(situation, cause)

    def _stub_reached(self, situation: str, instance: int | None) -> None:
        self.stub_triggers += 1
        self.trace.record("stub_trigger", situation=situation, instance=instance)
        self.perceive("stub_trigger", situation, instance=instance)

    def _information(self, name: str, values: tuple[Value, ...]) -> None:
        self.trace.record("information", name=name, values=values)
        self.perceive("information", name, values=values)

    # -- assumptions

    @property
    def failed(self) -> dict[str, float]:
        """The assumptions that have failed, and since when."""
        return self.assumptions.failed

    @property
    def assumptions_in_use(self) -> tuple[str, ...]:
        """The assumptions that its reactions rest on, or that were brought in with them and are watched; sorted."""
        return self.assumptions.in_use

    def resting_on(self, assumption: str) -> tuple[str, ...]:
        return self.assumptions.resting_on(assumption)

    def assumption_sensed(
        self, assumption: str, sensed: Sensed, *, returns: bool = True, fails: bool = True
    ) -> None:
        """A reading of an assumption, which may say that a failed one `returns`, or that it `fails`."""
        self.readings.read(assumption, sensed, returns=returns, fails=fails)

    def _assumption_told(self, kind: PerceptionKind, assumption: str, cause: str = "") -> None:
        self.trace.record(kind, assumption=assumption, **({"cause": cause} if cause else {}))
        self.perceive(kind, assumption, cause=cause)
        self.settle_laws()

    # -- how it stands

    def lifetime(self, label: int | None) -> Lifetime | None:
        """The versions of its situation that a reaction belongs to; None if it is not known."""
        return None if label is None else self._lifetimes.get(label)

    def is_live_owner(self, owner: Hashable) -> bool:
        if isinstance(owner, Root):
            return owner.outcome is None
        return isinstance(owner, tuple) and owner[1] in self.failed

    @property
    def restoring(self) -> bool:
        """Is what the journal says still coming to life?"""
        return self._life.restoring

    def commands(self) -> int:
        """How many basic processes run, but for those that end with the present step."""
        return 0 if self.executer.killing else self.executer.statistics().basic_running

    def over_budget(self) -> str | None:
        live, most = self.executer.processes_live, self.budgets.processes + len(self.executer.roots)
        return f"{live} processes live, at most {most}" if live > most else None

    @property
    def versions(self) -> dict[str, int]:
        """The version of each situation that ever was: how often it was changed."""
        return dict(self.journal.state.committed.versions)

    def text(self) -> str:
        """The reactor as a program that can be run: equation (3) with its present reactions."""
        return text_of(self.reactions)
