"""All mutants of the semantics, with their names, and what a campaign says of each rule."""

from __future__ import annotations

import ast
import hashlib
import json
import tomllib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache

from tests.mutants.operators import Mutation, mutations
from tests.mutants.rules import MODULES, Rules
from tests.mutants.running import ROOT

OUT = ROOT / "out/mutants.jsonl"
TABLE = ROOT / "tests/mutants/table.json"
KILLERS = ROOT / "tests/mutants/killers.json"
"""Which test found a mutant in the last campaign: it is tried first."""

EQUIVALENT = ROOT / "tests/mutants/equivalent.toml"

RULE_TESTS = (
    "tests.rs.test_evolves",
    *(f"tests.rs.{file.stem}" for file in sorted((ROOT / "tests/rs").glob("test_rules_of_*.py"), reverse=True)),
    "tests.rs.test_states",
    "tests.rs.test_configurations",
    "tests.rs.test_resting",
)
"""The tests of the rules themselves: a second in all."""

TESTS = (
    *RULE_TESTS,
    "tests.analysis.test_explore",
    "tests.mutants.samples",
    "tests.analysis.test_evolution",
)
"""The modules of tests that a mutant meets, the quick ones first."""


@dataclass(frozen=True, slots=True)
class Mutant:
    """A mutation of a module of the semantics, by a name that does not depend on where it stands in the file."""

    module: str
    rule: str
    key: str
    mutation: Mutation
    source: str

    @property
    def name(self) -> str:
        return f"planner_reactor.rs.{self.module}"

    def tree(self) -> ast.Module:
        """The module with the mutation."""
        return self.mutation.applied(_parsed(self.module)[1])


@lru_cache
def _parsed(module: str) -> tuple[str, ast.Module]:
    source = (ROOT / f"src/planner_reactor/rs/{module}.py").read_text(encoding="utf-8")
    return source, ast.parse(source)


def mutants() -> Iterator[Mutant]:
    """Every mutant of every module, in the order of the code."""
    for module in MODULES:
        source, tree = _parsed(module)
        rules, digests = Rules(module, source), [_digest(node) for node in tree.body]
        counted: Counter[str] = Counter()
        for mutation in mutations(tree):
            text = f"{module}.{mutation.function}: {mutation.operator}: {_told(mutation)}"
            counted[text] += 1
            key = text if counted[text] == 1 else f"{text} #{counted[text]}"
            rule = rules.of(mutation.function, mutation.line, mutation.operator)
            yield Mutant(module, rule, key, mutation, digests[mutation.path[0][1] or 0])


def _digest(node: ast.stmt) -> str:
    """What a function or class says: while it says the same, what became of its mutants is believed."""
    return hashlib.sha256(ast.unparse(node).encode()).hexdigest()[:12]


def _told(mutation: Mutation) -> str:
    before, after = (" ".join(text.split()) for text in (mutation.before, mutation.after))
    start = 0
    while start < min(len(before), len(after)) and before[start] == after[start]:
        start += 1
    end = 0
    while end < min(len(before), len(after)) - start and before[-1 - end] == after[-1 - end]:
        end += 1
    low, high = max(0, start - 30), max(0, end - 20)
    return f"{_short(before[low : len(before) - high])} -> {_short(after[low : len(after) - high])}"


def _short(text: str) -> str:
    return text if len(text) <= 120 else f"{text[:60]} … {text[-57:]}"


# ------------------------------------------------------------------------------------------------ what became of them

Result = Mapping[str, str]


def equivalents() -> dict[str, str]:
    """Mutants that no test can tell from the original, with the reason."""
    if not EQUIVALENT.exists():
        return {}
    groups = tomllib.loads(EQUIVALENT.read_text(encoding="utf-8")).get("group", [])
    return {key: group["because"] for group in groups for key in group["mutants"]}


def unexplained(results: Iterable[Result]) -> list[Result]:
    """The survivors that are not known to be equivalent."""
    known = equivalents()
    return [r for r in results if r["fate"] == "survived" and r["key"] not in known]


def by_rule(results: Iterable[Result]) -> dict[str, dict[str, int]]:
    """For each rule: how many mutants were killed, are equivalent, survive."""
    known = equivalents()
    table: dict[str, dict[str, int]] = {}
    for result in results:
        row = table.setdefault(result["rule"], {"killed": 0, "equivalent": 0, "survived": 0, "stillborn": 0})
        fate = result["fate"]
        row["equivalent" if fate == "survived" and result["key"] in known else fate] += 1
    return table


def score(table: Mapping[str, Mapping[str, int]]) -> float:
    """Killed, of those that are not equivalent."""
    killed = sum(row["killed"] for row in table.values())
    return killed / max(1, killed + sum(row["survived"] for row in table.values()))


def summary(results: Iterable[Result]) -> str:
    """One line."""
    table = by_rule(results)
    total = Counter[str]()
    for row in table.values():
        total.update(row)
    return f"{dict(total)}, score {100 * score(table):.1f} %"


def write_table(results: Iterable[Result]) -> None:
    """Ship what the campaign says of each rule, and which test found each rule that was taken away."""
    found = list(results)
    TABLE.write_text(json.dumps(dict(sorted(by_rule(found).items())), indent=1) + "\n", encoding="utf-8")
    by = {result["key"]: result["by"] for result in found}
    killers = {mutant.key: by.get(mutant.key, "") for mutant in removals().values()}
    KILLERS.write_text(json.dumps(killers, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


REMOVALS = ("drop case", "drop entry", "drop item", "old store", "drop statement", "drop if", "drop condition",
            "negate condition", "negate result", "take branch", "swap comparison", "drop operand")  # fmt: skip
"""Ways to take a rule away, the most thorough first."""

HARMLESS = {"SEQ", "terms", "begin", "scopes"}
"""Not rules: what terms are."""


@lru_cache
def removals() -> Mapping[str, Mutant]:
    """For each rule the mutant that takes most of it away."""
    known = equivalents()
    found: dict[str, tuple[int, Mutant]] = {}
    for mutant in mutants():
        way = next((n for n, w in enumerate(REMOVALS) if mutant.mutation.operator.startswith(w)), None)
        if way is not None and mutant.key not in known and mutant.rule not in HARMLESS:
            found.setdefault(mutant.rule, (way, mutant))
            if way < found[mutant.rule][0]:
                found[mutant.rule] = (way, mutant)
    return {rule: mutant for rule, (_, mutant) in sorted(found.items())}
