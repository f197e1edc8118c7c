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

host = Host("dynamics")


def model(name: str) -> str:
    """The text of the model `tracking`, `guarded_move` or `belt`."""
    return (files(__package__ or __name__) / f"{name}.rsl").read_text(encoding="utf-8")


@host.process(window=(0.0, 0.0), means=f"~GTR[p - a, {FIELD}] : ~GTR[a - p, {FIELD}]")
def InView(p: float, a: float) -> None:
    """Is an object at p in view of a camera that looks at a?"""
    if abs(p - a) > FIELD:
        raise Aborted("not in view")
