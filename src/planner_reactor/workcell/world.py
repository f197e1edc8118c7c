"""The cell as the executer and an experiment see it: start, books, faults, report.

It satisfies the executer's `World` protocol. The truth lives in `plant`; here is the record of the run: which
faults struck, when evidence of each first reached a sensor, and which kits they cost. Times are seconds on
the run's clock.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from planner_reactor.errors import InputError, nearest
from planner_reactor.runtime.scheduler import Scheduler
from planner_reactor.workcell.arm import Arm
from planner_reactor.workcell.disturbances import DISTURBANCES
from planner_reactor.workcell.ledger import Finding
from planner_reactor.workcell.orders import ORDERS, Advise, Orders
from planner_reactor.workcell.plant import Plant
from planner_reactor.workcell.reading import kind_name, typed
from planner_reactor.workcell.sensors import Sensors


@dataclass(slots=True)
class FaultRecord:
    """A fault that struck: `sensed_s` is when evidence of it first reached a sensor (None: not yet)."""

    number: int
    kind: str
    breaks: str
    parameters: Mapping[str, Any]
    struck_s: float
    sensed_s: float | None = None
    kits_lost: int = 0


class World:
    """One cell. `target`: the run is finished when so many kits are completed (0: never)."""

    def __init__(self, plant: Plant, *, target: int = 0) -> None:
        self.plant = plant
        self.target = target
        self.arm: Arm | None = None
        self.sensors: Sensors | None = None  # which can be made to hang
        self._orders = Orders(plant.kit, plant)
        self.struck: list[FaultRecord] = []
        self._unsensed: list[FaultRecord] = []

    @property
    def faults(self) -> Mapping[str, Mapping[str, Any]]:
        """Every kind of fault, with its parameters and their defaults."""
        return {name: disturbance.defaults for name, disturbance in DISTURBANCES.items()}

    @property
    def findings(self) -> list[Finding]:
        """Every difference between books and containers so far (none, if all is well)."""
        return self.plant.findings

    @property
    def attempts(self) -> list[Callable[[], bool]]:
        """What is tried after every event until it is True (faults that wait for their moment)."""
        return self.plant.attempts

    def start(self, scheduler: Scheduler) -> None:
        """Let things happen. A second call has no effect."""
        self.plant.start()

    def ledger(self) -> Mapping[str, int]:
        """The parts account: `arrived` = the sum of the others."""
        return {"arrived": self.plant.books.parts_arrived, **self.plant.books.parts}

    def trays(self) -> Mapping[str, int]:
        """The trays account: `arrived` = the sum of the others."""
        return {"arrived": self.plant.books.trays_arrived, **self.plant.books.trays}

    def commands(self) -> Mapping[str, int]:
        """The arm's commands: `sent` = the sum of the others."""
        arm = self.arm
        if arm is None:
            return {"sent": 0, "done": 0, "abandoned": 0, "live": 0}
        made = arm.commands
        return {
            "sent": made.sent,
            "done": made.done,
            "abandoned": made.abandoned,
            "live": int(bool(arm.live)),
        }

    def balanced(self) -> bool:
        """Have all books come out, so far and now: parts, trays, commands; and is what is held somebody's?"""
        arm = self.arm
        if arm is not None:
            books = self.commands()
            if books["sent"] != books["done"] + books["abandoned"] + books["live"]:
                self._find("commands", f"sent {books['sent']}, accounted for {sum(books.values()) - books['sent']}")
            if arm.gripped and arm.owner is None and not arm.reconciling:
                self._find("held", "the arm holds something, and nobody will see to it")
        return self.plant.balanced()

    def finished(self) -> bool:
        """Are as many kits completed as were asked for?"""
        return 0 < self.target <= self.plant.downstream.completed

    @property
    def orders(self) -> Mapping[str, Mapping[str, Any]]:
        """Every kind of order that is taken, with its parameters and their defaults."""
        return ORDERS

    def order(self, kind: str, advise: Advise, **parameters: Any) -> None:
        """What is ordered from now on; the planner is told by `advise` (InputError for what cannot be made)."""
        self._orders.take(kind, advise, **parameters)

    def refusal(self, kind: str, parameters: Mapping[str, Any]) -> tuple[str, str, str] | None:
        """Why a fault cannot be: (key, message, hint), or None. Looks at names, types and values."""
        if kind not in DISTURBANCES:
            return ("kind", f"unknown fault '{kind}'", nearest(kind, DISTURBANCES) or _listed(DISTURBANCES))
        defaults = DISTURBANCES[kind].defaults
        for key, value in parameters.items():
            if key not in defaults:
                hint = nearest(key, defaults) or (_listed(defaults) if defaults else "it has no parameters")
                return (key, f"unknown parameter '{key}' of {kind}", hint)
            if typed(value, defaults[key]) is None:
                return (key, f"'{key}' is {value!r}", f"expected {kind_name(defaults[key])}")
            if (wrong := self._wrong_value(kind, key, value, parameters)) is not None:
                return wrong
        return None

    def strike(self, kind: str, **parameters: Any) -> bool:
        """Let a fault happen now. False: it cannot yet (nothing changed). Raises InputError for a wrong
        request.
        """
        if (wrong := self.refusal(kind, parameters)) is not None:
            raise InputError(", ".join(part for part in wrong[1:] if part))
        disturbance = DISTURBANCES[kind]
        full = {**disturbance.defaults, **parameters}
        record = FaultRecord(len(self.struck) + 1, kind, disturbance.breaks, full, self.plant.scheduler.now)
        self.struck.append(record)
        self._unsensed.append(record)
        if not disturbance.strike(self.plant, record.number, full):
            self.struck.remove(record)
            self._unsensed.remove(record)
            return False
        if self.plant.trace is not None:
            self.plant.trace.record("fault_struck", number=record.number, fault=kind, breaks=record.breaks)
        return True

    def sensed(self, subject: str) -> None:
        """Evidence about `subject` (an assumption or a sensor) reached the cell: whatever it shows is sensed."""
        if not self._unsensed:
            return
        for record in [r for r in self._unsensed if subject in DISTURBANCES[r.kind].sensed_by]:
            record.sensed_s = self.plant.scheduler.now
            self._unsensed.remove(record)
            if self.plant.trace is not None:
                self.plant.trace.record("fault_sensed", number=record.number, fault=record.kind, by=subject)

    def report(self) -> Mapping[str, Any]:
        """Kits, parts, trays, faults and lost kits, JSON-able."""
        downstream = self.plant.downstream
        by_number = {record.number: record for record in self.struck}
        for record in self.struck:
            record.kits_lost = sum(record.number in lost.faults for lost in downstream.rejections)
        return {
            "kits": {"completed": downstream.completed, "rejected": len(downstream.rejections)},
            **({"kits_made": dict(downstream.made)} if self._orders.given else {}),
            "parts": dict(self.ledger()),
            "trays": dict(self.trays()),
            "commands": dict(self.commands()),
            "faults": [
                {
                    "kind": r.kind, "breaks": r.breaks, "struck_s": r.struck_s, "sensed_s": r.sensed_s,
                    "kits_lost": r.kits_lost,
                }
                for r in self.struck
            ],
            "rejections": [
                {
                    "time_s": lost.time, "tray": lost.tray, "reasons": list(lost.reasons),
                    "faults": [by_number[n].kind for n in lost.faults],
                    "assumptions": sorted({by_number[n].breaks for n in lost.faults} - {""}),
                }
                for lost in downstream.rejections
            ],
            "findings": [f"{f.time:.3f} s: {f.law}: {f.message}" for f in self.findings],
        }  # fmt: skip

    def _find(self, law: str, message: str) -> None:
        self.plant.findings.append(Finding(law, self.plant.scheduler.now, message))

    def _wrong_value(
        self, kind: str, key: str, value: Any, parameters: Mapping[str, Any]
    ) -> tuple[str, str, str] | None:
        kit = self.plant.kit
        if key == "part" and value and value not in kit.by_kind:
            return (key, f"'{value}' is no part kind", nearest(value, kit.kinds) or _listed(kit.kinds))
        if key == "variant" and value:
            part = kit.by_kind.get(parameters.get("part", "") or kit.order[0])
            if part is not None and value not in part.variants:
                return (key, f"'{value}' is no variant of {part.kind}", nearest(value, part.variants))
        if key in ("count", "slots") and value < 1:
            return (key, f"'{key}' is {value}", "expected at least 1")
        if key in ("share", "duration_s", "phase_s") and (value < 0 or (key == "share" and not 0 < value <= 1)):
            return (
                key,
                f"'{key}' is {value}",
                "expected above 0 to 1" if key == "share" else "expected 0 or more",
            )
        return None


def _listed(names: Mapping[str, Any] | tuple[str, ...]) -> str:
    return f"expected one of: {', '.join(names)}"
