"""May this adaptation be applied? Decided before it is issued (R §5.5: consistent, safe, bounded, atomic, local).

A `Verifier` takes the reactor as it stands, what comes, and the surgery. It looks at every way in which the slice of
the reactor that matters (`slicing`) and the script can go on (`protocols`), and works out the bound in seconds from
the windows of the basic processes (`rs.bounds`). Slices are the same up to names for adaptations of one shape, and are
looked at once; what adds to nothing needs no look at all.
"""

from __future__ import annotations

import re
from collections.abc import Hashable, Iterable, Sequence
from math import inf, isinf

from planner_reactor.analysis.exchanges import is_exchange
from planner_reactor.analysis.forms import Known
from planner_reactor.analysis.looking import Looking, finish
from planner_reactor.analysis.permission import Environment, Verdict
from planner_reactor.analysis.protocols import LIMIT, Checked, Counterexample, Protocol, checking
from planner_reactor.analysis.slicing import Slice, Sliced, apart, sliced, still_asking, unknown_names
from planner_reactor.analysis.standing import Standing, shape
from planner_reactor.errors import BudgetError, InputError
from planner_reactor.rs.bounds import Bounds
from planner_reactor.rs.configurations import Ending, Label, World
from planner_reactor.rs.reactions import (
    Reaction,
    Surgery,
    children,
    drain_script,
    removal_script,
    upside_down,
    versions_script,
    wait_script,
)
from planner_reactor.rs.terms import Process, Program, Value, cond, operands
from planner_reactor.rs.vocabulary import Signature

SMALL = 300
"""States of a slice that are looked at as a whole: a fraction of a second."""

SMALL_VERSIONS = 200
"""The same in mode versions, whose states hold more."""

FEW = 12
"""Reactions of a slice: of more, every situation is looked at by itself at once."""

RIGHT = Checked({}, 0)
"""What is known of a shape that is right."""

OPEN = {name: Signature(name, window=(0.0, inf)) for name in ("Works", "Asks")}


class Verifier:
    """Verifies adaptations of one reactor, and remembers the shapes that it has seen.

    With `proven` what is right whatever the reactions do (`exchanges`) is not explored.
    """

    def __init__(
        self, environment: Environment | None = None, *, mode: str = "drain", small: int = SMALL, limit: int = LIMIT,
        proven: bool = False,
    ) -> None:  # fmt: skip
        self.environment = environment
        self._proven = proven and mode == "drain"
        self._small = min(small, SMALL_VERSIONS) if mode == "versions" else small
        self.seen: dict[Slice, Checked] = {}
        self.right: set[Hashable] = set()  # shapes of which everything holds, whatever the bound
        self._mode = mode
        self._limit = limit

    def verify(self, present: Iterable[Reaction], new: Iterable[Reaction], surgery: Surgery) -> Verdict:
        """Verify the surgery that adds `new` to a reactor of the reactions `present`."""
        before, coming = list(present), list(new)
        if vague := [(r, n) for r in (*before, *coming) for n in unknown_names(r.schema.body)]:
            return _refused_as_vague(vague[0][0].label, vague[0][1])
        return finish(self._verifying(before, coming, surgery, self.bound(before, surgery)))

    def looking(self, standing: Standing, new: Sequence[Known], surgery: Surgery) -> Looking[Verdict]:
        """The same for a reactor that is kept by situation: what it costs depends on what is touched.

        The verdict of a shape that has come before is known at once; else it comes state by state.
        """
        if (vague := standing.vague(new)) is not None:
            return _refused_as_vague(*vague)
        bound = self._bound_in(standing, surgery)
        around = standing.around(new, surgery)
        alike = shape(around, new, surgery)
        if alike in self.right:
            return _verdict(RIGHT, bound, None, surgery, states=0)
        before = []
        for known in sorted((*around.inside, *around.outside, *around.idle), key=standing.came):
            before.append(known.reaction)  # read now, if it was not
            yield
        if len(around.inside) + len(new) > FEW and surgery.held:
            coming = [r.reaction for r in new if r.situation in surgery.held]
            verdict = yield from self._one_by_one(before, coming, surgery, bound)
        else:
            verdict = yield from self._verifying(before, [r.reaction for r in new], surgery, bound)
        if verdict.holds:
            self.right.add(alike)
        return verdict

    def _bound_in(self, standing: Standing, surgery: Surgery) -> float | None:
        if self.environment is None or self._mode == "wait":
            return None
        return 0.0 if self._mode == "versions" else standing.drains(surgery.held, self.environment)

    def _verifying(
        self, before: list[Reaction], coming: list[Reaction], surgery: Surgery, bound: float | None
    ) -> Looking[Verdict]:
        part = sliced(before, coming, surgery)
        if self._proven and is_exchange(part.slice):
            return _verdict(RIGHT, bound, part, surgery, states=0)
        if (known := self.seen.get(part.slice)) is not None:
            return _verdict(known, bound, part, surgery, states=0)
        try:
            found = self.seen[part.slice] = yield from _looking(part.slice, self._mode, self._small)
        except BudgetError:
            return (yield from self._one_by_one(before, coming, surgery, bound))
        return _verdict(found, bound, part, surgery, states=found.states)

    def _one_by_one(
        self, before: list[Reaction], coming: list[Reaction], surgery: Surgery, bound: float | None
    ) -> Looking[Verdict]:
        """What is too large to be looked at as a whole: each situation by itself, and their order.

        The killed roots, and what is only added, are looked at beside the first.
        """
        below = children(before)
        if (wrong := upside_down(surgery.held, lambda s: below.get(s, ()))) is not None:
            return Verdict(local=False, bound_s=bound, why=f"{wrong[1]} would be held up at {wrong[0]}, drained first")
        states, verdict = 0, Verdict(bound_s=bound)
        for single in apart(before, coming, surgery):
            part = sliced(still_asking(before, single, surgery), [r for r in coming if r.label in single.adds], single)
            if (found := self.seen.get(part.slice)) is None:
                found = self.seen[part.slice] = yield from self._alone(part.slice)
                states += found.states
            verdict = _verdict(found, bound, part, surgery, states=states)
            if not verdict.holds:
                return verdict
        serves = {r.label: r for r in before}
        at_rest = {n for n, r in serves.items() if r.situation in surgery.held or r.monitors}
        at_rest |= {n for n, r in serves.items() if r.situation is None and {*r.asserts} <= {*surgery.held}}
        if loose := [n for n in surgery.kills if n not in at_rest]:
            return Verdict(safe=False, bound_s=bound, why=f"P[{loose[0]}] is killed, and what it serves is not held")
        return verdict

    def _alone(self, part: Slice) -> Looking[Checked]:
        """One situation by itself.

        Versions have many states, and no script of theirs depends on what a body does: where there are more than a few,
        what is known of every small reactor stands for them (docs/decisions/0030).
        """
        if self._proven and is_exchange(part):
            return RIGHT
        if self._mode != "versions":
            return (yield from _looking(part, self._mode, self._limit))
        try:
            return (yield from _looking(part, self._mode, self._small))
        except BudgetError:
            return Checked({}, self._small)

    def forget(self) -> None:
        """Know no shape any more."""
        self.seen.clear()
        self.right.clear()

    def bound(self, present: Iterable[Reaction], surgery: Surgery) -> float | None:
        """Seconds in which what is held has been drained; None if nothing is known of the basic processes.

        Beside each other versions come at once. How long WAITINHIBIT takes is not bounded by windows.
        """
        if self.environment is None or self._mode == "wait":
            return None
        reactions = list(present)

        def served(situation: str) -> tuple[Process, ...]:
            return tuple(operands(r.schema.body)[1] for r in reactions if r.situation == situation)

        program = Program(r.schema for r in reactions)
        if self._mode == "versions":
            return 0.0
        return Bounds(program, self.environment.signatures, self.environment.limits, served).drains(surgery.held)


