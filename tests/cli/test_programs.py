"""`run` and `check`: what they print, and what they refuse."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from planner_reactor.runtime import Scheduler
from tests.cli.conftest import Call


def test_run_tells_outcome_results_and_counts(call: Call) -> None:
    assert call("run", "cell.rsl", "Pair", "--json").object == {
        "outcome": "stop", "cause": "", "results": {"x": 7}, "time_s": 0.0, "events": 1, "rendezvous": 1,
        "processes_live": 0, "zeno": None, "waiting": {},
    }  # fmt: skip
    counted = call("run", "cell.rsl", "Count[3]", "--json").object
    assert (counted["outcome"], counted["time_s"]) == ("stop", 1.5)


def test_run_names_results_as_the_call_does(call: Call) -> None:
    assert call("run", "cell.rsl", "Pair<seven>", "--json").object["results"] == {"seven": 7}


def test_run_takes_values_that_are_computed(call: Call) -> None:
    assert call("run", "cell.rsl", "Count[1 + 1]", "--json").object["time_s"] == 1.0
    assert call("run", "cell.rsl", "Delay[double(1.5)]", "--host", "small_host", "--json").object["time_s"] == 3.0


def test_an_abort_is_an_outcome_and_not_an_error(call: Call) -> None:
    ran = call("run", "cell.rsl", "Fails", "--json")
    assert (ran.status, ran.object["outcome"]) == (0, "abort")


def test_run_ends_at_until_or_when_all_wait(call: Call) -> None:
    early = call("run", "cell.rsl", "Count[100]", "--until", "2", "--json").object
    assert (early["outcome"], early["time_s"]) == ("running", 2.0)
    stuck = call("run", "cell.rsl", "Waits", "--json").object
    assert (stuck["outcome"], stuck["waiting"]) == ("running", {"r": "IN", "s": "IN"})
    assert stuck["processes_live"] > 0


def test_run_offers_the_situation_processes_and_tells_reports(call: Call) -> None:
    ran = call("run", "cell.rsl", "Works", "--until", "5", "--json")
    assert ran.object["outcome"] == "running"
    assert "report: done 4" in ran.err


def test_run_on_the_wall_clock_takes_its_time_and_ends_by_itself(call: Call) -> None:
    ran = call("run", "cell.rsl", "Count[1]", "--clock", "wall", "--json").object
    assert (ran["outcome"], ran["time_s"] >= 0.5) == ("stop", True)
    assert call("run", "cell.rsl", "Fails", "--clock", "wall", "--json").object["outcome"] == "abort"
    assert call("run", "cell.rsl", "Waits", "--clock", "wall", "--json").object["outcome"] == "running"


def test_a_host_brings_processes_and_its_printing_stays_off_the_result(call: Call) -> None:
    for host in ("small_host", "small_host.py"):
        ran = call("run", "cell.rsl", "Find[cap]", "--host", host, "--json")
        assert ran.object["results"] == {"x": "cap7"}
        assert "a process that talks" in ran.err


def test_an_error_in_the_code_of_a_host_is_told(call: Call) -> None:
    ran = call("run", "cell.rsl", "Break", "--host", "small_host", "--json")
    assert ran.object["outcome"] == "abort"
    assert "ValueError: broken inside" in ran.err


def test_run_for_people(call: Call) -> None:
    ran = call("run", "cell.rsl", "Pair")
    assert ran.out.splitlines() == [
        "Pair: stop at 0.000 s", "  x = 7", "1 event, 1 rendezvous, 0 processes live",
    ]  # fmt: skip
    assert "IN waits at port r" in call("run", "cell.rsl", "Waits").out


@pytest.mark.parametrize(
    ("process", "said"),
    [
        ("Cuont[3]", "<process>:1:1: unknown process Cuont, did you mean Count?"),
        ("Count", "<process>:1:1: Count takes 1 argument, 0 given, expected Count[n]"),
        ("Count[1, 2]", "Count takes 1 argument, 2 given"),
        ("Count[cap]", "<process>:1:7: cap is a symbol where a number is expected"),
        ("Count[1 / 0]", "1 / 0 has no value: 1 is divided by zero"),
        ("Count[f(2)]", "<process>:1:7: unknown function f"),
        ("Count[3", "<process>:1:8: expected `]`"),
        ("Count[OUT[p, 1]]", "<process>:1:"),
        ("Count[1]:Tick", "this is a composition, expected NAME[arguments]"),
        ("", "<process>:1:1: "),
        ("Deaf", "cell.rsl:4:11: port q is read but never written"),
        ("IN[nobody]", "port nobody is read but never written"),
        ("(" * 100_000, "levels of nesting"),
    ],
)
def test_run_refuses_a_process_that_cannot_be(call: Call, process: str, said: str) -> None:
    ran = call("run", "cell.rsl", process)
    assert ran.refused(said)
    assert not 0 < len(process) < 100 or "^" in ran.err


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--until", "-1"), "until is -1.0, expected a finite number of seconds, 0 or more"),
        (("--until", "nan"), "until is nan, expected a finite number"),
        (("--until", "inf"), "until is inf, expected a finite number"),
        (("--seed", "-1"), "seed is -1, expected a whole number, 0 or more"),
        (("--clock", "wal"), "unknown clock wal, did you mean wall?"),
        (("--host", "smal_host"), "host smal_host: no such module, did you mean small_host?"),
        (("--host", "small_host.rs"), "host small_host.rs: no such module"),
        (("--host", "no_file.py"), "host no_file.py: no such file"),
        (("--host", "../x"), "is not the name of a module"),
        (("--host", "json"), "host json has no attribute `host`"),
        (("--host", "planner_reactor.workcel.host"), "no module planner_reactor.workcel, did you mean workcell?"),
    ],
)
def test_run_refuses_options_that_cannot_be(call: Call, options: tuple[str, ...], said: str) -> None:
    assert call("run", "cell.rsl", "Pair", *options).refused(said)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("def f(:\n", "bad_host.py:1:7: invalid syntax"),
        ("import no_such_thing\n", "ModuleNotFoundError: No module named 'no_such_thing' ("),
        ("\n1 / 0\n", "ZeroDivisionError: division by zero ("),
        ("raise SystemExit(3)\n", "SystemExit: 3 ("),
        ("host = 3\n", "`host` is a int, expected a Host or a function of a scheduler"),
        ("def host(scheduler): return 3\n", "host bad_host made a int, expected a Host"),
        ("def host(scheduler): raise KeyError('x')\n", "host bad_host cannot be made: KeyError: 'x' ("),
        ("hots = 3\n", "has no attribute `host`, did you mean hots?"),
    ],
)
def test_a_host_that_cannot_be_used_is_told_with_its_place(
    call: Call, place: Path, monkeypatch: pytest.MonkeyPatch, text: str, said: str
) -> None:
    (place / "bad_host.py").write_text(text)
    monkeypatch.syspath_prepend(place)
    monkeypatch.delitem(__import__("sys").modules, "bad_host", raising=False)
    assert call("run", "cell.rsl", "Pair", "--host", "bad_host").refused(said)


def test_a_file_that_cannot_be_read_is_told_with_the_nearest_name(call: Call, place: Path) -> None:
    (place / "latin.rsl").write_bytes("A = STOP\nB = STOP // größer\n".encode("latin-1"))
    (place / "folder.rsl").mkdir()
    assert call("run", "cel.rsl", "Pair").refused("cel.rsl:1:1: no such file, did you mean cell.rsl?")
    assert call("run", "nowhere/cell.rsl", "Pair").refused("no such file, there is no directory nowhere")
    assert call("run", "folder.rsl", "Pair").refused("folder.rsl:1:1: this is a directory, expected a file")
    assert call("run", "latin.rsl", "A").refused("latin.rsl:2:15: byte 0xf6 does not belong to a text, expected UTF-8")
    assert call("run", "/dev/zero", "A").refused("/dev/zero:1:1: ")


@pytest.mark.skipif(os.geteuid() == 0, reason="the superuser may read everything")
def test_a_file_that_may_not_be_read(call: Call, place: Path) -> None:
    (place / "cell.rsl").chmod(0)
    assert call("run", "cell.rsl", "Pair").refused("cell.rsl:1:1: cannot be read: Permission denied")


def test_line_ends_and_marks_of_other_systems_do_no_harm(call: Call, place: Path) -> None:
    (place / "dos.rsl").write_bytes(b"\xef\xbb\xbfMain = Tick : Tick\r\nTick = Delay[0.5]\r\n")
    assert call("run", "dos.rsl", "Main", "--json").object["time_s"] == 1.0


def test_nothing_of_a_program_with_an_error_is_loaded(call: Call, place: Path) -> None:
    (place / "half.rsl").write_text("Good = STOP\nBad = Godo[1]\n")
    ran = call("run", "half.rsl", "Good")
    assert ran.refused("half.rsl:2:7: unknown process Godo, did you mean Good?\n    Bad = Godo[1]\n          ^")


def test_check_finds_nothing_in_a_clean_program(call: Call) -> None:
    ran = call("check", "clean.rsl", "--strict", "--json")
    assert (ran.status, ran.object, ran.err) == (0, {"ok": True, "diagnostics": []}, "")
    assert call("check", "clean.rsl").out == "1 file: nothing found\n"


def test_check_lists_errors_with_place_code_and_hint(call: Call, place: Path) -> None:
    (place / "half.rsl").write_text("Main = Tikc\nTick = Delay[1]\n")
    ran = call("check", "half.rsl", "clean.rsl", "--json")
    assert (ran.status, ran.object["ok"]) == (2, False)
    assert ran.object["diagnostics"][0] == {
        "file": "half.rsl", "line": 1, "column": 8, "severity": "error", "code": "unknown-process",
        "message": "unknown process Tikc", "hint": "did you mean Tick?",
    }  # fmt: skip
    assert "half.rsl:1:8: unknown process Tikc, did you mean Tick?\n    Main = Tikc\n           ^\n" in ran.err


def test_check_minds_warnings_only_if_strict(call: Call, place: Path) -> None:
    (place / "odd.rsl").write_text("Main = STOP\nNever[x] = STOP\n")
    lax = call("check", "odd.rsl")
    assert (lax.status, lax.out) == (0, "1 file: 0 errors, 2 warnings\n")
    assert "odd.rsl:2:1: warning: nothing calls Never[x]" in lax.err
    strict = call("check", "odd.rsl", "--strict", "--json")
    assert (strict.status, strict.object["ok"]) == (1, True)


def test_check_takes_a_host_for_what_is_known(call: Call, place: Path) -> None:
    (place / "hosted.rsl").write_text("Main = Find[cap]<x> : REPORT[found, x]\n")
    assert call("check", "hosted.rsl").status == 2
    assert call("check", "hosted.rsl", "--host", "small_host").status == 0


def test_check_reports_a_file_that_cannot_be_read_among_the_others(call: Call) -> None:
    ran = call("check", "cleam.rsl", "clean.rsl", "--json")
    assert ran.status == 2
    assert [(d["code"], d["hint"]) for d in ran.object["diagnostics"]] == [("unreadable", "did you mean clean.rsl?")]
    assert "cleam.rsl:1:1: no such file" in ran.err


def test_check_refuses_what_is_neither_a_program_nor_a_domain(call: Call) -> None:
    assert call("check", "times.txt").refused("times.txt: expected a program (*.rsl) or a domain (*.itl)")


def test_a_bomb_of_parentheses_is_refused_at_once(call: Call, place: Path) -> None:
    (place / "bomb.rsl").write_text("A = " + "(" * 200_000)
    ran = call("check", "bomb.rsl", "--json")
    assert (ran.status, ran.object["ok"]) == (2, False)


def test_run_can_be_held_against_the_semantics(call: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    ran = call("run", "cell.rsl", "Count[2]", "--conform", "--json")
    assert (ran.status, ran.object["conformance"]["disagreement"]) == (0, None)
    assert "steps held against the semantics, all allowed" in call("run", "cell.rsl", "Count[2]", "--conform").out
    monkeypatch.setattr(Scheduler, "wait", lambda self, when, entry, was=Scheduler.wait: was(self, when + 0.1, entry))
    ran = call("run", "cell.rsl", "Count[2]", "--conform")
    assert ran.status == 1
    assert "not allowed by the semantics" in ran.out
