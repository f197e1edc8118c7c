"""Signals of the second paper, from runs in the executer: X Fig. 2, an object and a camera, and X Fig. 4, a dense port.

Fig. 2 is a picture of the tracking environment in the paper. Ours is one of what happens in it: where the object is,
how far the camera sees, and when it sees it, while a reaction made of LOOK and MOVECAMERA is at work. Fig. 4 shows a
source of Definition 1: what it offers, and the square wave of period γ + τ that bounds it.
`python -m planner_reactor.experiments.figures_signals DIRECTORY` draws both.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import matplotlib
import msgspec
from matplotlib.axes import Axes

from planner_reactor.experiments import figures_style as style
from planner_reactor.experiments.figures_networks import draw_networks
from planner_reactor.planner.dynamics import schemas
from planner_reactor.rs.given import with_values
from planner_reactor.rs.parser import parse_program
from planner_reactor.runtime import Aborted, Executer, Host, Scheduler, VirtualClock
from planner_reactor.workcell.environments.dynamics import FIELD, host, model

TIMING: Mapping[str, float] = {
    "t0": 0.8, "ts0": 0.1, "ts1": 0.05, "gl": 0.02, "tl": 0.005, "gm": 0.05, "tm": 0.005, "eps": 0.9,
}  # fmt: skip
SECONDS = 24.0
SOURCE = "Source = Term[gamma] ; ((Began ; (STREAM[x, 1] # Term[tau])) ; (Ended ; Source))\n"
GAMMA, TAU = 0.4, 0.6


class Look(msgspec.Struct, frozen=True):
    """One look of the camera: when, where the object was, where it was aimed, and did it see the object?"""

    at: float
    place: float
    aim: float
    seen: bool


def looks(seconds: float = SECONDS, seed: int = 4) -> list[Look]:
    """A run of the tracking environment with the reaction that its own derived actions make."""
    found: list[Look] = []
    scheduler = Scheduler(VirtualClock(), seed=seed)
    station = Host("tracking")

    @station.process(window=(0.0, 0.0), name="InView")
    def in_view(p: float, a: float) -> None:
        found.append(Look(scheduler.now, p, a, abs(p - a) <= FIELD))
        if abs(p - a) > FIELD:
            raise Aborted("not in view")

    text = model("tracking")
    actions = {a.name: a.rs_text for a in schemas(parse_program(text), "TEM", signatures=host.signatures)}
    text += f"{actions['LOOK']}\n{actions['MOVECAMERA']}\nTRACK[p] = LOOK[p] | MOVECAMERA[p]\n"
    executer = Executer(with_values(parse_program(text), TIMING), scheduler=scheduler, host=station)
    executer.start("TEM", (0.0, 0.0))
    for name, arguments in (("sense1", ()), ("motor1", ()), ("TRACK", ("track",))):
        executer.start(name, arguments)
    executer.run(until=seconds)
    return found


def offers(seconds: float = 6.0, seed: int = 3) -> list[tuple[float, float]]:
    """When a source of Definition 1 offers its port: (from, to)."""
    scheduler = Scheduler(VirtualClock(), seed=seed)
    station = Host("source")
    edges: list[float] = []
    for name in ("Began", "Ended"):
        station.process(window=(0.0, 0.0), outcomes=("stop",), name=name)(lambda: edges.append(scheduler.now))
    program = with_values(parse_program(SOURCE), {"gamma": GAMMA, "tau": TAU})
    executer = Executer(program, scheduler=scheduler, host=station)
    executer.start("Source")
    executer.run(until=seconds)
    return list(zip(edges[::2], edges[1::2], strict=False))


def draw_signals(directory: Path) -> list[Path]:
    """Write `x-fig2` and `x-fig4` as PNG and SVG."""
    with matplotlib.rc_context(style.STYLE):
        tracking = style.canvas(7.2, 3.4)
        _tracking(tracking.add_axes((0.08, 0.14, 0.9, 0.74)), looks())
        dense = style.canvas(7.2, 2.4)
        _dense(dense.add_axes((0.08, 0.2, 0.9, 0.62)), offers())
    return [*style.save(tracking, directory, "x-fig2"), *style.save(dense, directory, "x-fig4")]


def _tracking(axes: Axes, found: list[Look]) -> None:
    at = [look.at for look in found]
    axes.fill_between(at, [k.aim - FIELD for k in found], [k.aim + FIELD for k in found], step="post",
                      color=style.SKY, alpha=0.3, linewidth=0, label="what the camera sees")  # fmt: skip
    axes.step(at, [k.aim for k in found], where="post", color=style.BLUE, linewidth=1.0, linestyle=style.DASHED,
              label="where it is aimed")  # fmt: skip
    axes.step(at, [k.place for k in found], where="post", color=style.INK, linewidth=1.6, label="the object")
    lost = [k for k in found if not k.seen]
    unseen = [k.at for k in lost], [k.place for k in lost]
    axes.plot(*unseen, "x", color=style.VERMILLION, label=f"not seen: {len(lost)}")
    axes.set_title("Fig. 2  the tracking environment, run with LOOK and MOVECAMERA")
    axes.set_xlabel("seconds")
    axes.set_ylabel("position")
    axes.legend(loc="best", ncol=2)


def _dense(axes: Axes, found: list[tuple[float, float]]) -> None:
    last = found[-1][1]
    edges, levels = [0.0], [0.0]
    for begun, ended in found:
        edges += [begun, ended]
        levels += [1.0, 0.0]
    axes.step(edges, levels, where="post", color=style.BLUE, label="offered")
    period, wave = GAMMA + TAU, [0.0]
    while wave[-1] < last:
        wave += [wave[-1] + GAMMA, wave[-1] + period]
    axes.step(wave, [-1.5 if n % 2 == 0 else -0.5 for n in range(len(wave))], where="post", color=style.VERMILLION,
              linestyle=style.DASHED, label="bound: period γ + τ, duty τ / (γ + τ)")  # fmt: skip
    axes.annotate("", (GAMMA, -1.7), (0, -1.7), arrowprops={"arrowstyle": "<->", "color": style.GREY})
    axes.annotate("", (period, -1.7), (GAMMA, -1.7), arrowprops={"arrowstyle": "<->", "color": style.GREY})
    axes.text(GAMMA / 2, -2.2, "γ", ha="center", fontsize=9)
    axes.text(GAMMA + TAU / 2, -2.2, "τ", ha="center", fontsize=9)
    axes.set_ylim(-2.5, 1.6)
    axes.set_xlim(0, last)
    axes.set_yticks([])
    axes.set_title("Fig. 4  a (γ, τ)-dense port: no silence longer than γ, no offer longer than τ")
    axes.set_xlabel("seconds")
    axes.legend(loc="lower right", ncol=2, bbox_to_anchor=(1.0, 0.0))


def experiment(
    out: Path, *, trials: int | None, workers: int, watch: Callable[[int, int], object]
) -> Mapping[str, Any]:
    """The second paper's Figs 2 to 8 as PNG and SVG, and how often the camera of Fig. 2 lost the object."""
    watch(0, 1)
    written = [*draw_signals(out), *draw_networks(out)]
    watch(1, 1)
    found = looks()
    return {"figures": [path.name for path in written], "looks": len(found), "lost": sum(not k.seen for k in found)}


if __name__ == "__main__":
    for path in draw_signals(Path(sys.argv[1])):
        print(path)
