"""The host: what it registers, and that RS programs build kits with it, the same in every process."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from planner_reactor.rs.parser import parse_program
from planner_reactor.runtime import Executer, Host, Scheduler, VirtualClock
from planner_reactor.trace import Trace
from planner_reactor.workcell.evidence import ASSUMPTIONS
from planner_reactor.workcell.host import host
from planner_reactor.workcell.kit import plain_kit

NAMES = (
    "FindGetInsert Find Get Move Insert PutBack Deliver Choose AwaitArrival Test Locate Track LocateTray "
    "SlotVacant Verify AwaitReady"
)

TRUSTING = """
KITS = STOP :; KIT
KIT = Find[tray]<t> : Move[t, trayarea]
    : (FindGetInsert[motor, t] & FindGetInsert[cap, t] & FindGetInsert[body, t]) : Deliver[t]
"""

CAREFUL = """
KITS = STOP :; KIT
KIT = Find[tray]<t> : Test[tray, t] : Move[t, trayarea] : (FILL[motor, t] & FILL[cap, t] & FILL[body, t])
    : AwaitReady : Verify[t] : Deliver[t]
FILL[m, t] = ((Choose[m]<d> & AwaitArrival[m]) : Locate[d]<x> : (Track[x] # Get[x]) : Test[m, x]
    : (if SlotVacant[t, m] then LocateTray[t] : Insert[x, t] else PutBack[x])) ; STOP
"""


def run(text: str, *, seed: int = 1, until: float = 400.0) -> tuple[Host, Trace]:
    scheduler = Scheduler(VirtualClock(), seed=seed)
    trace = Trace(lambda: scheduler.now)
    made = host(scheduler, trace=trace)
    assert made.world is not None
    made.world.start(scheduler)
    executer = Executer(parse_program(text), host=made, scheduler=scheduler, trace=trace)
    executer.start("KITS")
    executer.run(until=until)
    return made, trace


def fresh(**options: object) -> Host:
    return host(Scheduler(VirtualClock()), **options)  # type: ignore[arg-type]


def test_it_registers_the_processes_of_the_domain_and_the_nine_assumptions() -> None:
    made = fresh()
    assert sorted(made.signatures) == sorted(NAMES.split())
    assert tuple(made.assumptions) == ASSUMPTIONS


@pytest.mark.parametrize("kinds", [3, 100])
def test_every_process_has_a_finite_window_that_grows_with_the_kit(kinds: int) -> None:
    made = fresh(kit=plain_kit(kinds))
    windows = {name: signature.window for name, signature in made.signatures.items()}
    assert all(window is not None and 0 <= window[0] <= window[1] < 3000 for window in windows.values())


def test_results_and_parameters_are_declared() -> None:
    signatures = fresh().signatures
    assert (signatures["Find"].inputs, signatures["Find"].results) == (("symbol",), ("x",))
    assert (signatures["FindGetInsert"].inputs, signatures["FindGetInsert"].results) == (
        ("symbol", "symbol"),
        (),
    )
    assert signatures["Choose"].results == ("d",)
    assert signatures["Track"].outcomes == frozenset({"abort"})


@pytest.mark.parametrize("text", [TRUSTING, CAREFUL])
def test_programs_build_kits(text: str) -> None:
    made, _ = run(text)
    assert made.world is not None
    report = made.world.report()
    assert report["kits"]["completed"] >= 8  # type: ignore[index]
    assert report["kits"]["rejected"] == 0  # type: ignore[index]
    assert made.world.balanced()


def test_a_process_that_fails_takes_time_so_that_retrying_is_never_zeno() -> None:
    _, trace = run("KITS = (~Insert[part1, tray1]) :; STOP", until=10.0)
    aborted = [event.time for event in trace.of("aborted")]
    assert 40 <= len(aborted) <= 51
    assert aborted == sorted(set(aborted))


def test_motion_is_reported_to_whoever_listens() -> None:
    scheduler = Scheduler(VirtualClock(), seed=1)
    made = host(scheduler)
    heard: list[tuple[str, bool]] = []
    made.listen(lambda assumption, holds, evidence: heard.append((assumption, holds)))
    world = made.world
    assert world is not None
    world.start(scheduler)
    world.attempts.append(lambda: world.strike("part_moved"))  # type: ignore[attr-defined]
    executer = Executer(parse_program("ONE = Find[motor]<x>"), host=made, scheduler=scheduler)
    root = executer.start("ONE")
    executer.run(until=60.0)
    assert root.outcome == "abort"
    assert heard == [("AM", False)]
    assert made.assumptions["AM"]().holds is False  # type: ignore[union-attr]  # a Reading


def test_killing_a_program_leaves_no_command_but_the_arms_own_putting_away() -> None:
    scheduler = Scheduler(VirtualClock(), seed=1)
    made = host(scheduler)
    world = made.world
    assert world is not None
    world.start(scheduler)
    executer = Executer(parse_program(CAREFUL), host=made, scheduler=scheduler)
    for seconds in (3.0, 7.7, 12.1, 23.4, 31.0):
        root = executer.start("KITS")
        executer.run(until=scheduler.now + seconds)
        executer.kill(root)
        executer.run(until=scheduler.now)
        assert world.arm.live in ("", "put away")  # type: ignore[attr-defined]
        assert world.balanced()
    scheduler.run(until=scheduler.now + 20.0)
    assert world.ledger()["held"] == 0
    assert world.balanced()


def test_the_world_is_finished_when_so_many_kits_are_completed() -> None:
    scheduler = Scheduler(VirtualClock(), seed=1)
    made = host(scheduler, target=2)
    world = made.world
    assert world is not None
    world.start(scheduler)
    executer = Executer(parse_program(TRUSTING), host=made, scheduler=scheduler)
    executer.start("KITS")
    executer.run(until=40.0)
    assert not world.finished()
    executer.run(until=70.0)
    assert world.finished()


def test_a_run_depends_on_its_seed_alone_and_not_on_the_hashing_of_strings() -> None:
    script = "from tests.workcell.test_host import run, CAREFUL\nprint(run(CAREFUL, until=150.0)[1].hash)\n"
    hashes = {
        subprocess.run(
            [sys.executable, "-c", script],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    }
    assert len(hashes) == 1
