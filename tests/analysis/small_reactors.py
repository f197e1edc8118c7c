"""Every small reactor of a family, every way to change it: what the three modes are tried on, exhaustively.

One to three situations, one or two reactions each, served one instance at a time (`:;`) or all at once (`::`); children
asserted once or until they succeed, shared or not; bodies that meet at a port. A `Case` is a reactor as a text, and an
adaptation of it. Every basic process may end at any time, either way.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, product

import msgspec

from planner_reactor.analysis.protocols import Checked, Protocol, check
from planner_reactor.link.messages import Adaptation, Change
from planner_reactor.link.surgeries import surgery
from planner_reactor.rs.configurations import Ending, World, spawned_situations
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.reactions import (
    Reaction,
    drain_script,
    reaction_of,
    removal_script,
    versions_script,
    wait_script,
)
from planner_reactor.rs.terms import Process, Value, cond
from planner_reactor.rs.vocabulary import Signature

OPEN = (0.0, float("inf"))
LEAVES = {name: Signature(name, window=OPEN) for name in ("Works", "Asks")}
MODES = ("wait", "drain", "versions")
NEW = 10
"""The reaction that replaces P[n] is P[n + 10]."""


class Shape(msgspec.Struct, frozen=True):
    """A reactor: for each situation, parents first, what its reactions do; who asks from outside."""

    name: str
    bodies: Mapping[str, Sequence[str]]
    asked: Sequence[str]
    loops: Sequence[str] = (":;", "::")


SHAPES = (
    Shape("one", {"a": ["Works"]}, ["a"]),
    Shape("overlapping", {"a": ["Works"]}, ["a", "a"]),
    Shape("two reactions", {"a": ["Works", "-Works"]}, ["a"]),
    Shape("meeting", {"a": ["OUT[x, 1]", "-IN[x]<v>"]}, ["a"]),
    Shape("nested", {"p": ["ASSERT[c]"], "c": ["Works"]}, ["p"]),
    Shape("persistent", {"p": ["REASSERT[c]"], "c": ["Works"]}, ["p"]),
    Shape("both", {"p": ["ASSERT[c]"], "c": ["Works"]}, ["p", "c"], (":;",)),
    Shape("shared", {"p": ["ASSERT[c]"], "q": ["ASSERT[c]"], "c": ["Works"]}, ["p", "q"], (":;",)),
    Shape("chain", {"p": ["ASSERT[c]"], "c": ["ASSERT[d]"], "d": ["Works"]}, ["p"], (":;",)),
    Shape("joined", {"p": ["(ASSERT[c] & IN[x]<v>)"], "c": ["OUT[x, 1]"]}, ["p"], (":;",)),
)


class Case(msgspec.Struct, frozen=True):
    """A reactor `R` as a text, with the clauses that may come, and an adaptation of it."""

    name: str
    text: str
    adaptation: Adaptation

    @property
    def killed(self) -> tuple[Reaction, ...]:
        """The reactions that go."""
        found = {r.label: r for r in map(reaction_of, parse_program(self.text).schemas) if r is not None}
        return tuple(found[n] for n in self.adaptation.kills)


def cases() -> Iterator[Case]:
    """The whole family."""
    for shape in SHAPES:
        for loop in shape.loops:
            yield from _changes(shape, loop)


def _changes(shape: Shape, loop: str) -> Iterator[Case]:
    """Each set of situations changed, one of two reactions, a child that is needed no more, a child that is new."""
    names = list(shape.bodies)
    for count in range(1, len(names) + 1):
        for chosen in combinations(names, count):
            yield _case(shape, loop, chosen)
    if len(shape.bodies[names[0]]) == 2:
        for one in (0, 1):
            yield _case(shape, loop, names, only=one)
    if len(names) > 1:
        if names[-1] not in shape.asked:
            yield _case(shape, loop, names[:-1], removed=names[-1])
        yield _case(shape, loop, names[:1], fresh="e")


def _case(
    shape: Shape, loop: str, chosen: Sequence[str], *, only: int | None = None, removed: str = "", fresh: str = ""
) -> Case:
    labels = iter(range(1, NEW))
    lines: list[str] = []
    present: list[int] = []
    kills: list[int] = []
    adds: list[int] = []
    for asked in shape.asked:
        present.append(next(labels))
        lines.append(f"P[{present[-1]}] = Asks :; ASSERT[{asked}]")
    for situation, bodies in shape.bodies.items():
        for n, body in enumerate(bodies):
            label = next(labels)
            present.append(label)
            lines.append(_clause(label, situation, loop, body))
            if situation in (*chosen, removed) and only in (None, n):
                kills.append(label)
                if situation != removed:
                    adds.insert(0, label + NEW)
                    lines.append(_clause(label + NEW, situation, loop, _changed(body, removed, fresh)))
    if fresh:
        adds.insert(0, 2 * NEW)
        lines.append(_clause(2 * NEW, fresh, loop, "Works"))
    guarded = [f"(E[{n}] # P[{n}])" for n in present]
    text = "\n".join([f"R = {' | '.join(guarded)} | (ADD<m> :: (E[m] # P[m]))", *lines])
    changes = [Change(situation=s, base=1) for s in shape.bodies if s in chosen]
    changes += [Change(situation=fresh, base=0, fresh=True)] if fresh else []
    adaptation = Adaptation(
        id=2, changes=tuple(changes), kills=tuple(kills), adds=tuple(adds), removed=(removed,) if removed else (),
    )  # fmt: skip
    what = "".join(chosen) + (f"-{removed}" if removed else "") + (f"+{fresh}" if fresh else "")
    return Case(f"{shape.name} {loop} {what}" + ("" if only is None else f" only {only + 1}"), text, adaptation)


def _clause(label: int, situation: str, loop: str, body: str) -> str:
    """A reaction; one whose body begins with `-` leaves the verdict to another."""
    if body.startswith("-"):
        return f"P[{label}] = SIT[{situation}]<k> {loop} {body[1:]}"
    verdict = f"~({body} : SUCCEED[{situation}, k]) : FAIL[{situation}, k]"
    return f"P[{label}] = SIT[{situation}]<k> {loop} ({verdict})"


def _changed(body: str, removed: str, fresh: str) -> str:
    if removed and f"[{removed}]" in body:
        return "Works"
    return f"(ASSERT[{fresh}] : {body})" if fresh and not body.startswith("-") else body


# ---------------------------------------------------------------------------------------------------- looked at


def explored(case: Case, mode: str, *, reactor: str = "R", limit: int = 20_000) -> Checked:
    """Every way in which the reactor and the script of this mode can go on. Versions: what removes the old included."""
    plan = surgery(case.adaptation)
    match mode:
        case "wait":
            return looked_at(case, wait_script(plan), reactor=reactor, limit=limit)
        case "drain":
            return looked_at(case, drain_script(plan), reactor=reactor, limit=limit)
        case _:
            script = cond(versions_script(plan, case.killed), removal_script(plan, case.killed))
            return looked_at(case, script, patient=True, reactor=reactor, limit=limit)


def looked_at(
    case: Case,
    script: Process | str,
    *,
    patient: bool = False,
    later: tuple[tuple[frozenset[Value], frozenset[Value]], ...] = (),
    reactor: str = "R",
    limit: int = 20_000,
) -> Checked:
    program = parse_program(case.text)
    protocol = Protocol(
        reactor=parse_process(reactor),
        script=parse_process(script) if isinstance(script, str) else script,
        named=frozenset(surgery(case.adaptation).named),
        kills=frozenset(case.adaptation.kills),
        adds=frozenset(case.adaptation.adds),
        patient=patient,
        later=later,
    )
    return check(protocol, World(program, LEAVES, endings=_endings, spawned=spawned_situations(program)), limit=limit)


def _endings(name: str, arguments: tuple[Value, ...]) -> list[Ending]:
    return [(True, ()), (False, ())] if name == "Works" else [(True, ())]


def named(name: str) -> Case:
    """The case of this name."""
    return next(case for case in cases() if case.name == name)


def main() -> None:
    """The whole family, a line for each case and mode: states, and which laws are broken after how many steps."""
    states = 0
    for case, mode in product(cases(), MODES):
        found = explored(case, mode)
        states += found.states
        broken = ", ".join(f"{law} after {len(c.path)}: {c.why}" for law, c in found.broken.items())
        print(f"{case.name:28} {mode:9} {found.states:6}  {broken}", flush=True)
    print(f"{states} states")


if __name__ == "__main__":
    main()
