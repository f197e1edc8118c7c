"""Allen's interval algebra: thirteen base relations, sets of them as 13-bit numbers, their composition.

The kernel of the planner (R §7.4) constrains intervals of time by such sets: bit n of a set stands for
`BASES[n]`, `ALL` says nothing, `NONE` is a contradiction. `COMPOSITION[r][s]` is shipped as a table;
`derive_composition` finds it again from the order of end points alone (a test compares the two and pins its
409 base entries).

`NAMED` holds the relations that the papers call by a name (R §7.4, X §4.2): `equal`, `meets`, `disjunct`,
`finishes`, `encompasses`, and the plain words for the rest. Intervals have a duration: start < end.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import combinations
from operator import or_
from types import MappingProxyType

from planner_reactor.errors import nearest

BASES = ("b", "bi", "m", "mi", "o", "oi", "s", "si", "d", "di", "f", "fi", "e")
ALL = (1 << len(BASES)) - 1
NONE = 0
BIT: Mapping[str, int] = MappingProxyType({name: 1 << n for n, name in enumerate(BASES)})

COMPOSITION: tuple[tuple[int, ...], ...] = (
    (1, 8191, 1, 341, 1, 341, 1, 1, 341, 1, 341, 1, 1),
    (8191, 2, 1322, 2, 1322, 2, 1322, 2, 1322, 2, 2, 2, 2),
    (1, 682, 1, 7168, 1, 336, 4, 4, 336, 1, 336, 1, 4),
    (2581, 2, 4288, 2, 1312, 2, 1312, 2, 1312, 2, 8, 8, 8),
    (1, 682, 1, 672, 21, 8176, 16, 2576, 336, 2581, 336, 21, 16),
    (2581, 2, 2576, 2, 8176, 42, 1312, 42, 1312, 682, 32, 672, 32),
    (1, 2, 1, 8, 21, 1312, 64, 4288, 256, 2581, 256, 21, 64),
    (2581, 2, 2576, 8, 2576, 32, 4288, 128, 1312, 512, 32, 512, 128),
    (1, 2, 1, 2, 341, 1322, 256, 1322, 256, 8191, 256, 341, 256),
    (2581, 682, 2576, 672, 2576, 672, 2576, 512, 8176, 512, 672, 512, 512),
    (1, 2, 4, 2, 336, 42, 256, 42, 256, 682, 1024, 7168, 1024),
    (1, 682, 4, 672, 16, 672, 16, 512, 336, 512, 7168, 2048, 2048),
    (1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096),
)
"""Row r, column s: the relations possible between A and C when A r B and B s C."""


def relations(names: Iterable[str]) -> int:
    """The set of the base relations with these names; ValueError names the nearest one."""
    found = 0
    for name in names:
        if name not in BIT:
            expected = nearest(name, BASES) or "expected one of " + " ".join(BASES)
            raise ValueError(f"{name} is not a base relation, {expected}")
        found |= BIT[name]
    return found


NAMED: Mapping[str, int] = MappingProxyType(
    {
        "equal": relations(["e"]),
        "meets": relations(["m"]),
        "disjunct": relations(["b", "bi", "m", "mi"]),
        "finishes": relations(["f"]),
        "encompasses": relations(["si", "e", "di", "fi"]),
        "before": relations(["b"]),
        "after": relations(["bi"]),
        "overlaps": relations(["o"]),
        "starts": relations(["s"]),
        "during": relations(["d"]),
    }
)


def names(relation: int) -> tuple[str, ...]:
    """The base relations of a set, in the order of `BASES`."""
    return tuple(name for n, name in enumerate(BASES) if relation >> n & 1)


def show(relation: int) -> str:
    """`[m o si]`, as the papers write a list of relations."""
    return f"[{' '.join(names(relation))}]"


def base_relation(first: tuple[float, float], second: tuple[float, float]) -> int:
    """The one base relation, as a set, between two intervals given as (start, end)."""
    (a, z), (b, y) = first, second
    if z < b:
        name = "b"
    elif y < a:
        name = "bi"
    elif z == b:
        name = "m"
    elif y == a:
        name = "mi"
    elif a == b:
        name = "e" if z == y else ("s" if z < y else "si")
    elif z == y:
        name = "f" if a > b else "fi"
    elif a < b:
        name = "di" if z > y else "o"
    else:
        name = "d" if z < y else "oi"
    return BIT[name]


def derive_composition() -> tuple[tuple[int, ...], ...]:
    """`COMPOSITION` anew, from all ways in which three intervals can lie on a line (six end points
    suffice).
    """
    table = [[NONE] * len(BASES) for _ in BASES]
    intervals = list(combinations(range(6), 2))
    for a in intervals:
        for b in intervals:
            first = base_relation(a, b).bit_length() - 1
            for c in intervals:
                table[first][base_relation(b, c).bit_length() - 1] |= base_relation(a, c)
    return tuple(map(tuple, table))


def inverse(relation: int) -> int:
    """What holds from B to A when `relation` holds from A to B."""
    return INVERSE[relation]


def compose(first: int, second: int) -> int:
    """What is possible from A to C when `first` holds from A to B and `second` from B to C."""
    low, high = ROWS[first & LOW]
    more_low, more_high = ROWS[first & HIGH]
    return low[second & LOW] | high[second >> SHIFT] | more_low[second & LOW] | more_high[second >> SHIFT]


SHIFT = 7
LOW = (1 << SHIFT) - 1
HIGH = ALL & ~LOW
"""A set is cut into two halves, so that 192 rows of 192 entries compose all pairs of the 8192 sets."""


class _Rows(dict[int, tuple[list[int], list[int]]]):
    """For a half set r: its composition with each low half and with each high half; made when asked for.

    `compose(r, s)` is the union over the halves of r and of s. Composition distributes over union, so a row is the
    union of the rows of its base relations.
    """

    def __missing__(self, half: int) -> tuple[list[int], list[int]]:
        lowest = half & -half
        if half == NONE:
            row = [NONE] * (1 << SHIFT), [NONE] * (1 << len(BASES) - SHIFT)
        elif half == lowest:
            possible = COMPOSITION[half.bit_length() - 1]
            row = _unions(possible[:SHIFT]), _unions(possible[SHIFT:])
        else:
            (a, b), (c, d) = self[lowest], self[half ^ lowest]
            row = list(map(or_, a, c)), list(map(or_, b, d))
        self[half] = row
        return row


def _unions(sets: Iterable[int]) -> list[int]:
    """The union of every selection of these sets, at the number whose bits select them."""
    found = [NONE]
    for one in sets:
        found += [union | one for union in found]
    return found


ROWS = _Rows()


class _Inverses(dict[int, int]):
    """`inverse` of every set that was asked for: those of the bases stand side by side, `e` is its own."""

    def __missing__(self, relation: int) -> int:
        odd, even = 0b0101010101010, 0b0010101010101
        found = (relation & even & 0xFFF) << 1 | (relation & odd) >> 1 | relation & BIT["e"]
        self[relation] = found
        return found


INVERSE = _Inverses()
"""`inverse` by looking it up; the 8192 of them are not worked out at the start."""
