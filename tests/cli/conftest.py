"""The command, run in this process; a directory of its own for each test, with a program, a host and a network."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from planner_reactor.cli import main

PROGRAM = """\
Count[n] = if LST[0, n] then (Tick : Count[n - 1]) else STOP
Tick = Delay[0.5]
Pair<x> = OUT[p, 7] | IN[p]<x>
Deaf = IN[q]<x> : REPORT[heard, x]
Works = Serve | (ASSERT[fill, 3]<y> : REPORT[done, y])
Serve = SIT[fill]<k, a> :; (UPDATE[fill, k, a + 1] : SUCCEED[fill, k])
Waits<y> = IN[r]<y> | Writes
Writes = IN[s]<x> : OUT[r, x] : OUT[s, x]
Stuck = DRAIN[nothing]
Fails = ABORT
"""

CLEAN = "Main = Tick : Tick\nTick = Delay[0.5]\n"

HOST = '''\
"""A host of a test."""
from planner_reactor.runtime import Host

print("a host that talks")
host = Host("small")

@host.process(results=("x",), window=(0.0, 1.0))
def Find(kind: str):
    print("a process that talks")
    yield 0.25
    return kind + "7"

@host.process(window=(0.0, 1.0))
def Break():
    raise ValueError("broken inside")

@host.function
def double(x: float):
    return 2 * x
'''


@dataclass(frozen=True, slots=True)
class Ran:
    """What one run of the command left: exit status, standard output, standard error."""

    status: int
    out: str
    err: str

    @property
    def object(self) -> dict[str, Any]:
        """The one JSON object on standard output."""
        found = json.loads(self.out)
        assert isinstance(found, dict)
        assert self.out.count("\n") == 1
        return found

    def refused(self, *said: str) -> bool:
        """Bad input: exit 2, all of this said on standard error, no traceback, nothing on standard output."""
        assert self.status == 2, self
        assert "Traceback" not in self.err
        assert self.out == ""
        for words in said:
            assert words in self.err, self.err
        return True


Call = Callable[..., Ran]


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A current directory with `cell.rsl`, `clean.rsl`, `small_host.py` and `times.txt`."""
    (tmp_path / "cell.rsl").write_text(PROGRAM)
    (tmp_path / "clean.rsl").write_text(CLEAN)
    (tmp_path / "small_host.py").write_text(HOST)
    (tmp_path / "times.txt").write_text("i1 (b m o) i2\ni2 (b m) i3\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def call(place: Path, capsys: pytest.CaptureFixture[str]) -> Call:
    """Runs the command with these arguments, words or whole lines."""

    def run(*arguments: str) -> Ran:
        capsys.readouterr()
        status = main(arguments)
        printed = capsys.readouterr()
        return Ran(status, printed.out, printed.err)

    return run
