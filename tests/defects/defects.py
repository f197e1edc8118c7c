"""What a defect is, those that were made by hand, and those that a tool makes."""

from __future__ import annotations

import ast
import hashlib
import tomllib
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from tests.mutants.operators import Mutation, mutations
from tests.mutants.running import ROOT

BY_HAND = Path(__file__).with_name("by_hand.toml")
HARMLESS = Path(__file__).with_name("harmless.toml")

MODULES = (
    "reactor.adaptation", "reactor.assumptions", "reactor.committed", "reactor.doubts", "reactor.enquiries",
    "reactor.guards", "reactor.instances", "reactor.journal", "reactor.life", "reactor.reactor", "reactor.readings",
    "reactor.recovery", "reactor.serving", "reactor.situations", "reactor.versions", "link.channels", "link.session",
)  # fmt: skip
"""Where the tool makes its changes."""

ENQUIRED = ("reactor.enquiries",)
"""What happens in the cell alone: the planner of the workshop keeps a book, and asks nothing."""

OPERATORS = ("drop statement", "drop if")
EVERY = 9
"""One of so many of the tool's changes is tried, by a digest of its name: others may come and go."""


@dataclass(frozen=True, slots=True)
class Defect:
    """One defect: the changed modules by name, which law or row of the fault table it is about, and what it meets.

    `cases`: workshop, cell, twice, crowd or storm; `faults`: kinds that are added at times of the seed. With a
    `counter` it is caught if that stays at 0.
    """

    name: str
    about: str
    sources: Mapping[str, str]
    cases: str = "workshop"
    faults: tuple[str, ...] = ()
    counter: str = ""
    made: str = "by hand"

    @property
    def digest(self) -> str:
        """Of what it is: the changed sources."""
        return hashlib.sha256(repr(sorted(self.sources.items())).encode()).hexdigest()[:12]


class Gone(Exception):
    """The text that a defect changes is not in the source any more, or not once."""


def source_of(module: str) -> str:
    return (ROOT / "src/planner_reactor").joinpath(*module.split(".")).with_suffix(".py").read_text(encoding="utf-8")


def by_hand() -> list[Defect]:
    """Those of the file; `Gone` if one does not fit the sources."""
    found = []
    for row in tomllib.loads(BY_HAND.read_text(encoding="utf-8"))["defect"]:
        sources: dict[str, str] = {}
        for edit in row["edits"]:
            module, before, after = edit["module"], edit["before"], edit["after"]
            text = sources.get(module) or source_of(module)
            if text.count(before) != 1:
                raise Gone(f"{row['name']}: {before!r} stands {text.count(before)} times in {module}")
            sources[module] = text.replace(before, after)
        found.append(
            Defect(row["name"], row["about"], sources, row.get("cases", "workshop"), tuple(row.get("faults", ())),
                   row.get("counter", ""))
        )  # fmt: skip
    return found


@lru_cache
def harmless() -> Mapping[str, str]:
    """Changes of the tool that break no law, with the reason."""
    groups = tomllib.loads(HARMLESS.read_text(encoding="utf-8")).get("group", [])
    return {name: group["because"] for group in groups for name in group["defects"]}


@lru_cache
def by_tool() -> list[Defect]:
    """A statement less here, a condition less there: one in so many of all that the tool can do."""
    found: list[Defect] = []
    for module in MODULES:
        tree = ast.parse(source_of(module))
        for mutation in mutations(tree):
            if mutation.operator in OPERATORS and not _tells_only(mutation):
                name = f"{module}.{mutation.function}: without `{_short(mutation.before)}`"
                if zlib.crc32(name.encode()) % EVERY == 0 and name not in {d.name for d in found}:
                    text = ast.unparse(mutation.applied(tree))
                    cases = "cell" if module in ENQUIRED else "workshop"
                    found.append(Defect(name, _about(module), {module: text}, cases, made="by the tool"))
    return found


def _tells_only(mutation: Mutation) -> bool:
    """Is it a note for people or for a checker of types, or a count of statistics, that nothing depends on?"""
    return any(word in mutation.before for word in ("TYPE_CHECKING", "trace.record", ".counts[", "_check_"))


def _about(module: str) -> str:
    return module.partition(".")[2]


def _short(text: str) -> str:
    first = " ".join(text.split())
    return first if len(first) <= 70 else f"{first[:67]}…"
