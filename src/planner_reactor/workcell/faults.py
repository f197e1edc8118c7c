"""Fault lists (`--faults FILE.toml`): read, checked, and let strike.

    [[fault]]
    at = 152.0
    kind = "part_moved"
    along_mm = 80.0          # parameters by kind, each with a default

Rows come in any order. A fault strikes at the first instant from `at` on at which it can; one that never
could is told by `unstruck`. Any world serves that has `faults` and `strike`; one with `refusal` has its
values checked too, one with `attempts` is asked again after each of its events, others every half second.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any, Protocol

import msgspec

from planner_reactor.errors import nearest
from planner_reactor.runtime.scheduler import Scheduler
from planner_reactor.workcell.reading import TomlText, kind_name, parse_toml, read_toml, typed

AGAIN_S = 0.5
"""How often a world that does not tell its events is asked again."""


class Strikable(Protocol):
    """The part of a world that faults need."""

    @property
    def faults(self) -> Mapping[str, Mapping[str, Any]]: ...

    def strike(self, kind: str, **parameters: Any) -> bool: ...


class Fault(msgspec.Struct, frozen=True):
    """One row: when from, what, with which parameters (those given; the world adds its defaults)."""

    at: float
    kind: str
    parameters: Mapping[str, Any] = msgspec.field(default_factory=dict)


def read_faults(path: Path, world: Strikable) -> tuple[Fault, ...]:
    """The rows of a fault file, by time; raises InputError with file, line and the nearest name."""
    return _rows(read_toml(path), world)


def faults_from(
    text: str, world: Strikable, *, file: str = "<faults>", beside: tuple[str, ...] = ()
) -> tuple[Fault, ...]:
    """As `read_faults`, from text, which may hold other tables `beside`."""
    return _rows(parse_toml(text, file=file), world, beside)


class FaultSchedule:
    """Lets the faults of a list strike when their time has come."""

    def __init__(self, faults: tuple[Fault, ...], world: Strikable, scheduler: Scheduler) -> None:
        self.waiting: list[Fault] = list(faults)
        self._world = world
        self._scheduler = scheduler
        for fault in faults:
            scheduler.call_at(fault.at, partial(self._due, fault))

    def unstruck(self) -> tuple[Fault, ...]:
        """The faults that have not struck (yet)."""
        return tuple(self.waiting)

    def _due(self, fault: Fault) -> None:
        if self._attempt(fault):
            return
        attempts = getattr(self._world, "attempts", None)
        if attempts is not None:
            attempts.append(partial(self._attempt, fault))
        else:
            self._scheduler.call_after(AGAIN_S, partial(self._due, fault))

    def _attempt(self, fault: Fault) -> bool:
        given = {**self._world.faults[fault.kind], **fault.parameters}
        if not self._world.strike(fault.kind, **given):
            return False
        self.waiting.remove(fault)
        return True


def _rows(source: TomlText, world: Strikable, beside: tuple[str, ...] = ()) -> tuple[Fault, ...]:
    for key in source.values:
        if key != "fault" and key not in beside:
            raise source.error(f"unknown key '{key}'", key=key, hint="expected [[fault]] tables")
    rows = source.values.get("fault", [])
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise source.error("'fault' is no list of tables", key="fault", hint="expected [[fault]] tables")
    return tuple(sorted((_row(source, n, row, world) for n, row in enumerate(rows)), key=lambda fault: fault.at))


def _row(source: TomlText, index: int, row: Mapping[str, Any], world: Strikable) -> Fault:
    def wrong(key: str, message: str, hint: str) -> Exception:
        return source.error(message, table="fault", index=index, key=key if key in row else "", hint=hint)

    at = typed(row.get("at"), 0.0)
    if at is None or not 0 <= at < float("inf"):
        raise wrong(
            "at",
            f"'at' is {row['at']!r}" if "at" in row else "a fault without 'at'",
            "expected seconds, 0 or more",
        )
    kind = row.get("kind")
    if not isinstance(kind, str) or kind not in world.faults:
        shown = f"unknown fault {kind!r}" if "kind" in row else "a fault without 'kind'"
        raise wrong("kind", shown, nearest(str(kind), world.faults) or f"expected one of: {', '.join(world.faults)}")
    given = {key: value for key, value in row.items() if key not in ("at", "kind")}
    refused = _refusal(world, kind, given)
    if refused is not None:
        raise wrong(*refused)
    return Fault(at, kind, given)


def _refusal(world: Strikable, kind: str, given: Mapping[str, Any]) -> tuple[str, str, str] | None:
    refusal = getattr(world, "refusal", None)
    if refusal is not None:
        found: tuple[str, str, str] | None = refusal(kind, given)
        return found
    defaults = world.faults[kind]
    for key, value in given.items():
        if key not in defaults:
            return (key, f"unknown parameter '{key}' of {kind}", nearest(key, defaults))
        if typed(value, defaults[key]) is None:
            return (key, f"'{key}' is {value!r}", f"expected {kind_name(defaults[key])}")
    return None
