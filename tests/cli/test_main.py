"""The command as a whole: help, usage errors, what is not there yet, JSON, endings."""

from __future__ import annotations

import json
import os
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import planner_reactor
from planner_reactor import cli
from planner_reactor.cli.application import ORDER
from planner_reactor.cli.later import LATER
from tests.cli.conftest import Call

COMMAND = [sys.executable, "-m", "planner_reactor"]


@pytest.mark.parametrize("name", ORDER)
def test_every_subcommand_has_help_with_an_example(call: Call, name: str) -> None:
    ran = call(name, "--help")
    assert ran.status == 0
    assert f"planner-reactor {name}" in ran.out.partition("Example")[2]


def test_without_arguments_it_tells_what_there_is(call: Call) -> None:
    ran = call()
    assert ran.status == 0
    listed = [line.split()[0] for line in ran.out.partition("Commands:")[2].splitlines() if line.startswith("  ")]
    assert listed[: len(ORDER)] == list(ORDER)


def test_it_tells_its_version(call: Call) -> None:
    assert call("--version").out.startswith("planner-reactor 0.")


@pytest.mark.parametrize("name", LATER)
def test_what_belongs_to_later_versions_says_so(call: Call, name: str) -> None:
    assert call(name, "some.rsl", "Main", "--option").refused(f"{name} is not in this version")


@pytest.mark.parametrize(
    "arguments",
    [
        ("kit", "--cell", "physics"),
        ("kit", "--cell", "camera"),
        ("kit", "--planner", "process"),
        ("kit", "--trace", "out.mcap"),
        ("experiment", "x", "--out", "out", "--scheduler", "here:1"),
    ],
    ids=" ".join,
)
def test_values_that_belong_to_later_versions_say_so_and_what_there_is(call: Call, arguments: tuple[str, ...]) -> None:
    assert call(*arguments).refused("not in this version", "there is: ")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("rum",), "no such sub-command rum, did you mean run?"),
        (("kit", "--tray", "3"), "no such option --tray, did you mean --trays?"),
        (("kit", "--trays", "few"), "invalid value for '--trays'"),
        (("kit", "--seed", "1.5"), "invalid value for '--seed'"),
        (("kit", "--trays"), "--trays"),
        (("run", "cell.rsl"), "missing argument"),
        (("loop", "x.itl"), "missing option '--host'"),
        (("check",), "missing argument"),
        (("network", "times.txt", "more.txt"), "more.txt"),
    ],
)
def test_a_wrong_command_line_is_one_line_with_the_nearest_name(
    call: Call, arguments: tuple[str, ...], said: str
) -> None:
    ran = call(*arguments)
    assert ran.refused(said, "--help tells more")
    assert ran.err.count("\n") == 1


def test_who_asks_for_json_gets_one_object_also_for_bad_input(call: Call) -> None:
    for arguments in (("kit", "--tray", "3", "--json"), ("run", "no.rsl", "Main", "--json")):
        ran = call(*arguments)
        assert ran.status == 2
        assert ran.object["error"] in ran.err


def test_a_failure_of_its_own_is_told_without_a_traceback(call: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object, **__: object) -> None:
        raise RuntimeError("the roof\nfell in")

    monkeypatch.setattr("planner_reactor.calls.networks.read_statements", broken)
    assert call("network", "times.txt").refused("itself failed: RuntimeError: the roof (", "test_main.py")


def test_an_interruption_is_quiet(call: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("planner_reactor.calls.networks.read_statements", interrupted)
    ran = call("network", "times.txt")
    assert (ran.status, ran.out, ran.err) == (130, "", "")


def test_python_calls_have_the_names_of_the_subcommands_and_are_documented() -> None:
    assert sorted([*planner_reactor.__all__, *LATER]) == sorted(ORDER)
    for name in planner_reactor.__all__:
        assert getattr(planner_reactor, name).__name__ == name
        assert getattr(planner_reactor, name).__doc__
    with pytest.raises(AttributeError, match="has no attribute 'rum'"):
        _ = planner_reactor.rum


def test_the_entry_point_is_main() -> None:
    assert callable(cli.main)


def test_the_core_imports_neither_the_command_nor_what_draws() -> None:
    rooms = (
        "planner_reactor.rs.loading, planner_reactor.runtime, planner_reactor.reactor.reactor, planner_reactor.planner"
    )
    script = (
        f"import sys, planner_reactor\nimport {rooms}\n"
        "print([m for m in ('typer', 'click', 'rich', 'matplotlib', 'numpy', 'pydantic', 'planner_reactor.calls', "
        "'planner_reactor.cli') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_the_bare_package_imports_none_of_its_rooms() -> None:
    script = "import sys, planner_reactor; print([m for m in sys.modules if m.startswith('planner_reactor.')])"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_a_reader_that_goes_away_ends_it_quietly(place: Path) -> None:
    (place / "long.rsl").write_text("".join(f"Never{n}[x] = STOP\n" for n in range(3000)))
    with subprocess.Popen(
        [*COMMAND, "check", "long.rsl", "--json"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    ) as process:
        assert process.stdout is not None
        process.stdout.read(10)
        process.stdout.close()
        assert process.wait(15) == 128 + signal.SIGPIPE
    with subprocess.Popen(
        [*COMMAND, "network", "times.txt"], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert process.wait(15) in (0, 128 + signal.SIGPIPE)
        assert process.stderr.read() == b""


def test_standard_output_that_is_full_or_closed_is_no_reason_for_a_traceback(place: Path) -> None:
    for redirection, status, said in ((">/dev/full", 2, "No space left on device\n"), (">&-", 0, "")):
        line = f"{shlex.join(COMMAND)} network times.txt {redirection}"
        done = subprocess.run(["sh", "-c", line], capture_output=True, text=True, check=False)
        assert done.returncode == status
        assert done.stderr.endswith(said)
        assert done.stderr.count("\n") == status // 2


def test_ctrl_c_ends_a_long_run_with_130_and_without_a_word(place: Path) -> None:
    (place / "endless.rsl").write_text("Main = Delay[1] : Main\n")
    with subprocess.Popen(
        [*COMMAND, "run", "endless.rsl", "Main"], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        time.sleep(2.0)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=15)
    assert (process.returncode, out, err) == (130, b"", b"")


def test_a_process_of_its_own_prints_json_on_standard_output_alone(place: Path) -> None:
    environment = {**os.environ, "COLUMNS": "20"}
    done = subprocess.run(
        [*COMMAND, "run", "cell.rsl", "Find[cap]", "--host", "small_host", "--json"],
        capture_output=True, text=True, check=False, env=environment,
    )  # fmt: skip
    assert done.returncode == 0
    assert json.loads(done.stdout)["results"] == {"x": "cap7"}
    assert "a process that talks" in done.stderr
