"""Every shape of an adaptation: which situations are replaced, removed, added or kept, how they nest, in which mode.

A shape is a forest: a situation stands below the one whose reaction asserts it, those on top are asserted by roots.
Forests that differ in names or in order only are one shape. Below what is removed everything is removed, below what is
added everything is new; below what is kept nothing comes or goes, for its text stays as it was. (A situation that two
others assert is not among them; chaos has those.)
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Literal, TypeAlias

import msgspec

from planner_reactor.link.messages import Adaptation, Change

Tree: TypeAlias = "tuple[str, tuple[Tree, ...]]"
"""What becomes of a situation, and what stands below it."""

Forest: TypeAlias = tuple[Tree, ...]

BELOW = {"r": "rda", "d": "d", "a": "a", "k": "r"}
"""Replaced, removed (deleted), added, kept: what may become of the situations below, beside being kept."""

Way = Literal["drain", "wait", "versions", "late"]
"""The mode; `late` is a drain with a deadline that it cannot keep."""

WAYS: tuple[Way, ...] = ("drain", "wait", "versions", "late")

SECONDS = 0.25
"""How long the deed of one situation takes."""

ARRIVES = 2.1
"""Seconds after which the adaptation arrives: in the midst of what the roots have asserted."""


@cache
def forests(size: int, *, kept: bool, becoming: str = "rdak") -> tuple[Forest, ...]:
    """All forests of so many situations whose tops become one of these; none is kept unless some may be."""
    return tuple(_forests(size, becoming if kept else becoming.replace("k", ""), kept, (size, 10**9)))


def _forests(left: int, becoming: str, kept: bool, most: tuple[int, int]) -> Iterator[Forest]:
    """In falling order of their trees, so that each comes once."""
    if not left:
        yield ()
    for size in range(min(left, most[0]), 0, -1):
        for place, tree in enumerate(_trees(size, becoming, kept)):
            if (size, place) <= most:
                for rest in _forests(left - size, becoming, kept, (size, place)):
                    yield (tree, *rest)


@cache
def _trees(size: int, becoming: str, kept: bool) -> tuple[Tree, ...]:
    below = {what: BELOW[what] + ("k" if what in "rk" else "") for what in becoming}
    return tuple((what, forest) for what in becoming for forest in forests(size - 1, kept=kept, becoming=below[what]))


class Case(msgspec.Struct, frozen=True):
    """A shape and a way in which it is applied; its situations are numbered from above."""

    forest: Forest
    way: Way

    def __str__(self) -> str:
        return f"{said(self.forest)} / {self.way}"


def cases(most: int, *, kept: int) -> Iterator[Case]:
    """Every shape of up to so many situations, of up to `kept` ones also where some stay, in every way."""
    for size in range(1, most + 1):
        for forest in forests(size, kept=size <= kept):
            if any(what != "k" for what, _, _, _ in situations(forest)):
                yield from (Case(forest, way) for way in WAYS)


def said(forest: Forest) -> str:
    """`r(d a)`: replaced, and below it one that goes and one that comes."""
    return " ".join(what + (f"({said(below)})" if below else "") for what, below in forest)


def situations(forest: Forest) -> list[tuple[str, int, tuple[int, ...], bool]]:
    """From above: what becomes of each, its number, the numbers below it, and whether it is on top."""
    found: list[tuple[str, int, tuple[int, ...], bool]] = []

    def add(tree: Tree, top: bool) -> int:
        number = len(found)
        found.append((tree[0], number, (), top))
        below = tuple(add(child, False) for child in tree[1])
        found[number] = (tree[0], number, below, top)
        return number

    for tree in forest:
        add(tree, True)
    return found


def before(forest: Forest) -> Adaptation:
    """What brings the old structure; its bystander, whom nothing concerns, is reaction 99, asserted by 98."""
    lines, adds = ["P[98] = STOP :; ASSERT[calm]", _clause(99, "calm", ())], [99, 98]
    changes = [Change(situation="calm", base=0, fresh=True)]
    becomes = {number: what for what, number, _, _ in situations(forest)}
    for what, number, below, top in situations(forest):
        if what != "a":
            lines.append(_clause(number, f"s{number}", [n for n in below if becomes[n] != "a"]))
            changes.append(Change(situation=f"s{number}", base=0, fresh=True))
            adds.insert(0, number)
            if top:
                lines.append(f"P[{50 + number}] = STOP :; ASSERT[s{number}]")
                adds.append(50 + number)
    return Adaptation(id=1, definitions="\n".join(lines), changes=tuple(changes), adds=tuple(adds))


def change(case: Case) -> Adaptation:
    """The adaptation: what is new has the labels of the old and 100."""
    lines: list[str] = []
    kills: list[int] = []
    adds: list[int] = []
    roots: list[int] = []
    changes: list[Change] = []
    removed: list[str] = []
    becomes = {number: what for what, number, _, _ in situations(case.forest)}
    for what, number, below, top in situations(case.forest):
        if what in "rd":
            kills += [50 + number, number] if top and what == "d" else [number]
        if what == "d":
            removed.append(f"s{number}")
        if what in "ra":
            lines.append(_clause(100 + number, f"s{number}", [n for n in below if becomes[n] != "d"]))
            changes.append(Change(situation=f"s{number}", base=int(what == "r"), fresh=what == "a"))
            adds.insert(0, 100 + number)
        if what == "a" and top:
            lines.append(f"P[{150 + number}] = STOP :; ASSERT[s{number}]")
            roots.append(150 + number)
    return Adaptation(
        id=2,
        definitions="\n".join(lines),
        changes=tuple(changes),
        removed=tuple(removed),
        kills=tuple(kills),
        adds=(*adds, *roots),
        mode="drain" if case.way == "late" else case.way,
        deadline=SECONDS / 100 if case.way == "late" else None,
    )


def _clause(label: int, situation: str, below: list[int] | tuple[()]) -> str:
    steps = " : ".join([f"Do[{label}, {SECONDS}]", *(f"REASSERT[s{n}]" for n in below), f"SUCCEED[{situation}, k]"])
    return f"P[{label}] = SIT[{situation}]<k> :; (~({steps}) : FAIL[{situation}, k])"
