"""The online monitor: live runs are followed to their end, defects are seen, and what cannot be judged is said."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from planner_reactor.calls.conforming import Monitor, attend, written
from planner_reactor.calls.looping import kit
from planner_reactor.calls.running import run
from planner_reactor.experiments.loop import Loop
from planner_reactor.reactor.built_ins import BuiltIns
from planner_reactor.reactor.situations import Situations
from planner_reactor.rs.parser import parse_program
from planner_reactor.runtime import Budgets, Executer, Host, Scheduler, VirtualClock
from planner_reactor.trace import Trace

FAULTS = """\
[[fault]]
kind = "bad_parts"
at = 3
[[fault]]
kind = "tray_moved"
at = 20
[[fault]]
kind = "part_moved"
at = 40
"""


def test_a_kitting_run_is_followed_from_its_first_step_and_left_as_it_was() -> None:
    alone, watched = kit(until=90.0, seed=1), kit(until=90.0, seed=1, conform=True)
    conformance = watched.pop("conformance")
    assert conformance["disagreement"] is None
    assert conformance["blind"] is None
    assert conformance["steps"] > 300
    assert conformance["roots"] == 1 + watched["adaptations"]["issued"]
    assert watched["trace_hash"] == alone["trace_hash"]


@pytest.mark.parametrize("seed", [1, 2])
def test_a_run_in_which_assumptions_fail_is_followed(seed: int, tmp_path: Path) -> None:
    faults = tmp_path / "faults.toml"
    faults.write_text(FAULTS, encoding="utf-8")
    result = kit(until=120.0, seed=seed, faults=faults, planner_time=1.0, conform=True)
    assert any(relaxation["cause"] == "forced" for relaxation in result["relaxations"])
    assert result["conformance"]["disagreement"] is None
    assert result["conformance"]["blind"] is None


DEFECTS: dict[str, tuple[object, str, Any]] = {
    "verdicts are turned round": (
        Situations, "finish", lambda self, name, number, ok, was=Situations.finish: was(self, name, number, ok=not ok)
    ),
    "DRAIN withdraws nothing": (Situations, "_withdraw", lambda self, situation: None),
    "an inhibition is not released": (Situations, "uninhibit", lambda self, name, owner: True),
}  # fmt: skip


@pytest.mark.parametrize("defect", DEFECTS)
def test_a_defect_of_the_executer_is_seen_in_a_kitting_run(defect: str, monkeypatch: pytest.MonkeyPatch) -> None:
    place, name, wrong = DEFECTS[defect]
    monkeypatch.setattr(place, name, wrong)
    result = kit(until=60.0, seed=1, conform=True)
    assert result["conformance"]["disagreement"] is not None
    assert result["conformance"]["last"]


def _monitored(text: str, *, slow: float = 0.0, lateness: float = 0.0, budgets: Budgets | None = None) -> Monitor:
    """The monitor of a run of Main, in a host whose `Work` says 1 s and takes `slow` s longer."""
    scheduler, host = Scheduler(VirtualClock()), Host("slow")

    @host.process(window=(0.0, 1.0), limit=100.0)
    def Work() -> Any:
        yield 1.0 + slow

    program, trace = parse_program(text), Trace(lambda: scheduler.now, keep=False)
    built = BuiltIns(scheduler)
    executer = Executer(
        program, scheduler=scheduler, host=host, controls=built.controls, trace=trace, budgets=budgets,
        on_end=built.situations.root_ended,
    )  # fmt: skip
    built.attach(executer)
    honest = Host("honest")
    honest.process(window=(0.0, 1.0), name="Work")(Work)
    monitor = Monitor(executer, program, honest, trace, lateness=lateness)
    executer.start("Main")
    executer.run(until=20.0)
    return monitor


def test_who_is_late_disagrees_but_for_what_is_excused() -> None:
    text = "Main = Work : Delay[1] : Work"
    assert _monitored(text).disagreement is None
    assert "at most 1.0 allowed" in str(_monitored(text, slow=0.2).disagreement)
    assert _monitored(text, slow=0.2, lateness=0.5).disagreement is None
    assert "0.600 s late" in str(_monitored(text, slow=0.6, lateness=0.5).disagreement)


def test_what_a_budget_does_is_not_judged() -> None:
    monitor = _monitored("Main = GTR[2, 1] :; GTR[2, 1]", budgets=Budgets(turns=50))
    assert monitor.disagreement is None
    assert "budget" in str(monitor.blind)


def test_a_root_that_is_killed_takes_its_inhibitions_with_it() -> None:
    made: list[Monitor] = []

    def watch(loop: Loop) -> None:
        made.append(attend(loop.reactor))
        root = []
        loop.scheduler.call_after(1.0, lambda: root.append(_inhibiting(loop)))
        loop.scheduler.call_after(3.0, lambda: loop.reactor.executer.kill(root[0]))

    kit(until=30.0, seed=1, watch=watch)
    assert made[0].disagreement is None
    assert made[0].steps > 100


def _inhibiting(loop: Loop) -> Any:
    return loop.reactor.executer.start_process(parse_program("X = INHIBIT[none] : DRAIN[nobody] : NIL").schemas[0].body)


def test_a_program_is_followed_and_its_labels_are_written_for_people(tmp_path: Path) -> None:
    file = tmp_path / "orders.rsl"
    file.write_text(
        "Main<bill> = ASSERT[order, 2]<bill> # Waiter\n"
        "Waiter = SIT[order]<k, n> :; (Delay[n] : UPDATE[order, k, 3] : SUCCEED[order, k])",
        encoding="utf-8",
    )
    result = run(file, "Main<bill>", conform=True)
    assert result["results"] == {"bill": 3}
    assert result["conformance"] | {"last": []} == {
        "steps": 5, "roots": 1, "until_s": 2.0, "disagreement": None, "blind": None, "last": [],
    }  # fmt: skip
    assert "conformance" not in run(file, "Main<bill>")
    assert written(("SIT", ("order",), "ok", (1, 2))) == "SIT[order]<1, 2> ok"
