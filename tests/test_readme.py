"""The front door tells the truth: its program is run, its links lead somewhere, its commands exist."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text()


def block(language: str, beginning: str) -> str:
    """The fenced block of this language that begins so."""
    blocks: list[tuple[str, str]] = re.findall(r"```(\w*)\n(.*?)```", README, re.DOTALL)
    return next(text for kind, text in blocks if kind == language and text.startswith(beginning))


def test_the_shortest_useful_program_does_what_is_printed(tmp_path: Path) -> None:
    (tmp_path / "knock.rsl").write_text(block("", "Patient"))
    (tmp_path / "house.py").write_text(block("python", "from planner_reactor"))
    shown = block("", "$ .venv/bin/planner-reactor run").splitlines()
    command = [sys.executable, "-m", "planner_reactor", *shown[0].split()[2:]]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert {*done.stdout.splitlines(), *done.stderr.splitlines()} >= {*shown[1:]}


def test_every_link_leads_to_a_file() -> None:
    links = re.findall(r"\]\(([^)#]+)\)", README)
    assert len(links) > 10
    assert not [link for link in links if not (ROOT / link).exists()]


def test_the_two_commands_are_targets() -> None:
    makefile = (ROOT / "Makefile").read_text()
    assert all(f"\n{target}:" in makefile for target in re.findall(r"^make (\w+)", README, re.MULTILINE))
