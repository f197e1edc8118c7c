"""From refinements to adaptations: what is new, what goes, which monitors come and go (R §7.2, §8.3).

An `Issuer` compares a draft (one situation planned anew, with the sub-situations that are new) with the
model, writes the difference as one adaptation, and records it in the model at once; if the reactor does not
apply it, everything is taken back. Labels and ids are never used twice. While an adaptation is under way
the situations that it touches are held back.
"""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from planner_reactor.link.messages import Adaptation, Change, Mode
from planner_reactor.logic.formulas import Atom
from planner_reactor.planner import reactions
from planner_reactor.planner.beliefs import Beliefs
from planner_reactor.planner.drafts import Draft
from planner_reactor.planner.model import Model, Segment
from planner_reactor.planner.sheets import Sheets
from planner_reactor.planner.situations import Situation
from planner_reactor.planner.structure import Action
from planner_reactor.rs.printer import show

MOST_REFUSALS = 5
"""So often in a row the reactor may refuse what is planned for a situation, or for none."""
Monitor = tuple[str, str]
"""ASSUMONITOR or HOLDMONITOR, and the assumption that it watches."""


class Stranger(msgspec.Struct, frozen=True):
    """A standing reaction that nobody here issued: what it serves (or ""), and by which labels that is asserted."""

    situation: str
    asserted_by: frozenset[int] = frozenset()


class UnderWay(msgspec.Struct, frozen=True):
    """An adaptation that was issued and not yet answered, and how to take it back."""

    adaptation: Adaptation
    segment: Situation | None
    touched: frozenset[Situation]
    before: tuple[tuple[Situation, Segment | None], ...]
    monitors: dict[Monitor, int]
    withdrawn: tuple[Situation, int | None] | None = None  # a goal, and the label of what asserted it
    strangers: Mapping[int, Stranger] = {}  # of the reactions that it removes


class Difference(msgspec.Struct, frozen=True):
    """What a draft touches in the reactor, and what it leaves without a caller."""

    touched: frozenset[Situation]
    gone: tuple[Segment, ...]


class _Parts(msgspec.Struct, eq=False):
    """What one adaptation consists of, while it is put together."""

    clauses: dict[int, str] = msgspec.field(default_factory=dict)
    kills: list[int] = msgspec.field(default_factory=list)
    changes: list[Change] = msgspec.field(default_factory=list)
    removed: list[str] = msgspec.field(default_factory=list)
    adds: list[int] = msgspec.field(default_factory=list)  # top-down
    given_up: tuple[str, ...] = ()
    strangers: dict[int, Stranger] = msgspec.field(default_factory=dict)
    mode: Mode | None = None  # where roots go, which no other mode than drain can hold back


