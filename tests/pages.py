"""The pages of the documentation, read as data: fenced blocks, links, tables, and the parts that are made from code.

A made part stands between `<!-- made: NAME -->` and `<!-- end -->`. `python -m tests.pages` makes them all anew.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

from planner_reactor.analysis.observing import WORDS
from planner_reactor.cli.application import NAME
from planner_reactor.cli.later import LATER
from planner_reactor.logic import itl_syntax
from planner_reactor.rs import grammar, states
from tests.defects.telling import defects_table, harmless_table
from tests.laws.telling import laws, non_laws
from tests.mutants.telling import mutants_table
from tests.simulation.telling import counters_table, figures
from tests.transcripts import examples

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
PACKAGE = ROOT / "src" / "planner_reactor"
PAGES = tuple(sorted(DOCS.rglob("*.md")))
OWN = tuple(page for page in PAGES if page.parent == DOCS)
"""The pages that are not decisions."""

_BLOCK = re.compile(r"^```(\w*)([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
_MADE = re.compile(r"(<!-- made: (\w+) -->\n)(.*?)(<!-- end -->)", re.DOTALL)
_HEADING = re.compile(r"^#+ +(.*)$", re.MULTILINE)
_CODE = re.compile(r"```.*?```|`[^`\n]*`", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Block:
    """A fenced block of a page: its language, what else stands on the fence, its text, its line."""

    page: Path
    language: str
    note: str
    text: str
    line: int

    def __str__(self) -> str:
        return f"{self.page.name}:{self.line}"


def blocks(page: Path, *languages: str) -> Iterator[Block]:
    """The fenced blocks of a page in these languages, in order."""
    text = page.read_text(encoding="utf-8")
    for found in _BLOCK.finditer(text):
        if found[1] in languages:
            yield Block(page, found[1], found[2].strip(), found[3], text.count("\n", 0, found.start()) + 1)


def links(page: Path) -> Iterator[str]:
    """Where the links of a page lead."""
    return (found[1] for found in _LINK.finditer(_CODE.sub("", page.read_text(encoding="utf-8"))))


def anchors(page: Path) -> frozenset[str]:
    """The anchors of the headings of a page."""
    text = _BLOCK.sub("", page.read_text(encoding="utf-8"))
    plain = (re.sub(r"[^\w -]", "", heading.lower()) for heading in _HEADING.findall(text))
    return frozenset(heading.strip().replace(" ", "-") for heading in plain)


def rows(page: Path, heading: str) -> list[list[str]]:
    """The cells of the first table below a heading of a page, without its head."""
    text = page.read_text(encoding="utf-8").split(f"\n{heading}\n", 1)[1]
    table = re.search(r"^\|.*(?:\n\|.*)*", text, re.MULTILINE)
    assert table is not None
    lines = table[0].splitlines()[2:]
    return [[cell.strip().replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in lines]


# ------------------------------------------------------------------------------------------ parts made from code


def _indented_in(module: ModuleType) -> str:
    """A grammar or a legend: what stands indented in the docstring of the module."""
    assert module.__doc__ is not None
    lines = [line[4:] for line in module.__doc__.splitlines() if line.startswith("    ")]
    return "```text\n" + "\n".join(lines) + "\n```\n"


ROOMS = ("rs", "analysis", "runtime", "reactor", "logic", "planner", "link", "workcell", "experiments", "calls", "cli")


def _imports() -> str:
    """Which room imports which, without the arrows that follow from others."""
    found = {room: _imported_by(room) for room in ROOMS}
    lines = ["```mermaid", "flowchart TB"]
    for room in ROOMS:
        for other in sorted(found[room]):
            if not any(other in _below(found, third) for third in found[room] - {other}):
                lines.append(f"    {room} --> {other}")
    return "\n".join([*lines, "```", ""])


def _imported_by(room: str) -> set[str]:
    found = set()
    for file in (PACKAGE / room).rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("planner_reactor."):
                found.add(str(node.module).split(".")[1])
    return found & set(ROOMS) - {room}


def _below(found: Mapping[str, set[str]], room: str) -> set[str]:
    """Everything that a room imports, directly or not."""
    seen: set[str] = set()
    waiting = [room]
    while waiting:
        for other in found[waiting.pop()] - seen:
            seen.add(other)
            waiting.append(other)
    return seen


def _later() -> str:
    """The sub-commands that belong to later versions."""
    lines = [f"| `{NAME} {name}` | {about} |" for name, (about, _) in LATER.items()]
    return "\n".join(["| command | what it will do |", "|---|---|", *lines, ""])


def _examples() -> str:
    """Every example that can be run, with the first sentence of its head."""
    lines = ["| example | shows |", "|---|---|"]
    for file in examples():
        first = file.read_text(encoding="utf-8").splitlines()[0].strip('/# "')
        lines.append(f"| [`{file.name}`](../examples/{file.name}) | {first} |")
    return "\n".join([*lines, ""])


def _property_words() -> str:
    """The words of properties, with what they speak of."""
    lines = ["| word | of | true when |", "|---|---|---|"]
    for word, (subject, says) in WORDS.items():
        lines.append(f"| `{word}` | {'–' if subject == 'nothing' else subject} | {says} |")
    return "\n".join([*lines, ""])


MADE: Mapping[str, Callable[[], str]] = {
    "chaos": figures,
    "counters": counters_table,
    "defects": defects_table,
    "examples": _examples,
    "grammar": lambda: _indented_in(grammar),
    "harmless": harmless_table,
    "imports": _imports,
    "itl_grammar": lambda: _indented_in(itl_syntax),
    "later": _later,
    "property_words": _property_words,
    "laws": laws,
    "mutants": mutants_table,
    "non_laws": non_laws,
    "runtime_terms": lambda: _indented_in(states),
}


def made_anew(page: Path) -> str:
    """The text of a page with its made parts as the code would have them now."""
    return _MADE.sub(lambda found: f"{found[1]}{MADE[found[2]]()}{found[4]}", page.read_text(encoding="utf-8"))


if __name__ == "__main__":
    for each in PAGES:
        each.write_text(made_anew(each), encoding="utf-8")
