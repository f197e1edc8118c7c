"""What a kit means to a planning domain: the rule that says when a tray has its contents (R (14)).

`kitting.itl` speaks of a cap, a motor and a body; a domain for another kit differs in this one rule. The
kinds stand in the kit's placing order.
"""

from __future__ import annotations

import re
from importlib.resources import files

from planner_reactor.errors import InputError
from planner_reactor.workcell.kit import KitSpec

SHIPPED = "kitting.itl"
"""The domain for the cell of this package."""

_RULE = re.compile(r"atp_rule[^;]*=>\s*Contents\(\w+\)\s*@\s*\w+\s*;")


def shipped_domain() -> str:
    """The text of the domain for the cell of this package."""
    return (files("planner_reactor.workcell") / SHIPPED).read_text(encoding="utf-8")


def contents_rule(kit: KitSpec) -> str:
    """The rule `… => Contents(t) @ i` in the notation of `.itl`."""
    names = [f"x{n}" for n in range(1, len(kit.order) + 1)]
    terms = " and ".join(
        f"Instance({kind},{name}) @ i and In(t,{name}) @ i" for kind, name in zip(kit.order, names, strict=True)
    )
    return f"atp_rule forall t, {', '.join(names)}, i: {terms} => Contents(t) @ i;"


def with_kit(domain: str, kit: KitSpec) -> str:
    """The text of a domain with the contents rule of this kit; raises InputError if it has not exactly one."""
    found = _RULE.findall(domain)
    if len(found) != 1:
        raise InputError(f"a domain for kits has one rule '=> Contents(t) @ i', this one has {len(found)}")
    return _RULE.sub(lambda match: contents_rule(kit), domain)


_BY_HAND = re.compile(r"atp_actionschema (Track|Get) .*?endactionschema\n", re.DOTALL)


def without_tracking(domain: str) -> str:
    """The text of the domain without the hand-written way to pick what moves, with what a servo reaction needs."""
    left, removed = _BY_HAND.subn("", domain)
    if removed != 2:
        raise InputError(f"expected the actions Track and Get once each, found {removed}")
    return left + (files("planner_reactor.workcell") / "servo.itl").read_text(encoding="utf-8")
