"""A planner that begins anew on a reactor that stands (R §7.1: R_t is what the reactor is, not what was once planned).

Plans are a function of the domain and the assumptions held, texts a function of plans. So the planner plans the reactor
for the assumptions that the standing one implies, to the end and without issuing anything, and compares: a situation
whose reaction has the text and rests on the assumptions that it should is taken over as it stands; one that has not is
planned again, by the ordinary way; what the plan does not know is removed once nothing asserts it.

All this happens in short steps, in an epoch of its own, while the reactor goes on.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from msgspec.structs import replace

from planner_reactor.link.messages import Standing
from planner_reactor.planner import reactions
from planner_reactor.planner.agenda import QUIESCENT
from planner_reactor.planner.because import Because
from planner_reactor.planner.beliefs import Beliefs
from planner_reactor.planner.foresight import shadow_of
from planner_reactor.planner.issuing import Monitor, Stranger
from planner_reactor.planner.model import Segment
from planner_reactor.planner.reducing import Reducer
from planner_reactor.planner.situations import Refinement
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.printer import show
from planner_reactor.rs.reactions import Reaction, reaction_of
from planner_reactor.rs.terms import Call, Number, Symbol, Text


class Reactions:
    """The reactions of a standing reactor, by what they are for."""

    def __init__(self, clauses: Mapping[int, str]) -> None:
        program = parse_program("\n".join(clauses.values()), file="<standing>")
        self.all = {r.label: r for r in map(reaction_of, program.schemas) if r is not None}
        self.texts = {label: show(reaction.schema.body) for label, reaction in self.all.items()}
        self.serving = {r.situation: r.label for r in self.all.values() if r.situation is not None}

    @property
    def monitors(self) -> dict[int, tuple[Monitor, int]]:
        """By label: what watches which assumption, and its period in ms."""
        found = {}
        for label, reaction in self.all.items():
            match reaction.schema.body:
                case Call(kind, (Symbol(name) | Text(name), Number(int() as period))) if reaction.monitors:
                    found[label] = (kind, name), period
        return found

    @property
    def watched(self) -> dict[str, int]:
        """Failed assumptions whose return is watched for, and the period in ms."""
        return {name: period for (kind, name), period in self.monitors.values() if kind == "HOLDMONITOR"}

    def asserting(self, situation: str | None) -> frozenset[int]:
        """The labels of what asserts a situation."""
        return frozenset(label for label, reaction in self.all.items() if situation in reaction.asserts)

    def top_down(self, labels: Iterable[int]) -> list[Reaction]:
        """These, whoever asserts a situation before what serves it."""
        wanted, done = {self.all[n] for n in labels}, dict[Reaction, None]()

        def visit(reaction: Reaction) -> None:
            if reaction not in done:
                for name in reaction.asserts:
                    if name in self.serving:
                        visit(self.all[self.serving[name]])
                done[reaction] = None

        for reaction in sorted(wanted, key=lambda r: r.label):
            visit(reaction)
        return [reaction for reaction in reversed(done) if reaction in wanted]


class Resumption:
    """Brings the model of `reducer`, which has issued nothing, in line with what stands."""

    def __init__(self, reducer: Reducer, standing: Standing) -> None:
        self.reducer = reducer
        self.standing = standing
        self._reactions = Reactions(standing.clauses)
        self._shadow: Reducer | None = None
        self._beliefs: Beliefs | None = None
        issuer, model = reducer.issuer, reducer.model
        issuer.epoch, issuer.next_label = standing.epoch, standing.highest_label + 1
        model.former = standing.versions
        reducer.assuming.take_over(standing.given_up, standing.failed, self._reactions.watched)

    def step(self) -> bool:
        """One short piece of work; False if that was the last."""
        beliefs = self.reducer.assuming.beliefs
        if self._shadow is None or self._beliefs != beliefs:  # not begun, or what it was about has changed
            self._shadow, self._beliefs = shadow_of(self.reducer, beliefs, self.reducer.model.names), beliefs
        step = self._shadow.step()
        if step is None:
            self._take_over(self._shadow)
            return False
        for adaptation in step.adaptations:
            self._shadow.applied(adaptation.id)
        return True

    # -- what is taken over

    def _take_over(self, shadow: Reducer) -> None:
        reducer, found = self.reducer, self._reactions
        known: set[int] = set()
        different = []
        for planned in shadow.model:
            label = found.serving.get(planned.name)
            if label is not None:
                known.add(label)
                if not self._same(planned, label):
                    different.append(planned)
                else:
                    self._put(planned, label, planned.refinement)
        accounted = {name for segment in reducer.model for name in segment.in_use}
        for planned in different:
            self._put(planned, found.serving[planned.name], self._as_it_stands(planned, accounted))
        self._roots(known)
        self._monitors(known)
        strangers = found.top_down(n for n, r in found.all.items() if n not in known and (r.situation or r.asserts))
        reducer.issuer.strangers = {
            r.label: Stranger(r.situation or "", found.asserting(r.situation)) for r in strangers
        }
        again = [reducer.model.segments[planned.situation] for planned in different]
        reducer.mark(again, QUIESCENT, Because("standing", f"epoch {self.standing.epoch}"))
        reducer.counts["taken_over"] = len(reducer.model.segments) - len(different)

    def _same(self, planned: Segment, label: int) -> bool:
        rests_on = self.standing.rests_on.get(planned.name, ())
        return self._reactions.texts[label] == planned.text and tuple(sorted(planned.required)) == rests_on

    def _as_it_stands(self, planned: Segment, accounted: set[str]) -> Refinement | None:
        """What is known of a reaction that is not the planned one: nothing if it is a stub, else what it rests on.

        What it brings in besides is not told: all that is in use and that no other accounts for, so that it is watched
        for as long as this stands.
        """
        issuer = self.reducer.issuer
        text = self._reactions.texts[self._reactions.serving[planned.name]]
        if planned.refinement is None or text == issuer.sheets.stub(planned.situation, issuer.stub_ms):
            return None
        rests_on = frozenset(self.standing.rests_on.get(planned.name, ()))
        return replace(planned.refinement, required=rests_on, in_use=rests_on | {*self.standing.adopted} - accounted)

    def _put(self, planned: Segment, label: int, refinement: Refinement | None) -> None:
        segment = replace(
            planned, label=label, text=self._reactions.texts[label], version=self.standing.versions[planned.name],
            pending=None, because=(), refinement=None,
        )  # fmt: skip
        self.reducer.model.put(segment, refinement)

    def _roots(self, known: set[int]) -> None:
        model = self.reducer.model
        for root in list(self.reducer.starts):
            if root in model.segments:
                text = show(reactions.root(root, model.names, model.instead.get(root, ())))
                label = next((n for n, found in self._reactions.texts.items() if found == text), None)
                del self.reducer.starts[root]
                model.roots[root] = label
                known.update([] if label is None else [label])

    def _monitors(self, known: set[int]) -> None:
        issuer, beliefs = self.reducer.issuer, self.reducer.assuming.beliefs
        wanted = issuer.wanted_monitors(beliefs, self.reducer.assuming.watched)
        for label, (monitor, period) in self._reactions.monitors.items():
            if monitor in issuer.monitors or wanted.get(monitor) != period:
                issuer.strays.append(label)
            else:
                issuer.monitors[monitor] = label
            known.add(label)


def begun_anew(before: Reducer) -> Reducer:
    """A reducer for the same goals that has issued nothing; what was worked out is remembered."""
    issuer = before.issuer.anew()
    reducer = Reducer(before.theory, issuer.model, issuer, before.assuming, before.counts, before.convergence)
    reducer.sizing = before.sizing
    reducer.memory = before.memory
    for root in before.model.roots:
        if root not in before.leaving:
            reducer.pursue(root.schema)
    return reducer