class Issuer:
    """Issues adaptations for a model; `under_way` holds those that the reactor has not answered."""

    def __init__(
        self, model: Model, fold: bool, stub_ms: int, period_ms: int | None, mode: Mode, epoch: int = 0
    ) -> None:
        self.model = model
        self.fold = fold
        self.stub_ms = stub_ms
        self.period_ms = period_ms
        self.mode: Mode = mode
        self.epoch = epoch
        self.next_label = 0
        self.next_id = 1
        self.monitors: dict[Monitor, int] = {}
        self.requests: dict[Atom, int] = {}
        self.under_way: dict[int, UnderWay] = {}
        self.introduced: list[Segment] = []  # by the last issue, and still stubs
        self.refused_alone = 0  # adaptations of no situation that were not applied, in a row
        self.sheets = Sheets(model.names, fold)
        self.strays: list[int] = []  # monitors that were to be removed, and are still there
        self.strangers: dict[int, Stranger] = {}  # by label, top-down
        self._watched: object = None  # for which assumptions the monitors are as they should be

    # ------------------------------------------------------------------------------------- what may go out

    def holder(self, situations: frozenset[Situation]) -> int | None:
        """The adaptation under way that touches any of these, if one does."""
        return next((n for n, flight in self.under_way.items() if not flight.touched.isdisjoint(situations)), None)

    def difference(self, draft: Draft) -> Difference:
        """All situations that the draft would change, remove, or newly refer to."""
        segments, own = self.model.segments, draft.segment.situation
        gone = self.model.orphans(draft.segment, draft.refinements[own].children)
        touched = {own, *draft.refinements}
        for refinement in draft.refinements.values():
            for child in refinement.children:
                segment = segments.get(child.situation)
                if segment is None or segment.version == 0:
                    touched.add(child.situation)
        for orphan in gone:
            touched.add(orphan.situation)
            touched.update(self.model.callers(orphan.situation))
        return Difference(frozenset(touched), tuple(gone))

    def issue(
        self, draft: Draft, difference: Difference, beliefs: Beliefs, holding: Mapping[str, int]
    ) -> Adaptation | None:
        """Record the draft in the model and write the adaptation; None if nothing in the reactor
        has to change.
        """
        segment, model = draft.segment, self.model
        refinement = draft.refinements[segment.situation]
        text = self.sheets.reaction(refinement)
        new = self._new(draft)
        before = tuple(model.snapshot([segment.situation, *new, *(o.situation for o in difference.gone)]))
        first = segment.label is None
        same = not first and text == segment.text
        told = segment.required
        used = frozenset(model.uses)
        parts = _Parts()
        if model.roots.get(segment.situation, 0) is None:
            root = reactions.root(segment.situation, model.names, model.instead.get(segment.situation, ()))
            model.roots[segment.situation] = self._add(parts, show(root))
        model.put(segment, refinement)
        if not same:
            self._replace(parts, segment, text)
        if not same or told != refinement.required:
            assumptions = tuple(sorted(refinement.required))
            parts.changes.append(
                Change(situation=segment.name, base=segment.version, assumptions=assumptions, fresh=first)
            )
        self.introduced = []
        for situation, path in new.items():
            self._introduce(parts, situation, path, draft)
        for orphan in difference.gone:
            if orphan.label is not None:
                parts.kills.append(orphan.label)
            parts.removed.append(orphan.name)
            model.remove(orphan)
        if self.strangers:
            self._leave_strangers(parts, {*parts.kills})
        monitors = dict(self.monitors)
        self._watch(parts, beliefs, {a: n for a, n in holding.items() if a not in model.uses})
        return self._send(parts, draft, difference.touched, before, monitors, used)

    def withdraw(self, root: Situation, beliefs: Beliefs, holding: Mapping[str, int]) -> Adaptation | None:
        """An adaptation that takes a goal away, with all that stands for it alone; None if something holds it."""
        gone = self.model.left_by(root)
        touched = frozenset(s.situation for s in gone)
        if self.holder(touched) is not None:
            return None
        parts, monitors, used = _Parts(mode="drain"), dict(self.monitors), frozenset(self.model.uses)
        before = tuple(self.model.snapshot([s.situation for s in gone]))
        label = self.model.roots.pop(root)
        parts.kills += [label] if label is not None else []
        for segment in gone:
            parts.kills += [segment.label] if segment.label is not None else []
            parts.removed.append(segment.name)
            self.model.remove(segment)
        self._watch(parts, beliefs, {a: n for a, n in holding.items() if a not in self.model.uses})
        adaptation = self._send(parts, None, touched, before, monitors, used, f"withdraw goal {root.schema}")
        assert adaptation is not None  # the goal's own reaction goes, at least
        self.under_way[adaptation.id] = msgspec.structs.replace(
            self.under_way[adaptation.id], withdrawn=(root, label)
        )
        return adaptation

    def remove_strangers(self, beliefs: Beliefs, holding: Mapping[str, int]) -> Adaptation | None:
        """An adaptation without the reactions that nobody here issued; None if there are none, or they stay."""
        if not self.strangers or self.under_way or self.refused_alone >= MOST_REFUSALS:
            return None
        parts, monitors, used = _Parts(mode="drain"), dict(self.monitors), frozenset(self.model.uses)
        parts.strangers, self.strangers = self.strangers, {}
        parts.kills += parts.strangers
        parts.removed += [stranger.situation for stranger in parts.strangers.values() if stranger.situation]
        self._watch(parts, beliefs, holding)
        return self._send(parts, None, frozenset(), (), monitors, used, "remove what nobody planned")

    def anew(self) -> Issuer:
        """One that has issued nothing, with the same options."""
        return Issuer(Model(), self.fold, self.stub_ms, self.period_ms, self.mode, self.epoch)

    def reconcile(
        self, beliefs: Beliefs, holding: Mapping[str, int], asked: Mapping[Atom, Action]
    ) -> Adaptation | None:
        """An adaptation for monitors and perception requests alone, if any are missing or left over."""
        if self.refused_alone >= MOST_REFUSALS:
            return None
        parts, monitors, used = _Parts(), dict(self.monitors), frozenset(self.model.uses)
        self._watch(parts, beliefs, holding)
        for atom, action in asked.items():
            if atom not in self.requests:
                label = self._add(parts, show(reactions.request(action, atom.predicate, atom.arguments)))
                self.requests[atom] = label
        return self._send(parts, None, frozenset(), (), monitors, used)

    # ------------------------------------------------------------------------------------------- its parts

    def _new(self, draft: Draft) -> dict[Situation, tuple[int, ...]]:
        """The situations that are not in the model with their paths, a parent before its children."""
        found: dict[Situation, tuple[int, ...]] = {}
        waiting = [(draft.segment.situation, draft.segment.path)]
        while waiting:
            situation, path = waiting.pop(0)
            if situation not in self.model.segments and situation not in found:
                found[situation] = path
            refinement = draft.refinements.get(situation)
            if refinement is not None:
                below = dict.fromkeys(child.situation for child in refinement.children)
                waiting = [*((s, (*path, n)) for n, s in enumerate(below) if s not in found), *waiting]
        found.pop(draft.segment.situation, None)
        return found

    def _add(self, parts: _Parts, text: str) -> int:
        label = self.next_label
        self.next_label += 1
        parts.clauses[label] = text
        parts.adds.append(label)
        return label

    def _leave_strangers(self, parts: _Parts, gone: set[int]) -> None:
        """What nobody here issued, and only what goes has asserted, goes with it."""
        staying = {segment.label for segment in self.model} | {*self.model.roots.values(), *self.strangers}
        for label, stranger in list(self.strangers.items()):
            if stranger.asserted_by & gone and not stranger.asserted_by & (staying - gone):
                parts.strangers[label] = self.strangers.pop(label)
                parts.kills.append(label)
                parts.removed.append(stranger.situation)
                gone.add(label)

    def _replace(self, parts: _Parts, segment: Segment, text: str) -> None:
        if segment.label is not None:
            parts.kills.append(segment.label)
        segment.text = text
        segment.label = self._add(parts, text)

    def _introduce(self, parts: _Parts, situation: Situation, path: tuple[int, ...], draft: Draft) -> None:
        refinement = draft.refinements.get(situation)
        segment = self.model.new(situation, self.model.context(situation, draft.drafted), path)
        self.model.put(segment, refinement)
        if refinement is None:
            text = self.sheets.stub(situation, self.stub_ms)
            segment.because = self.model.why(situation, draft.drafted)
            self.introduced.append(segment)
        else:
            text = self.sheets.reaction(refinement)
        segment.label = next((n for n, other in self.strangers.items() if other.situation == segment.name), None)
        fresh = segment.label is None
        if segment.label is not None:
            parts.strangers[segment.label] = self.strangers.pop(segment.label)
        self._replace(parts, segment, text)
        assumptions = tuple(sorted(segment.required))
        parts.changes.append(Change(situation=segment.name, base=segment.version, assumptions=assumptions, fresh=fresh))

    def _watch(self, parts: _Parts, beliefs: Beliefs, holding: Mapping[str, int]) -> None:
        """Bring the monitors into line with the assumptions in use.

        A HOLDMONITOR comes again when it is known to have gone: its going may be refused, and it would stand twice. An
        ASSUMONITOR does not wait for that, since something rests on what it watches.
        """
        parts.given_up = tuple(sorted(beliefs.relaxed))
        watched = (frozenset(self.model.uses), tuple(holding.items()))
        if watched == self._watched and not self.strays:
            return
        self._watched = watched
        wanted = self.wanted_monitors(beliefs, holding)
        coming = {label for flight in self.under_way.values() for label in flight.adaptation.adds}
        for monitor in [m for m in self.monitors if m not in wanted]:
            if self.monitors[monitor] in coming:
                self._watched = None  # it cannot go before it has come
            else:
                parts.kills.append(self.monitors.pop(monitor))
        parts.kills.extend(self.strays)
        self.strays.clear()
        going = {m for f in self.under_way.values() for m, n in f.monitors.items() if n in f.adaptation.kills}
        for (kind, name), period in wanted.items():
            if kind == "HOLDMONITOR" and (kind, name) in going:
                self._watched = None
            elif (kind, name) not in self.monitors:
                self.monitors[kind, name] = self._add(parts, show(reactions.monitor(kind, name, period)))

    def wanted_monitors(self, beliefs: Beliefs, holding: Mapping[str, int]) -> dict[Monitor, int]:
        """The monitors of what is in use, and of what may return, with their periods in ms."""
        wanted: dict[Monitor, int] = {}
        for name in sorted(self.model.used(), key=lambda n: (beliefs.assumption(n).likelihood, n)):
            declared = beliefs.assumption(name)
            if declared.monitor == "flag":
                wanted["ASSUMONITOR", name] = self.period_ms or declared.period_ms
        for name, patience in sorted(holding.items()):
            wanted["HOLDMONITOR", name] = patience * (self.period_ms or beliefs.assumption(name).period_ms)
        return wanted

    def _send(
        self,
        parts: _Parts,
        draft: Draft | None,
        touched: frozenset[Situation],
        before: tuple[tuple[Situation, Segment | None], ...],
        monitors: dict[Monitor, int],
        used: frozenset[str],
        purpose: str = "monitors and requests",
    ) -> Adaptation | None:
        if not (parts.changes or parts.kills or parts.adds):
            return None
        after = frozenset(self.model.uses)
        adaptation = Adaptation(
            id=self.next_id,
            epoch=self.epoch,
            definitions="".join([f"{reactions.clause(n, p)}\n" for n, p in sorted(parts.clauses.items())]),
            changes=tuple(parts.changes),
            removed=tuple(parts.removed),
            kills=tuple(parts.kills),
            adds=tuple(reversed(parts.adds)),
            mode=parts.mode or self.mode,
            purpose=draft.purpose if draft else purpose,
            drops=tuple(sorted(used - after)) if used != after else (),
            adopts=tuple(sorted(after - used)) if used != after else (),
            given_up=parts.given_up,
        )
        self.next_id += 1
        situation = draft.segment.situation if draft else None
        self.under_way[adaptation.id] = UnderWay(
            adaptation, situation, touched, before, monitors, strangers=parts.strangers
        )
        for situation in touched:
            if situation in self.model.segments:
                self.model.segments[situation].pending = adaptation.id
        return adaptation

    # ---------------------------------------------------------------------------------- what became of it

    def applied(self, number: int) -> UnderWay | None:
        """The reactor has applied it: versions rise, what was held back may go on."""
        flight = self.under_way.pop(number, None)
        if flight is None:
            return None
        self._release(flight)
        self.refused_alone = 0
        changed = {change.situation for change in flight.adaptation.changes}
        for situation in flight.touched:
            segment = self.model.segments.get(situation)
            if segment is not None and segment.name in changed:
                segment.version += 1
                segment.refusals = 0
        for situation, _ in flight.before:
            if self.model.names[situation] in flight.adaptation.removed:
                self.model.is_removed(situation)
        return flight

    def not_applied(self, number: int) -> UnderWay | None:
        """The reactor has applied nothing of it: the model is as it was before."""
        flight = self.under_way.pop(number, None)
        if flight is None:
            return None
        self._release(flight)
        self.refused_alone += flight.segment is None and flight.withdrawn is None
        self._watched = None
        self.model.restore(flight.before)
        mine = set(flight.adaptation.adds)
        for monitor, label in list(self.monitors.items()):
            if label in mine:
                del self.monitors[monitor]
        old = {label: monitor for monitor, label in flight.monitors.items()}
        self.strangers |= flight.strangers
        segments = {segment.label for _, segment in flight.before if segment is not None} | {*flight.strangers}
        if flight.withdrawn is not None:
            root, asserting = flight.withdrawn
            self.model.roots[root] = asserting
            segments.add(asserting)
        for label in flight.adaptation.kills:
            if label in old and old[label] not in self.monitors:
                self.monitors[old[label]] = label
            elif label not in segments:
                self.strays.append(label)
        for atom, label in list(self.requests.items()):
            if label in mine:
                del self.requests[atom]
        return flight

    def _release(self, flight: UnderWay) -> None:
        for situation in flight.touched:
            segment = self.model.segments.get(situation)
            if segment is not None and segment.pending == flight.adaptation.id:
                segment.pending = None
