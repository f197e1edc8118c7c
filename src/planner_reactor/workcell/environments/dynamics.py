"""Environment models of the second paper, as texts, and the host of the one basic process that they need.

`tracking.rsl`, `guarded_move.rsl` and `belt.rsl` are TEM, GEM and BEM (X §5) with their misprints corrected; each says
which. `--host planner_reactor.workcell.environments.dynamics` brings InView. What follows from the models is found by
`analysis.limits`, from the texts alone.
"""

from __future__ import annotations

from importlib.resources import files

from planner_reactor.runtime.host import Host
from planner_reactor.runtime.signals import Aborted

MODELS = ("tracking", "guarded_move", "belt")

FIELD = 1.0
"""How far from where the camera looks an object may be and still be seen, on the line on which both live."""

STRIDE = 0.5
"""How far a robot goes for one command at most."""


def model(name: str) -> str:
    """The text of the model `tracking`, `guarded_move` or `belt`."""
    return (files(__package__ or __name__) / f"{name}.rsl").read_text(encoding="utf-8")


def senses(field: float = FIELD, stride: float = STRIDE) -> Host:
    """What the texts need: a camera that sees so far to either side, a robot that goes so far for one command."""
    made = Host("dynamics")

    @made.process(window=(0.0, 0.0), name="InView", means=f"~GTR[p - a, {field}] : ~GTR[a - p, {field}]")
    def in_view(p: float, a: float) -> None:
        """Is an object at p in view of a camera that looks at a?"""
        if abs(p - a) > field:
            raise Aborted("not in view")

    @made.process(window=(0.0, 0.0), name="Comes")
    def comes() -> None:
        """The next object is there: for whoever observes."""

    @made.function
    def limited(step: float) -> float:
        """The step that a motor takes when it is told to take this one."""
        return max(-stride, min(stride, step))

    return made


host = senses()