def _refused_as_vague(label: int, name: str) -> Verdict:
    why = f"P[{label}] asserts a situation that is worked out at run time: {name}"
    return Verdict(safe=False, local=False, bounded=False, why=why)


def _looking(part: Slice, mode: str, limit: int) -> Looking[Checked]:
    """The script of this mode beside the slice.

    Versions: nothing waits but what removes the retired ones, as long as old instances live and no longer.
    """
    match mode:
        case "drain":
            return _checked(part, drain_script(part.surgery), limit)
        case "wait":
            return _checked(part, wait_script(part.surgery), limit)
        case "versions":
            script, removal = versions_script(part.surgery, part.killed), removal_script(part.surgery, part.killed)
            return _checked(part, cond(script, removal), limit, patient=True)
        case _:
            raise InputError(f"mode is {mode}, expected drain, wait or versions")


def _checked(part: Slice, script: Process, limit: int, *, patient: bool = False) -> Looking[Checked]:
    protocol = Protocol(
        reactor=part.reactor,
        script=script,
        named=frozenset(part.surgery.named),
        kills=frozenset(part.surgery.kills),
        adds=frozenset(part.surgery.adds),
        patient=patient,
    )
    return checking(protocol, World(Program(part.schemas), OPEN, endings=_endings), limit=limit)


def _endings(name: str, arguments: tuple[Value, ...]) -> Iterable[Ending]:
    return [(True, ())] if name == "Asks" else [(True, ()), (False, ())]


def _verdict(found: Checked, bound: float | None, part: Sliced | None, surgery: Surgery, *, states: int) -> Verdict:
    endless = bound is not None and isinf(bound)
    first = found.first
    why = f"what serves {', '.join(surgery.held)} may go on for ever" if endless else ""
    return Verdict(
        consistent="consistent" not in found.broken,
        safe="safe" not in found.broken,
        atomic="atomic" not in found.broken,
        local="local" not in found.broken,
        bounded="bounded" not in found.broken and not endless,
        bound_s=bound,
        why=_meant(first.why, part) if first and part else why,
        counterexample=_path(first, part) if first and part else (),
        cycle=first.cycle if first else 0,
        states=states,
    )


def _meant(text: str, part: Sliced) -> str:
    """A sentence about the slice in the names of the reactor."""
    text = re.sub(r"\bs\d+\b", lambda found: part.situations.get(found[0], found[0]), text)
    return re.sub(r"\b(KILL|P)\[(\d+)\]", lambda found: f"{found[1]}[{part.labels.get(int(found[2]), found[2])}]", text)


def _path(found: Counterexample, part: Sliced) -> tuple[Label, ...]:
    return tuple(_named(label, part) for label in found.path)


def _named(label: Label, part: Sliced) -> Label:
    name, arguments, status, values = label
    if name in ("KILL", "POST", "E"):
        return name, tuple(part.labels.get(n, n) for n in arguments), status, values  # type: ignore[call-overload]
    return name, tuple(part.situations.get(a, a) if isinstance(a, str) else a for a in arguments), status, values
