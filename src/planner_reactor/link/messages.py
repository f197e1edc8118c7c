"""What passes between planner and reactor: adaptations one way, perceptions the other (R Fig. 1, Fig. 3).

Both are plain data, so that the two sides can live in one process or on two machines. An `Adaptation` is one
transaction: RS definitions, and which guards to kill and which labels to add, for the situations that it changes.
A `Perception` is one numbered report; repeats of the same report are coalesced into one with a count.

Times are seconds on the sender's clock. Field names are the wire format: they may be added to, never renamed.
"""

from __future__ import annotations

from typing import Literal

import msgspec

Mode = Literal["wait", "drain", "versions"]

PerceptionKind = Literal[
    "guard_kill",  # R §7.3 (1): a reaction was removed; subject = its label
    "stub_trigger",  # R §7.3 (2): an unrefined situation is active; subject = the situation
    "situation_failure",  # R §7.3 (3): an instance ended as failed; subject = the situation, cause says why
    "assumption_failure",  # R §7.3 (4): a monitor or a process reports it false; subject = the assumption
    "assumption_holds",  # a failed assumption holds again (R §9.2.3, reinstating); subject = the assumption
    "assumption_unknown",  # its sensor says nothing of worth; cause = stale, stuck or unsensed
    "adaptation_applied",  # subject = the adaptation's id
    "adaptation_refused",  # nothing of it was applied; cause says why
    "adaptation_timed_out",  # it exceeded its bound: nothing of it was applied, nothing is inhibited
    "restarted",  # the reactor begins again on its journal; subject = sound or damaged, values = (situation, version)…
    "halted",  # the stop button was pressed: nothing acts, and adaptations are refused, until a reset
    "storm",  # a situation failed too often and is disabled, or the reactor halted; subject = the situation
    "information",  # data the planner asked for (ΔP, R §7.1); subject = the name asked for
    "error",  # a wrong request, e.g. a guard that is not there
]


class Change(msgspec.Struct, frozen=True, kw_only=True):
    """What an adaptation does to one situation.

    `base` is the version that it was planned against (0 = the situation has no reaction yet); `assumptions` are
    those that the new reactions rest on (a failed assumption disables exactly the situations that name it);
    `fresh` marks a situation that did not exist, so that nothing of it needs to be waited for. Where the new reactions
    take other parameters, `migrate` says what becomes of the arguments of an ASSERT that waits for it, one entry for
    each new parameter: the place of an old argument, from 1, or the name of a function of all the old ones.
    """

    situation: str
    base: int
    assumptions: tuple[str, ...] = ()
    fresh: bool = False
    migrate: tuple[int | str, ...] | None = None


class Adaptation(msgspec.Struct, frozen=True, kw_only=True):
    """One safe change of the reactor (R §5.5): checked whole, then applied whole or not at all.

    `definitions` is RS text: clauses `P[n] = …` for exactly the labels in `adds`. `changes` is top-down (a parent
    before its children); `kills` top-down, `adds` bottom-up, as in R §5.5. `removed` names situations that have no
    reaction left afterwards. `purpose` says why in the planner's words (goal, refinement, relaxation).
    """

    id: int
    epoch: int = 0
    definitions: str = ""
    changes: tuple[Change, ...] = ()
    removed: tuple[str, ...] = ()
    kills: tuple[int, ...] = ()
    adds: tuple[int, ...] = ()
    mode: Mode = "drain"
    deadline: float | None = None
    purpose: str = ""
    drops: tuple[str, ...] = ()  # assumptions that no reaction rests on any more once this is applied
    adopts: tuple[str, ...] = ()  # assumptions that a reaction rests on for the first time once this is applied
    given_up: tuple[str, ...] | None = None  # assumptions that the planner does without by now; None: it does not say


class Perception(msgspec.Struct, frozen=True, kw_only=True):
    """One report of the reactor. `number` counts from 1 without gaps; `count` says how often it was repeated."""

    number: int
    time: float
    kind: PerceptionKind
    subject: str
    cause: str = ""
    instance: int | None = None
    values: tuple[object, ...] = ()
    count: int = 1
    epoch: int = 0  # of the adaptation that it answers


class Enquiry(msgspec.Struct, frozen=True, kw_only=True):
    """A planner that begins asks how the reactor stands. What older planners have under way is taken back."""

    enquirer: int


class Standing(msgspec.Struct, frozen=True, kw_only=True):
    """The answer to an `Enquiry`: the structure of the reactor, and the `epoch` that the enquirer shall plan in.

    No other planner has it, and from now on adaptations of older epochs are refused. `clauses` are texts `P[n] = …` in
    canonical print; `given_up` is what the latest planner said that it does without.
    """

    enquirer: int
    epoch: int
    clauses: dict[int, str] = {}
    versions: dict[str, int] = {}
    rests_on: dict[str, tuple[str, ...]] = {}
    adopted: tuple[str, ...] = ()
    failed: tuple[str, ...] = ()
    given_up: tuple[str, ...] = ()
    highest_label: int = -1
    halted: bool = False
