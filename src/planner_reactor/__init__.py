"""planner-reactor: robot programs that start acting at once and keep improving while they run.

Everything that the command does is also a call of the same name here: `run`, `check`, `loop`, `kit`, `plan`,
`network`, `experiment`, `bench`, `evolve`, `limits`, `lts`, `verify`, `dynamics` (see `planner_reactor.calls`). They
are imported only when they are asked for.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from planner_reactor.calls.checking import check
    from planner_reactor.calls.deriving import dynamics
    from planner_reactor.calls.evolving import evolve, limits
    from planner_reactor.calls.looping import kit, loop
    from planner_reactor.calls.measuring import bench, experiment
    from planner_reactor.calls.networks import network
    from planner_reactor.calls.planning import plan
    from planner_reactor.calls.running import run
    from planner_reactor.calls.transitions import lts
    from planner_reactor.calls.verifying import verify

__all__ = [
    "bench", "check", "dynamics", "evolve", "experiment", "kit", "limits", "loop", "lts", "network", "plan", "run",
    "verify",
]  # fmt: skip

_MODULES = {
    "bench": "measuring",
    "check": "checking",
    "dynamics": "deriving",
    "evolve": "evolving",
    "experiment": "measuring",
    "kit": "looping",
    "limits": "evolving",
    "loop": "looping",
    "lts": "transitions",
    "network": "networks",
    "plan": "planning",
    "run": "running",
    "verify": "verifying",
}


def __getattr__(name: str) -> Any:
    """The call of this name."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"planner_reactor.calls.{_MODULES[name]}"), name)


def __dir__() -> list[str]:
    return [*globals(), *__all__]
