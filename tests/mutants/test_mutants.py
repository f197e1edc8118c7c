"""Each rule taken away makes a test fail; the campaign over all mutants is `make mutants`."""

from __future__ import annotations

import ast
import json

import pytest

from tests.mutants.campaign import KILLERS, RULE_TESTS, TABLE, equivalents, mutants, removals, score
from tests.mutants.operators import mutations
from tests.mutants.running import ROOT, Code, judged

KILLERS_KNOWN: dict[str, str] = json.loads(KILLERS.read_text(encoding="utf-8")) if KILLERS.exists() else {}


@pytest.fixture(scope="module")
def code() -> Code:
    known = Code()
    known.warm(RULE_TESTS)
    return known


@pytest.mark.parametrize("rule", removals())
def test_a_rule_taken_away_makes_a_test_fail(code: Code, rule: str) -> None:
    mutant = removals()[rule]
    verdict = judged(code, mutant.name, mutant.tree(), RULE_TESTS, first=KILLERS_KNOWN.get(mutant.key, ""))
    assert verdict.fate == "killed", mutant.key
    assert verdict.by


def test_every_rule_of_the_language_page_has_mutants() -> None:
    rules = {mutant.rule for mutant in mutants()}
    assert rules >= {f"N{n}" for n in range(1, 11)} | {"COM", "TIME", "PAR", "SEQ"}
    assert rules >= {"ASSERT", "SIT", "SUCCEED", "UPDATE", "DRAIN", "INHIBIT", "DISABLE", "STUB", "KILL", "POST"}


def test_every_function_of_the_semantics_belongs_to_a_rule() -> None:
    lost = {mutant.rule for mutant in mutants() if "." in mutant.rule}
    assert not lost


def test_the_rules_as_they_are_pass(code: Code) -> None:
    tree = ast.parse((ROOT / "src/planner_reactor/rs/store.py").read_text(encoding="utf-8"))
    assert judged(code, "planner_reactor.rs.store", tree, RULE_TESTS).fate == "survived"


@pytest.mark.parametrize(
    ("text", "fate"), [("Store.get = lambda self, n: [1 for _ in iter(int, 1)]", "killed"), ("no.such", "stillborn"),
                       ("yield 1", "stillborn")]
)  # fmt: skip
def test_what_never_ends_is_found_and_what_cannot_be_loaded_is_not_counted(code: Code, text: str, fate: str) -> None:
    source = (ROOT / "src/planner_reactor/rs/store.py").read_text(encoding="utf-8")
    assert judged(code, "planner_reactor.rs.store", ast.parse(f"{source}\n{text}\n"), RULE_TESTS).fate == fate


def test_operators_change_what_they_name() -> None:
    text = "def f(store, x):\n    if x and store:\n        store = store.left(1)\n    return any(store) or x == 1\n"
    found = {(m.operator, m.before, m.after) for m in mutations(ast.parse(text))}
    assert ("swap any/all", "any(store)", "all(store)") in found
    assert ("old store for left", "store.left(1)", "store") in found
    assert ("drop statement", "store = store.left(1)", "pass") in found
    assert ("drop operand", "x and store", "store") in found
    assert ("swap comparison", "x == 1", "x != 1") in found
    assert ("off by one", "1", "2") in found


def test_a_mutation_changes_one_place_and_leaves_the_tree_alone() -> None:
    tree = ast.parse("x = [1, 2]\ny = 1\n")
    before = ast.dump(tree)
    texts = {ast.unparse(m.applied(tree)) for m in mutations(tree)}
    assert ast.dump(tree) == before
    pairs = {("[2, 2]", "1"), ("[0, 2]", "1"), ("[1, 3]", "1"), ("[1, 2]", "2"), ("[1, 2]", "0")}
    assert texts == {f"x = {x}\ny = {y}" for x, y in pairs}


def test_what_is_called_equivalent_still_exists_and_has_a_reason() -> None:
    keys = {mutant.key for mutant in mutants()}
    assert [key for key in equivalents() if key not in keys] == []
    assert all(len(reason) > 20 for reason in equivalents().values())


def test_the_campaign_found_nearly_all() -> None:
    table = json.loads(TABLE.read_text(encoding="utf-8"))
    assert score(table) >= 0.95
    assert sum(row["killed"] for row in table.values()) > 1000
    assert {mutant.rule for mutant in mutants()} <= set(table)
