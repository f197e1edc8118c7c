"""Every example runs as its head says, and prints what was recorded beside it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.transcripts import EXAMPLES, difference, examples, recorded, transcript

LONGEST = 60
FILES = sorted(file for file in EXAMPLES.iterdir() if file.is_file() and file.suffix != ".out")
RUN = list(examples())


@pytest.mark.parametrize("file", RUN, ids=lambda file: file.name)
def test_an_example_prints_what_was_recorded(file: Path) -> None:
    assert not difference(recorded(file).read_text(encoding="utf-8"), transcript(file))


def test_examples_are_numbered_without_gaps_but_for_two_domains() -> None:
    numbers = {file.name[:3] for file in FILES if not file.name.startswith(("greenhouse", "tending"))}
    assert numbers == {f"{n:02}_" for n in range(1, len(numbers) + 1)}


@pytest.mark.parametrize("file", [f for f in FILES if re.match(r"\d", f.name)], ids=lambda file: file.name)
def test_a_numbered_example_is_short(file: Path) -> None:
    assert statements(file) <= LONGEST


def test_nothing_is_recorded_that_is_not_run() -> None:
    assert set(EXAMPLES.glob("*.out")) == {recorded(file) for file in RUN}


def statements(file: Path) -> int:
    """Lines that are neither blank nor comment; a world that a domain needs does not count to the example."""
    text = re.sub(r'""".*?"""', "", file.read_text(encoding="utf-8"), flags=re.DOTALL)
    text = re.sub(r"\nclass \w+:.*?\n\n\n", "\n", text, flags=re.DOTALL)
    return sum(bool(line.strip()) and not line.lstrip().startswith(("#", "//")) for line in text.splitlines())
