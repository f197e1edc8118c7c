"""What a kit is: its part kinds, their variants, the slots, the placing order; and how the belt is fed.

`SERVOMOTOR` is the product of R §8.1 (Fig. 7): a cap, a motor, a body, each with variants. Other kits come
from a TOML file (`read_kit`), in which everything but the kinds has a default:

    name = "pump"
    order = ["shaft", "seal", "housing"]      # the fixed placing order (assumption AO); default: as listed
    [belt]
    interval_s = 14.0                         # mean time between two parts of a kind; default: by size
    [[part]]
    kind = "shaft"
    variants = ["shaft_a", "shaft_b", "shaft_c"]
    wanted = "shaft_a"                        # default the first
    substitutes = ["shaft_b"]                 # accepted downstream in its place, in order of preference
    quality = 1.0                             # share of good parts
    mix = { shaft_b = 0.1 }                   # share of other variants on the belt, where no fault is about
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import msgspec

from planner_reactor.errors import nearest
from planner_reactor.workcell.calibration import PINNED, Calibration
from planner_reactor.workcell.reading import Fields, TomlText, parse_toml, read_toml, typed

FEWEST, MOST = 1, 100
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_TAKEN = ("tray", "trayarea", "arm", "belt", "stack", "downstream", "time")
_PART_KEYS = ("kind", "variants", "wanted", "substitutes", "slot", "quality", "mix", "interval_s")


class PartKind(msgspec.Struct, frozen=True):
    """One kind of part: which variant the kit wants, which others serve instead, how it comes along the belt."""

    kind: str
    variants: tuple[str, ...]
    wanted: str
    substitutes: tuple[str, ...] = ()
    slot: int = 1
    quality: float = 1.0
    mix: tuple[tuple[str, float], ...] = ()
    interval_s: float = 14.0

    @property
    def accepted(self) -> tuple[str, ...]:
        """The variants that downstream takes, the wanted one first."""
        return (self.wanted, *self.substitutes)

    @property
    def misfits(self) -> tuple[str, ...]:
        """The variants that downstream refuses."""
        return tuple(v for v in self.variants if v not in self.accepted)


@dataclass(frozen=True, slots=True)
class KitSpec:
    """A kit: one part of each kind, each in the slot of its kind."""

    name: str
    parts: tuple[PartKind, ...]
    order: tuple[str, ...]
    dwell_s: float
    jitter: float = 0.3
    trays: int = 12
    places: int = 1
    by_kind: Mapping[str, PartKind] = field(init=False, compare=False, repr=False)
    kind_of: Mapping[str, str] = field(init=False, compare=False, repr=False)
    priority: Mapping[str, int] = field(init=False, compare=False, repr=False)

    def __post_init__(self) -> None:
        """Build the look-ups: kind → part, kind or variant → kind, kind → place in the fixed order."""
        kind_of = {p.kind: p.kind for p in self.parts} | {v: p.kind for p in self.parts for v in p.variants}
        object.__setattr__(self, "by_kind", {p.kind: p for p in self.parts})
        object.__setattr__(self, "kind_of", kind_of)
        object.__setattr__(self, "priority", {kind: place for place, kind in enumerate(self.order)})

    @property
    def kinds(self) -> tuple[str, ...]:
        """The part kinds, as listed."""
        return tuple(p.kind for p in self.parts)


def plain_kit(kinds: int, *, calibration: Calibration = PINNED) -> KitSpec:
    """A kit of so many kinds `part_1` …, each with three variants: wanted, substitute, misfit."""
    listed = "\n".join(
        f'[[part]]\nkind = "part_{n}"\nvariants = ["part_{n}_a", "part_{n}_b", "part_{n}_c"]\n'
        f'substitutes = ["part_{n}_b"]'
        for n in range(1, kinds + 1)
    )
    return _kit(parse_toml(f'name = "plain_{kinds}"\n{listed}\n', file="<plain kit>"), calibration)


def read_kit(path: Path, *, calibration: Calibration = PINNED) -> KitSpec:
    """The kit of a TOML file; raises InputError with file, line and the nearest name."""
    return _kit(read_toml(path), calibration)


def kit_from(text: str, *, calibration: Calibration = PINNED, file: str = "<kit>") -> KitSpec:
    """As `read_kit`, from text."""
    return _kit(parse_toml(text, file=file), calibration)


def _kit(source: TomlText, calibration: Calibration) -> KitSpec:
    top = Fields(source, "", 0, source.values, ("name", "order", "part", "belt", "trays"))
    top.refuse_unknown()
    rows = source.values.get("part")
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise source.error("no parts", key="part", hint="expected a [[part]] table for each kind")
    if not FEWEST <= len(rows) <= MOST:
        raise source.error(f"{len(rows)} part kinds", table="part", hint=f"expected from {FEWEST} to {MOST}")
    belt = Fields(source, "belt", 0, _section(source, "belt"), ("interval_s", "dwell_s", "jitter", "quality"))
    belt.refuse_unknown()
    stack = Fields(source, "trays", 0, _section(source, "trays"), ("stock", "places"))
    stack.refuse_unknown()
    interval = belt.take("interval_s", calibration.kit_s(len(rows)) / 2, low=0.05)
    quality = belt.take("quality", 1.0, low=0.0, high=1.0)
    parts = tuple(_part(source, index, row, interval, quality) for index, row in enumerate(rows))
    _distinct(source, parts)
    order = top.names("order", tuple(p.kind for p in parts))
    _check_order(top, order, [p.kind for p in parts])
    return KitSpec(
        name=top.take("name", "kit"),
        parts=parts,
        order=order,
        dwell_s=belt.take("dwell_s", 3 * interval, low=10.0),
        jitter=belt.take("jitter", 0.3, low=0.0, high=1.0),
        trays=stack.take("stock", 12, low=1),
        places=stack.take("places", 1, low=1, high=20),
    )


def _section(source: TomlText, name: str) -> Mapping[str, object]:
    section = source.values.get(name, {})
    if not isinstance(section, dict):
        raise source.error(f"'{name}' is {section!r}", key=name, hint=f"expected a table [{name}]")
    return section


def _part(source: TomlText, index: int, row: Mapping[str, object], interval: float, quality: float) -> PartKind:
    fields = Fields(source, "part", index, row, _PART_KEYS)
    fields.refuse_unknown()
    kind: str = fields.take("kind", "")
    if not _NAME.fullmatch(kind) or kind in _TAKEN:
        shown = f"'{kind}' cannot name a part kind" if kind else "a part without a kind"
        raise fields.error(shown, "kind", "expected letters, digits and _, not a name of the cell's own")
    variants = fields.names("variants", (kind,))
    if not variants:
        raise fields.error(f"'{kind}' has no variant", "variants", "expected at least one name, or no such key")
    return PartKind(
        kind=kind,
        variants=variants,
        wanted=fields.one_of("wanted", variants[0], variants),
        substitutes=_known(fields, "substitutes", fields.names("substitutes", ()), variants),
        slot=fields.take("slot", index + 1, low=1, high=MOST),
        quality=fields.take("quality", quality, low=0.0, high=1.0),
        mix=_mix(fields, row.get("mix", {}), variants),
        interval_s=fields.take("interval_s", interval, low=0.05),
    )


def _known(fields: Fields, key: str, names: tuple[str, ...], variants: tuple[str, ...]) -> tuple[str, ...]:
    for name in names:
        if name not in variants:
            hint = nearest(name, variants) or f"expected among: {', '.join(variants)}"
            raise fields.error(f"'{name}' is not a variant", key, hint)
    return names


def _mix(fields: Fields, mix: object, variants: tuple[str, ...]) -> tuple[tuple[str, float], ...]:
    if not isinstance(mix, dict):
        raise fields.error(f"'mix' is {mix!r}", "mix", "expected { variant = share, ... }")
    _known(fields, "mix", tuple(mix), variants)
    shares = tuple((name, typed(share, 0.0)) for name, share in mix.items())
    if any(share is None or share < 0 for _, share in shares) or sum(share for _, share in shares) > 1:
        raise fields.error(f"'mix' is {mix!r}", "mix", "expected shares of 0 or more that sum to at most 1")
    return shares


def _distinct(source: TomlText, parts: tuple[PartKind, ...]) -> None:
    owner: dict[str, str] = {}
    slots: dict[int, str] = {}
    for index, part in enumerate(parts):
        for name in dict.fromkeys((part.kind, *part.variants)):
            if name in owner:
                raise source.error(
                    f"'{name}' names two things",
                    table="part",
                    index=index,
                    hint=f"already used by {owner[name]}",
                )
            owner[name] = part.kind
        if part.slot in slots:
            raise source.error(
                f"slot {part.slot} is taken",
                table="part",
                index=index,
                key="slot",
                hint=f"by {slots[part.slot]}",
            )
        slots[part.slot] = part.kind


def _check_order(top: Fields, order: tuple[str, ...], kinds: list[str]) -> None:
    for kind in order:
        if kind not in kinds:
            raise top.error(f"'{kind}' in the order is no part kind", "order", nearest(kind, kinds))
    missing = [kind for kind in kinds if kind not in order]
    if missing:
        raise top.error(f"the order lacks '{missing[0]}'", "order", "expected every kind once")


SERVOMOTOR = kit_from(
    """
name = "servomotor"
order = ["motor", "cap", "body"]
[[part]]
kind = "cap"
variants = ["cap_a", "cap_b", "cap_c"]
substitutes = ["cap_b"]
[[part]]
kind = "motor"
variants = ["motor_a", "motor_b", "motor_c"]
substitutes = ["motor_b"]
[[part]]
kind = "body"
variants = ["body_a", "body_b", "body_c"]
substitutes = ["body_b"]
""",
    file="<servomotor>",
)
"""The DC servomotor of R §8.1."""
