"""Orders that are given while kitting goes on (R §2 (3), (6)): adaptations, no stop, no kit and no part lost."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from planner_reactor.calls.looping import loop as run
from planner_reactor.errors import InputError
from planner_reactor.experiments.advice import Adviser
from planner_reactor.experiments.loop import Loop
from planner_reactor.planner import Planner
from planner_reactor.workcell.domains import shipped_domain
from planner_reactor.workcell.host import host
from tests.planner.driving import KITTING, kitting

GOALS = """
[[goal]]
at = 80
kind = "kit"                       # another kit
kinds = ["motor", "body"]
[[goal]]
at = 150
kind = "mix"                       # two of these, one of those
kits = [["motor", "cap", "body"], ["motor", "cap"]]
counts = [2, 1]
[[goal]]
at = 330
kind = "kit"
kinds = ["motor", "cap", "body"]
[[goal]]
at = 360
kind = "substitute"                # caps of another variant
part = "cap"
variant = "cap_b"
[[goal]]
at = 450
kind = "once"                      # one that is not like the others
kinds = ["motor"]
[[goal]]
at = 500
kind = "doubt"                     # downstream will not be ready
assumption = "ADD"
[[goal]]
at = 600
kind = "trust"
assumption = "ADD"
[[goal]]
at = 640
kind = "withdraw"
goal = "Kitting"
[[goal]]
at = 690
kind = "pursue"
goal = "Kitting"
"""
FAULTS = """
[[fault]]
at = 345
kind = "variants"
part = "cap"
variant = "cap_b"
count = 40
share = 0.6
[[fault]]
at = 515
kind = "downstream_blocked"
duration_s = 60.0
"""


@pytest.mark.parametrize("seed", range(2))
def test_all_kinds_of_orders_in_one_run_lose_nothing(tmp_path: Path, seed: int) -> None:
    (tmp_path / "goals.toml").write_text(GOALS)
    (tmp_path / "faults.toml").write_text(FAULTS)
    events: list[Any] = []
    found = run(
        KITTING, host=host, until=770.0, seed=seed, goals=tmp_path / "goals.toml", faults=tmp_path / "faults.toml",
        relax="AO", watch=lambda loop: loop.trace.sinks.append(events.append),
    )  # fmt: skip
    assert found["violations"] == found["refused_advice"] == found["rejections"] == []
    assert found["interruptions"] == found["adaptations"]["refused"] == found["adaptations"]["timed_out"] == 0
    made, parts = found["kits_made"], found["parts"]
    assert parts["arrived"] == sum(count for name, count in parts.items() if name != "arrived")
    assert parts["rejected"] == 0
    assert made["motor"] == 1
    assert made["motor+body"] >= 2
    assert made["motor+cap"] >= 2
    judged = [event.time for event in events if event.kind == "kit_judged"]
    gaps = [b - a for a, b in pairwise(judged) if b < 515 or 600 < a < b < 640]  # downstream was ready
    assert max(gaps) < 75  # a kit takes 28 s, and sometimes one waits for a part
    assert [time for time in judged if 675 < time < 690] == []  # withdrawn: the last one is finished, then nothing
    assert judged[-1] > 690


def test_an_order_takes_effect_between_two_trays() -> None:
    """A tray that is begun for one kit is finished for it, though the order came meanwhile."""
    loop = Loop(Planner(kitting(), relax=()), lambda scheduler, trace: host(scheduler, trace=trace), seed=1)
    adviser = Adviser(loop, shipped_domain(), "kitting.itl")
    adviser.schedule(adviser.read('[[goal]]\nat = 10.0\nkind = "kit"\nkinds = ["motor"]\n'))
    loop.run(until=100.0)
    assert loop.host.world is not None
    report: Any = loop.host.world.report()
    assert report["kits_made"]["motor+cap+body"] == 1
    assert report["kits_made"]["motor"] >= 3
    assert report["kits"]["rejected"] == 0


def adviser() -> Adviser:
    return Adviser(Loop(Planner(kitting()), lambda s, t: host(s, trace=t)), shipped_domain(), "kitting.itl")


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ('[[goal]]\nat = 1\nkind = "persue"\n', "goals.toml:3:1: unknown kind 'persue', did you mean pursue?"),
        ('[[goal]]\nkind = "kit"\n', "goals.toml:1:1: a goal without 'at', expected seconds, 0 or more"),
        ('[[goal]]\nat = 1\nkind = "kit"\nkind_s = 2\n', "unknown parameter 'kind_s' of kit, did you mean kinds?"),
        ('[[goal]]\nat = 1\nkind = "doubt"\n', "doubt without 'assumption', expected assumption = …"),
        ('[[goal]]\nat = 1\nkind = "fact"\nfact = 3\n', "goals.toml:4:1: 'fact' is 3, expected a string"),
        ("[[gaol]]\nat = 1\n", "unknown key 'gaol'"),
    ],
)
def test_what_is_wrong_with_a_file_is_said_before_the_run(rows: str, message: str) -> None:
    with pytest.raises(InputError) as refused:
        adviser().read(rows, file="goals.toml")
    assert message in str(refused.value)


def test_what_cannot_be_made_is_said_and_the_run_goes_on() -> None:
    found = adviser()
    rows = '[[goal]]\nat = 0\nkind = "kit"\nkinds = ["motr"]\n[[goal]]\nat = 1\nkind = "withdraw"\ngoal = "Kiting"\n'
    for advice in found.read(rows):
        found.give(advice)
    assert found.refused == [
        "kit at 0 s: the belt brings no motr, did you mean motor?",
        "withdraw at 0 s: Kiting is not pursued, did you mean Kitting?",
    ]
