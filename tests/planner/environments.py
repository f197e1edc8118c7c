"""Environment models that are like those of the second paper, but different: what is derived has to differ too."""

from __future__ import annotations

from planner_reactor.planner.dynamics import Dynamics, derive
from planner_reactor.planner.exploiting_text import DerivedAction
from planner_reactor.rs.parser import parse_program
from planner_reactor.workcell.environments.dynamics import host, model

TEM, GEM, BEM = (model(name) for name in ("tracking", "guarded_move", "belt"))

TWO_CAMERAS = TEM + """
TwoEyes[p, a, b] = Object[p] | Eye[a, angle, pos] | Eye[b, angle2, pos2]
Eye[a, angle, pos] = (Glance[a, pos] # IN[angle]<na>) : Eye[na, angle, pos]
Glance[a, pos] = (Delay[ts0] ; IN[op]<p> ; Delay[ts1]) :: (InView[p, a] : ReportAt[p, pos])
ReportAt[p, pos] = STREAM[pos, p] # Delay[ts0]
sense2 = (IN[pos2]<v> ; Delay[gl]) :; (STREAM[s2, v] # Delay[tl])
motor2 = (IN[m2]<v> ; Delay[gm]) :; (STREAM[angle2, v] # Delay[tm])
"""

TWO_AXES = """
TEM2[x, y, a, b] = Object[x, y] | Camera[a, b]
Object[x, y] = ((STREAM[ox, x] | STREAM[oy, y]) # Delay[t0])
    ; (Ran[-eps, eps]<g> : Ran[-eps, eps]<h> : Object[x + g, y + h])
Camera[a, b] = (Monitor[a, b] # (IN[pan]<na> & IN[tilt]<nb>)) : Camera[na, nb]
Monitor[a, b] = (Delay[ts0] ; (IN[ox]<x> & IN[oy]<y>) ; Delay[ts1])
    :: (InView[x, a] : InView[y, b] : ReportPos[x, y])
ReportPos[x, y] = (STREAM[px, x] | STREAM[py, y]) # Delay[ts0]
sensex = (IN[px]<v> ; Delay[gl]) :; (STREAM[sx, v] # Delay[tl])
sensey = (IN[py]<v> ; Delay[gl]) :; (STREAM[sy, v] # Delay[tl])
panning = (IN[mp]<v> ; Delay[gm]) :; (STREAM[pan, v] # Delay[tm])
tilting = (IN[mt]<v> ; Delay[gm]) :; (STREAM[tilt, v] # Delay[tm])
"""

BACKWARDS = BEM.replace("LST[p, nu] : BeltObject[p + mu]", "GTR[p, nu] : BeltObject[p - mu]")


def derived(source: str, process: str, **given: float) -> Dynamics:
    return derive(parse_program(source), process, signatures=host.signatures, given=given)


def action(found: Dynamics, name: str) -> DerivedAction:
    return next(a for a in found.actions if a.name == name)


def names(found: Dynamics) -> list[str]:
    return [a.name for a in found.actions]
