"""What sets a change off: a goal, a stub, an assumption, a perception, or what became of another adaptation."""

from __future__ import annotations

from typing import Literal, TypeAlias

import msgspec

Trigger: TypeAlias = Literal[
    "goal", "caller", "context", "normal", "forced", "reinstated", "stub_trigger", "situation_failure", "information",
    "impossible", "adaptation_refused", "adaptation_timed_out", "domain", "withdrawn", "standing",
]  # fmt: skip

_SAID: dict[Trigger, str] = {
    "goal": "{} is a goal",
    "caller": "{} asserts it",
    "context": "{} was planned again, and what it may count on has changed",
    "normal": "{} is relaxed",
    "forced": "{} has failed",
    "reinstated": "{} holds again",
    "stub_trigger": "{} is active and has only a stub",
    "situation_failure": "{} has failed",
    "information": "{} is known now",
    "impossible": "there is no plan for {}",
    "adaptation_refused": "adaptation {} was refused",
    "adaptation_timed_out": "adaptation {} took too long",
    "domain": "there is another text, {}",
    "withdrawn": "{} is no longer a goal",
    "standing": "what stands is otherwise than planned, in {}",
}


class Because(msgspec.Struct, frozen=True):
    """One trigger: a situation, an assumption, a goal, a condition or an adaptation is its `subject`; `perception` is
    the number of the one that told of it, if one did.
    """

    trigger: Trigger
    subject: str
    perception: int | None = None

    def __str__(self) -> str:
        said = _SAID[self.trigger].format(self.subject)
        return said if self.perception is None else f"{said} (perception {self.perception})"
