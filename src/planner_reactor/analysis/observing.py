"""What can be said of one moment of a run: the atoms of properties, over situations, ports, processes and outcomes.

A moment is a state and the step that leaves it. `asserted`, `succeeded`, `sent` and the like tell of the step, `on`,
`inhibited`, `running` and the like of the state before it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal, TypeAlias

import msgspec

from planner_reactor.rs.configurations import Config, Label
from planner_reactor.rs.leaves import Step
from planner_reactor.rs.states import Ended, Leaf
from planner_reactor.rs.store import Store
from planner_reactor.rs.terms import Value

Subject: TypeAlias = Literal["situation", "process", "port", "label", "symbol", "outcome", "nothing"]
"""What an atom speaks of."""


class Atom(msgspec.Struct, frozen=True):
    """`word name[arguments]`; without arguments it holds for any."""

    word: str
    name: Value = ""
    arguments: tuple[Value, ...] | None = None

    def __str__(self) -> str:
        called = f"{self.word} {_shown(self.name)}" if self.name != "" else self.word
        return called if self.arguments is None else f"{called}[{', '.join(map(_shown, self.arguments))}]"


def _shown(value: Value) -> str:
    return f'"{value}"' if isinstance(value, str) and not value.isidentifier() else str(value)


STATES: dict[str, tuple[Subject, str]] = {
    "on": ("situation", "an instance of it is on"),
    "serving": ("situation", "a body of it is in service"),
    "inhibited": ("situation", "it is inhibited"),
    "queued": ("situation", "an ASSERT of it is held back"),
    "quiescent": ("situation", "it has no instance on or in service"),
    "running": ("process", "such a basic or built-in process has begun and not ended"),
    "ended": ("outcome", "all has ended, what was started first with this outcome (stop, abort; or any)"),
    "stuck": ("nothing", "nothing can happen any more, though not all has ended"),
}
"""What is true of a state: word, what it speaks of, what it says."""

EVENTS: dict[str, tuple[Subject, str]] = {
    "asserted": ("situation", "somebody asserts it, now or once it is no longer held back"),
    "served": ("situation", "a SIT delivers an instance of it"),
    "succeeded": ("situation", "an instance of it ends as succeeded"),
    "failed": ("situation", "an instance of it ends as failed, for whatever cause"),
    "stubbed": ("situation", "a STUB of it is reached"),
    "stopped": ("process", "such a basic process stops"),
    "aborted": ("process", "such a basic process aborts"),
    "sent": ("port", "a value passes through it"),
    "killed": ("label", "the reaction with this guard is removed"),
    "posted": ("label", "the reaction with this guard is added"),
    "reported": ("symbol", "it is reported"),
    "tick": ("nothing", "time passes"),
}
"""What is true of a step."""

WORDS = {**EVENTS, **STATES}


def seen(atoms: Sequence[Atom], before: Config, step: Step) -> int:
    """A bit for each atom that is true at this moment."""
    bits = 0
    for number, atom in enumerate(atoms):
        if atom.word in EVENTS:
            true = _EVENT[atom.word](atom, before.store, step.label, step.after.store)
        else:
            true = atom.word != "stuck" and _STATE[atom.word](atom, before)
        bits |= true << number
    return bits


def seen_at_rest(atoms: Sequence[Atom], state: Config) -> int:
    """The same where nothing happens any more: no event is true."""
    return sum(_STATE[atom.word](atom, state) << n for n, atom in enumerate(atoms) if atom.word in STATES)


# ------------------------------------------------------------------------------------------------------- events


def _fits(atom: Atom, arguments: tuple[Value, ...]) -> bool:
    return atom.arguments is None or arguments[: len(atom.arguments)] == atom.arguments


def _about(label: Label, names: tuple[str, ...], atom: Atom, statuses: tuple[str, ...] = ("ok", "wait")) -> bool:
    name, arguments, status, _ = label
    return name in names and status in statuses and arguments[:1] == (atom.name,) and _fits(atom, arguments[1:])


def _ends(atom: Atom, before: Store, label: Label, after: Store, *, ok: bool) -> bool:
    """Is an instance of the situation on before the step, and has it ended so after it? What has ended may be gone."""
    for old in before.instances:
        if old.situation == atom.name and old.status == "on" and _fits(atom, old.arguments):
            new = after.get(old.number)
            if new is None:
                told = label[0] == "SUCCEED" and label[1] == (old.situation, old.number) and not old.withdrawn
                status = "ok" if told else "ab"
            else:
                status = new.status
            if status == ("ok" if ok else "ab"):
                return True
    return False


def _of_process(atom: Atom, label: Label, status: str) -> bool:
    return label[0] == atom.name and label[2] == status and _fits(atom, label[1])


_EVENT: dict[str, Callable[[Atom, Store, Label, Store], bool]] = {
    "asserted": lambda atom, before, label, after: _about(label, ("ASSERT", "REASSERT"), atom, ("wait",)),
    "served": lambda atom, before, label, after: _about(label, ("SIT",), atom),
    "succeeded": lambda atom, before, label, after: _ends(atom, before, label, after, ok=True),
    "failed": lambda atom, before, label, after: _ends(atom, before, label, after, ok=False),
    "stubbed": lambda atom, before, label, after: _about(label, ("STUB",), atom),
    "stopped": lambda atom, before, label, after: _of_process(atom, label, "ok"),
    "aborted": lambda atom, before, label, after: _of_process(atom, label, "ab"),
    "sent": lambda atom, before, label, after: _about(label, ("COM",), atom),
    "killed": lambda atom, before, label, after: _about(label, ("KILL",), atom),
    "posted": lambda atom, before, label, after: _about(label, ("POST",), atom),
    "reported": lambda atom, before, label, after: _about(label, ("REPORT",), atom),
    "tick": lambda atom, before, label, after: label[0] == "TIME",
}

# ------------------------------------------------------------------------------------------------------- states


def _instances(atom: Atom, state: Config, status: str = "") -> bool:
    return any(
        i.situation == atom.name and _fits(atom, i.arguments) and status in ("", i.status)
        for i in state.store.instances
    )


def _serving(atom: Atom, state: Config) -> bool:
    found = (state.store.get(number) for number, _ in state.store.run)
    return any(i is not None and i.situation == atom.name and _fits(atom, i.arguments) for i in found)


def _queued(atom: Atom, state: Config) -> bool:
    return any(q.situation == atom.name and q.fate is None and _fits(atom, q.arguments) for q in state.store.queue)


def _running(atom: Atom, state: Config) -> bool:
    leaves = (spot.leaf for spot in state.spots())
    return any(isinstance(i, Leaf) and i.name == atom.name and _fits(atom, i.arguments) for i in leaves)


def _ended(atom: Atom, state: Config) -> bool:
    outcomes = [term.ok for _, term in state.roots if isinstance(term, Ended)]
    return len(outcomes) == len(state.roots) and atom.name in ("", "stop" if outcomes[0] else "abort")


_STATE: dict[str, Callable[[Atom, Config], bool]] = {
    "on": lambda atom, state: _instances(atom, state, "on"),
    "serving": _serving,
    "inhibited": lambda atom, state: state.store.inhibited(str(atom.name)),
    "queued": _queued,
    "quiescent": lambda atom, state: not _instances(atom, state),
    "running": _running,
    "ended": _ended,
    "stuck": lambda atom, state: not _ended(Atom("ended"), state),  # asked only where nothing leaves the state
}
