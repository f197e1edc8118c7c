"""What workcells can do, as programs in RS: models of the environment for analysis (R §4, §6).

`kitting` gives the text of an environment in which some of the nine assumptions fail and the others hold, for a kit of
some of the three kinds. It defines the basic processes of `kitting.itl` by what they do to a small world, and `EM`, the
world; run beside a reactor it is `EM | REACTOR`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib.resources import files

from planner_reactor.errors import InputError, nearest

KINDS = ("cap", "motor", "body")
ASSUMPTIONS = ("AQ", "AS", "AF", "ACT", "ACP", "ADT", "AM", "ADD", "AO")

PER_KIND = ("AQ", "AS", "AF", "ACT", "ACP")
"""Assumptions that may fail for one kind of part and hold for another."""


def kitting(kinds: Iterable[str] = ("cap",), fails: Iterable[str] = ()) -> str:
    """The text of the environment for a kit of these kinds, in which these assumptions fail.

    `AQ(cap)` fails for caps only. `AO` fails with two kinds or more; it comes with parts that are all good.
    """
    order, failing = tuple(kinds), tuple(fails)
    _checked(order, failing)
    return _common() + "".join(f"{line}\n" for line in _of_kit(order, frozenset(failing)))


def _common() -> str:
    return (files("planner_reactor.workcell.environments") / "kitting.rsl").read_text(encoding="utf-8")


def _checked(kinds: tuple[str, ...], fails: tuple[str, ...]) -> None:
    for kind in kinds:
        if kind not in KINDS:
            raise InputError(f"unknown kind {kind}, {nearest(kind, KINDS) or 'there is: ' + ', '.join(KINDS)}")
    known = (*ASSUMPTIONS, *(f"{a}({k})" for a in PER_KIND for k in (*kinds, "tray")))
    for name in fails:
        if name not in known:
            raise InputError(f"unknown assumption {name}, {nearest(name, known) or 'there is: ' + ', '.join(known)}")


def _of_kit(kinds: tuple[str, ...], fails: frozenset[str]) -> Iterable[str]:
    def state(assumption: str, kind: str = "") -> str:
        return "fails" if assumption in fails or f"{assumption}({kind})" in fails else "holds"

    yield "\n// ---- the kit, and what holds"
    yield "Laid = " + " : ".join(f"Lay[lay_{k}, put_{k}]" for k in kinds)
    yield "Filled = " + " : ".join(f"~Shows[look_{k}, vacant]" for k in kinds)
    yield "Good = " + " : ".join(f'Holds["{k}"]' for k in kinds)
    common = ", ".join(state(a, "tray") for a in ("AQ", "ADT", "AM", "ADD"))
    slots = [f"{k.title()}Slot[{', '.join(state(a, k) for a in ('AF', 'ACT', 'ACP'))}]" for k in kinds]
    if "AO" in fails:
        yield "Belt = " + " : ".join(f"Show{k.title()}" for k in reversed(kinds)) + " : Belt"
        parts = ["Belt"]
    else:
        parts = [f"{k.title()}Parts[{state('AQ', k)}, {state('AS', k)}]" for k in kinds]
    yield f"EM = {' | '.join([f'Common[{common}]', *slots, *parts])}"


def regime(fails: Iterable[str]) -> Mapping[str, bool]:
    """γ: which of the nine assumptions hold."""
    failing = set(fails)
    return {name: name not in failing for name in ASSUMPTIONS}
