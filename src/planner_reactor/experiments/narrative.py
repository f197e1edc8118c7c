"""Tells a run while it goes on, to somebody who has never seen one: who rewrites what, and what comes out.

A sink of the trace: one short line for each thing worth telling, with its time and who did it. What the world's own
events mean is asked of the world's side.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from planner_reactor.trace import Event

Say = Callable[[float, str, str], object]
"""Time in seconds, who, what."""


@dataclass(slots=True)
class Narrator:
    """`meaning`: what each assumption says; `told`: words for an event of the world, or None."""

    say: Say
    meaning: Mapping[str, str] = field(default_factory=dict)
    told: Callable[[Event], str | None] = lambda event: None
    _issued: dict[int, Event] = field(default_factory=dict)
    _acting: bool = False
    _ideal: bool = False
    _failing: set[str] = field(default_factory=set)
    _used: int = 0

    def begin(self) -> None:
        """Before the first event."""
        self.say(0.0, "reactor", "is running, and empty: the robot does nothing yet")
        self.say(0.0, "planner", "begins to think about its goal")

    def __call__(self, event: Event) -> None:
        """One event of the trace."""
        match event.kind:
            case "adaptation_issued":
                self._issued[event.data["id"]] = event
                self._used = len(event.data["assumptions"])
            case "adaptation_applied":
                self._applied(event)
            case "entered" if not self._acting:
                self._acting = True
                self.say(event.time, "reactor", "begins to act; the planner goes on thinking")
            case "ideal":
                self._ideal = True
                text = f"is complete, as long as {self._used} assumptions hold: the first ideal reactor"
                self.say(event.time, "reactor", text)
            case "relaxation":
                self._decided(event)
            case "assumption_failure":
                self._failed(event)
            case "stub_trigger" if not self._ideal:
                self.say(event.time, "reactor", f"has reached {event.data['situation']}, which is not refined yet")
            case _:
                if (happened := self.told(event)) is not None:
                    self.say(event.time, "world", happened)

    def _applied(self, event: Event) -> None:
        sent = self._issued[event.data["id"]]
        lag = event.time - sent.time
        waited = f", {lag:.0f} s after it was issued: nothing is interrupted" if lag >= 1 else ""
        situations = list(sent.data["situations"])
        first = len(self._issued) == 1
        if first:
            stubs = [s for s in situations if f"STUB[{s}]" in sent.data["text"]]
            still = f"; {' and '.join(stubs)} are stubs still" if stubs else ""
            self.say(sent.time, "planner", f"sends its first adaptation, {len(sent.data['adds'])} reactions{still}")
        elif situations:
            self.say(event.time, "reactor", f"{situations[0]} is rewritten{self._why(sent)}{waited}")

    def _why(self, sent: Event) -> str:
        assumption, cause = sent.data["assumption"], sent.data["cause"]
        if not assumption:
            return ""
        return f" to rely on {assumption} again" if cause == "reinstated" else f" not to need {assumption}"

    def _decided(self, event: Event) -> None:
        name, cause = event.data["assumption"], event.data["cause"]
        means = self._means(name)
        text = {
            "normal": f"has time to do without {name}{means}",
            "forced": f"must do without {name}{means}",
            "reinstated": f"takes {name}{means} back: the simpler program returns",
        }[cause]
        self.say(event.time, "planner", text)

    def _failed(self, event: Event) -> None:
        name = event.data["assumption"]
        if name not in self._failing:
            self._failing.add(name)
            text = f"signals that {name}{self._means(name)} does not hold; what needs it waits"
            self.say(event.time, "reactor", text)

    def _means(self, name: str) -> str:
        return f" (“{self.meaning[name]}”)" if name in self.meaning else ""
