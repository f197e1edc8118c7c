"""What management says while a run goes on (R §2 (3), (4), (6)): goals, facts, doubts, orders; from a file (`--goals`).

    [[goal]]
    at = 600.0
    kind = "pursue"            # withdraw; adopt; fact; doubt; trust; or an order that the world takes
    goal = "Cleaning"

`pursue` and `withdraw` name a `goal` of the domain, `adopt` a file `domain` that takes its place, `fact` a ground atom
that holds from then on (or, with `holds = false`, no more: a resource that is down), `doubt` and `trust` an
`assumption`. A world may take orders of its own, such as another product: it has `orders`, kinds with their parameters
and defaults, and `order(kind, advise, …)`, which makes the world expect what is ordered and tells the planner by
`advise(rewrite, doubts)`: how its text changes, and which assumptions are not to be trusted any more. Rows come in any
order; each is given at its time, whatever goes on, and becomes adaptations like any other.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, Protocol

import msgspec

from planner_reactor.errors import InputError, nearest
from planner_reactor.experiments.loop import Loop
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner
from planner_reactor.planner.goals import with_fact
from planner_reactor.workcell.reading import TomlText, kind_name, parse_toml, typed

KINDS: Mapping[str, Mapping[str, Any]] = {
    "pursue": {"goal": ""},
    "withdraw": {"goal": ""},
    "adopt": {"domain": ""},
    "fact": {"fact": "", "holds": True},
    "doubt": {"assumption": ""},
    "trust": {"assumption": ""},
}
Rewrite = Callable[[str], str]
Advise = Callable[[Rewrite | None, tuple[str, ...]], None]


class Ordered(Protocol):
    """The part of a world that takes orders."""

    @property
    def orders(self) -> Mapping[str, Mapping[str, Any]]: ...

    def order(self, kind: str, advise: Advise, **parameters: Any) -> None: ...


class Advice(msgspec.Struct, frozen=True):
    """One row: when, what, with which parameters (all of them)."""

    at: float
    kind: str
    parameters: Mapping[str, Any] = msgspec.field(default_factory=dict)


class Adviser:
    """Gives advice to the planner of a run. `text` is the domain as it is now."""

    def __init__(self, loop: Loop, text: str, file: str, *, folder: Path | None = None) -> None:
        self.text, self.file = text, file
        self._loop = loop
        self._folder = folder or Path()
        self._facts: dict[str, bool] = {}
        self.refused: list[str] = []  # what could not be done, and why

    def read(self, rows: str, *, file: str = "<goals>") -> tuple[Advice, ...]:
        """The rows of a file, by time; InputError with file, line and the nearest name."""
        source = parse_toml(rows, file=file)
        for key in source.values:
            if key != "goal":
                raise source.error(f"unknown key '{key}'", key=key, hint="expected [[goal]] tables")
        found = source.values.get("goal", [])
        if not isinstance(found, list) or not all(isinstance(row, dict) for row in found):
            raise source.error("'goal' is no list of tables", key="goal", hint="expected [[goal]] tables")
        kinds = {**KINDS, **getattr(self._loop.host.world, "orders", {})}
        return tuple(sorted((_row(source, n, row, kinds) for n, row in enumerate(found)), key=lambda a: a.at))

    def schedule(self, advice: tuple[Advice, ...]) -> None:
        """Give each when its time has come."""
        for one in advice:
            if one.kind == "adopt":
                name = one.parameters["domain"]
                read_domain(self._read(name), file=name)  # a slip in it is told before the run begins
            self._loop.scheduler.call_at(one.at, partial(self.give, one))

    def give(self, advice: Advice) -> None:
        """Give it now; what cannot be done is recorded, and the run goes on."""
        self._loop.trace.record("advice", advice=advice.kind, **advice.parameters)
        try:
            self._give(advice.kind, advice.parameters)
        except InputError as problem:
            self._loop.trace.record("advice_refused", advice=advice.kind, because=str(problem))
            self.refused.append(f"{advice.kind} at {self._loop.scheduler.now:g} s: {problem}")

    def _give(self, kind: str, given: Mapping[str, Any]) -> None:
        tell = self._loop.tell
        match kind:
            case "pursue":
                tell(lambda planner: planner.pursue(given["goal"]))
            case "withdraw":
                tell(lambda planner: planner.withdraw(given["goal"]))
            case "adopt":
                self._advise(lambda text: self._read(given["domain"]), ())
            case "fact":
                tell(lambda planner: planner.tell(given["fact"], holds=given["holds"]))
                self._facts[given["fact"]] = given["holds"]
            case "doubt":
                self._advise(None, (given["assumption"],))
            case "trust":
                tell(lambda planner: planner.trust(given["assumption"]))
            case _:
                world: Any = self._loop.host.world
                world.order(kind, self._advise, **given)

    def _advise(self, rewrite: Rewrite | None, doubts: tuple[str, ...]) -> None:
        """The planner's text changes, and what is not to be trusted any more: both at once."""
        text = self.text if rewrite is None else rewrite(self.text)

        def told(planner: Planner) -> None:
            if text != self.text:
                domain = read_domain(text, file=self.file)
                for fact, holds in self._facts.items():
                    with suppress(InputError):  # the new text says so itself
                        domain = with_fact(domain, fact, holds=holds)
                planner.adopt(domain)
                self.text = text
            for name in doubts:
                planner.doubt(name)

        self._loop.tell(told)

    def _read(self, domain: str) -> str:
        try:
            return (self._folder / domain).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"{domain}: cannot be read: {error}") from error


def _row(source: TomlText, index: int, row: Mapping[str, Any], kinds: Mapping[str, Mapping[str, Any]]) -> Advice:
    def wrong(key: str, message: str, hint: str) -> Exception:
        return source.error(message, table="goal", index=index, key=key if key in row else "", hint=hint)

    at = typed(row.get("at"), 0.0)
    if at is None or not 0 <= at < float("inf"):
        shown = f"'at' is {row['at']!r}" if "at" in row else "a goal without 'at'"
        raise wrong("at", shown, "expected seconds, 0 or more")
    kind = row.get("kind")
    if not isinstance(kind, str) or kind not in kinds:
        shown = f"unknown kind {kind!r}" if "kind" in row else "a goal without 'kind'"
        raise wrong("kind", shown, nearest(str(kind), kinds) or f"expected one of: {', '.join(kinds)}")
    given, defaults = {key: value for key, value in row.items() if key not in ("at", "kind")}, kinds[kind]
    for key, value in given.items():
        if key not in defaults:
            hint = nearest(key, defaults) or f"expected one of: {', '.join(defaults)}"
            raise wrong(key, f"unknown parameter '{key}' of {kind}", hint)
        if not _fits(value, defaults[key]):
            raise wrong(key, f"'{key}' is {value!r}", f"expected {kind_name(defaults[key])}")
    full = {**defaults, **given}
    for key, value in full.items():
        if value in ("", []):
            raise wrong(key, f"{kind} without '{key}'", f"expected {key} = …")
    return Advice(at, kind, full)


def _fits(value: Any, default: Any) -> bool:
    return isinstance(value, list) if isinstance(default, list) else typed(value, default) is not None
