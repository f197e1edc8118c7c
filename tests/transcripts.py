"""What the commands in examples and pages print: run in this process, compared with what was recorded.

A command is `planner-reactor …` or `python FILE`; what it writes to either stream counts, in order, and its exit status
if that is not 0. A recorded `…` stands for anything, as in a doctest. `python -m tests.transcripts` records every
example anew; read the difference before you commit it.
"""

from __future__ import annotations

import doctest
import io
import os
import re
import runpy
import shlex
from collections.abc import Iterator, Mapping
from contextlib import chdir, redirect_stderr, redirect_stdout
from pathlib import Path
from tempfile import TemporaryDirectory
from types import MappingProxyType

from planner_reactor import cli

ROOT = Path(__file__).parent.parent
EXAMPLES = ROOT / "examples"
HEAD = 12
"""Lines of an example among which its commands stand."""

_VARIES = (
    (re.compile(r"^(  (?:wall s|cpu s|trace hash) +)\S+$", re.MULTILINE), r"\1…"),
    (re.compile(r"\(\d+\.\d ms\)$", re.MULTILINE), "(… ms)"),
    (re.compile(r'("(?:wall_s|cpu_s|issued_s|trace_hash)": )[^,}]+'), r"\1…"),
)
"""What differs from run to run, or with any change of the code."""


def commands_of(file: Path) -> tuple[str, ...]:
    """The commands at the head of an example: lines `$ command`; one that ends in a backslash goes on."""
    head = "\n".join(file.read_text(encoding="utf-8").splitlines()[:HEAD])
    head = re.sub(r"\\\n[\s/#]*", "", head)
    return tuple(re.findall(r"^\W*?\$ ((?:planner-reactor|python) .+)$", head, re.MULTILINE))


def transcript(file: Path) -> str:
    """The commands of an example, each with what it prints."""
    return "\n".join(f"$ {command}\n{printed(command)}" for command in commands_of(file))


def printed(command: str, files: Mapping[str, str] = MappingProxyType({})) -> str:
    """What a command prints, run where the examples and these files are seen and what is written is forgotten."""
    with TemporaryDirectory() as folder, chdir(folder):
        for name, text in files.items():
            Path(name).write_text(text, encoding="utf-8")
        for seen in ("examples", "src"):
            os.symlink(ROOT / seen, seen)
        found = io.StringIO()
        with redirect_stdout(found), redirect_stderr(found):
            status = _status(shlex.split(command))
    text = "\n".join(line.rstrip() for line in found.getvalue().splitlines()).strip("\n")
    for pattern, shown in _VARIES:
        text = pattern.sub(shown, text)
    return text + "\n" + (f"(exit status {status})\n" if status else "")


def _status(words: list[str]) -> int:
    match words:
        case "planner-reactor", *arguments:
            return cli.main(arguments)
        case "python", file:
            runpy.run_path(file, run_name="__main__")
            return 0
        case _:
            raise ValueError(f"{shlex.join(words)} is not a command that can be tried here")


def difference(wanted: str, got: str) -> str:
    """What is different, or nothing."""
    checker, rules = doctest.OutputChecker(), doctest.ELLIPSIS | doctest.REPORT_NDIFF
    wanted = wanted.replace("…", "...")
    if checker.check_output(wanted, got, doctest.ELLIPSIS):
        return ""
    return checker.output_difference(doctest.Example("", wanted), got, rules)


def examples() -> Iterator[Path]:
    """The files that say how to run them."""
    files = sorted(file for file in EXAMPLES.iterdir() if file.is_file() and file.suffix != ".out")
    return (file for file in files if commands_of(file))


def recorded(file: Path) -> Path:
    """Where the output of an example is recorded."""
    return file.with_suffix(".out")


if __name__ == "__main__":
    for example in examples():
        recorded(example).write_text(transcript(example), encoding="utf-8")
        print(recorded(example).name)
