"""The order in which things happen: what is silent, then verdicts, then steps, then time."""

from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.runtime import Executer, Label, Root, Scheduler, VirtualClock


def run(process: str, program: str = "", until: float | None = 100.0) -> tuple[Root, list[Label], Executer]:
    seen: list[Label] = []
    executer = Executer(parse_program(program), scheduler=Scheduler(VirtualClock()), observer=seen.append)
    root = executer.start_process(parse_process(process))
    executer.run(until)
    return root, seen, executer


def test_a_stop_decides_before_an_abort_of_the_same_step() -> None:
    assert run("ABORT # STOP")[0].outcome == "stop"
    assert run("STOP # ABORT")[0].outcome == "stop"


def test_what_has_lost_never_takes_a_step() -> None:
    root, seen, _ = run("(OUT[p,1] # STOP) | (IN[p]<x> # Delay[1])")
    assert root.outcome == "stop"
    assert root.results == {}
    assert seen == [("Delay", (1,), "ok", ())]


def test_time_passes_only_when_nothing_is_left_to_do() -> None:
    _, seen, executer = run("Delay[2] | (Delay[1] ; OUT[p,3]) | IN[p]<x>")
    assert seen == [("Delay", (1,), "ok", ()), ("COM", ("p", 3), "ok", ()), ("Delay", (2,), "ok", ())]
    assert executer.scheduler.now == 2.0
