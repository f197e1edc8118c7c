"""The reactor as it stood at an instant, rebuilt from the trace of its run.

A `Snapshot` holds its reactions, what each situation rests on, and for the sake of which assumption each situation
and each process in it came in. `reactor_at` reads it off the events; `of` takes it from a live reactor (which does
not know the history). Both give the same reactions at the same instant.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import msgspec

from planner_reactor.reactor.reactor import Reactor
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.reactions import Reaction, reaction_of
from planner_reactor.rs.terms import Call, Number, Symbol, Text, calls
from planner_reactor.trace import Event


class Snapshot(msgspec.Struct, frozen=True):
    """Reactions by label; `rests_on` and `because` by situation.

    `because[situation]` maps what it does (`deed`) to the assumption for whose relaxation it came in, and "" to the
    one for which the situation itself did. `watched`: the assumptions for whose failure a monitor watches.
    """

    reactions: Mapping[int, Reaction]
    rests_on: Mapping[str, tuple[str, ...]]
    because: Mapping[str, Mapping[str, str]] = msgspec.field(default_factory=dict)
    watched: tuple[str, ...] = ()


def of(reactor: Reactor) -> Snapshot:
    """A live reactor, now."""
    resting: dict[str, tuple[str, ...]] = {}
    for assumption in reactor.assumptions_in_use:
        for situation in reactor.resting_on(assumption):
            resting[situation] = (*resting.get(situation, ()), assumption)
    return Snapshot(dict(reactor.reactions), resting, {}, _watched(reactor.reactions.values()))


def reactor_at(events: Iterable[Event], time: float) -> Snapshot:
    """The reactor after everything that happened up to and at an instant (seconds)."""
    history = _History()
    for event in events:
        if event.time > time:
            break
        history.read(event)
    present = dict(sorted(history.present.items()))
    return Snapshot(present, history.rests_on, history.because, _watched(present.values()))


def deed(call: Call) -> str:
    """What a call does, whatever its variables are called: its name and its constants."""
    words = [call.name]
    for argument in call.arguments:
        match argument:
            case Symbol(name) | Text(name):
                words.append(name)
            case Number(value):
                words.append(str(value))
            case _:
                pass
    return " ".join(words)


class _History:
    """Follows adaptations: what was sent, and what of it is there."""

    def __init__(self) -> None:
        self.present: dict[int, Reaction] = {}
        self.rests_on: dict[str, tuple[str, ...]] = {}
        self.because: dict[str, dict[str, str]] = {}
        self._sent: dict[int, Event] = {}
        self._defined: dict[int, Reaction] = {}

    def read(self, event: Event) -> None:
        """Take one event into account."""
        match event.kind:
            case "adaptation_issued":
                self._sent[event.data["id"]] = event
                for schema in parse_program(event.data["text"], file=f"adaptation {event.data['id']}").schemas:
                    reaction = reaction_of(schema)
                    if reaction is not None:
                        self._defined[reaction.label] = reaction
            case "added":
                self.present[event.data["label"]] = self._defined[event.data["label"]]
            case "removed":
                self.present.pop(event.data["label"], None)
            case "adaptation_applied":
                self._applied(self._sent[event.data["id"]])
            case _:
                pass

    def _applied(self, sent: Event) -> None:
        for situation, assumptions in sent.data["rests_on"].items():
            self.rests_on[situation] = tuple(assumptions)
        relaxed = sent.data["assumption"] if sent.data["cause"] in ("normal", "forced") else ""
        for label in sorted(sent.data["adds"]):
            reaction = self._defined[label]
            if reaction.situation is not None:
                self._blame(reaction.situation, reaction, relaxed)
        for situation in sent.data["removed"]:
            self.rests_on.pop(situation, None)
            self.because.pop(situation, None)

    def _blame(self, situation: str, reaction: Reaction, relaxed: str) -> None:
        """What is new in this situation is there because of the assumption relaxed."""
        before = self.because.get(situation)
        deeds = {deed(call) for call in calls(reaction.schema.body)}
        if before is None:
            self.because[situation] = {"": relaxed, **dict.fromkeys(deeds, "")}
        else:
            self.because[situation] = {"": before[""], **{name: before.get(name, relaxed) for name in deeds}}


def _watched(reactions: Iterable[Reaction]) -> tuple[str, ...]:
    """The assumptions whose failure a monitor watches for, in the order of its label."""
    ordered = sorted(reactions, key=lambda r: r.label)
    return tuple(dict.fromkeys(a for r in ordered if _is_assumonitor(r) for a in r.monitors))


def _is_assumonitor(reaction: Reaction) -> bool:
    return any(call.name == "ASSUMONITOR" for call in calls(reaction.schema.body))
