"""The executer takes only steps that `evolves` allows, and reaches the same outcomes: 10,000 random programs.

The programs are in `tests.conformance.texts`; what they pass through, in `tests.conformance.coverage`. A longer run
is `make conformance`.
"""

from __future__ import annotations

from typing import Any

import pytest

from planner_reactor.analysis.conformance import Disagreement
from planner_reactor.reactor.guards import Guards
from planner_reactor.reactor.instances import Instance
from planner_reactor.reactor.situations import Situations
from planner_reactor.runtime import built_in, kernel
from tests.conformance.coverage import Coverage
from tests.conformance.running import conforms
from tests.conformance.shrinking import shrunk
from tests.conformance.texts import Example, example

PROGRAMS = 10_000
COVERING = 1_000
CHUNK = 250


def all_conform(seeds: range) -> None:
    for seed in seeds:
        try:
            conforms(example(seed), seed)
        except Exception as problem:
            raise AssertionError(f"program {seed}:\n{example(seed)}") from problem


def test_random_programs_conform_and_pass_every_statement_of_the_semantics() -> None:
    coverage = Coverage()
    try:
        all_conform(range(COVERING))
    finally:
        coverage.close()
    assert coverage.missing() == []


@pytest.mark.parametrize("first", range(COVERING, PROGRAMS, CHUNK))
def test_random_programs_conform(first: int) -> None:
    all_conform(range(first, first + CHUNK))


def test_a_statement_that_no_program_passes_is_missing() -> None:
    coverage = Coverage()
    try:
        for seed in range(5):
            conforms(Example("", ("Delay[1] : (STOP # NIL)",)), seed)
    finally:
        coverage.close()
    missing = coverage.missing()
    assert ("operator", "&", "stop") in missing
    assert any(place == "serving.drain" for place, _, _ in missing)
    assert ("operator", ":", "stop") not in missing


DEFECTS: dict[str, tuple[object, str, Any]] = {
    "a situation may be asserted below itself": (Situations, "_above", staticmethod(lambda owner, name: False)),
    "what is withdrawn goes on": (Instance, "gone", property(lambda self: self.status != "on")),
    "a queue is not released": (Situations, "_release", lambda self, situation: None),
    "an owner's inhibitions outlive it": (Situations, "root_ended", lambda self, owner: None),
    "KILL cuts": (Guards, "at_rest", lambda self, label: True),
    "the last to end decides a #": (kernel, "verdict", lambda fork: fork.ended[-1]),
    "a delay ends a little late": (built_in, "milliseconds", lambda age, kernel: age / 1000 + 0.001),
}


@pytest.mark.parametrize("defect", DEFECTS)
def test_a_defect_of_the_executer_is_found(defect: str, monkeypatch: pytest.MonkeyPatch) -> None:
    place, name, wrong = DEFECTS[defect]
    monkeypatch.setattr(place, name, wrong)
    assert any(disagrees(example(seed), seed) for seed in range(COVERING // 2))


def disagrees(candidate: Example, seed: int) -> bool:
    try:
        conforms(candidate, seed)
    except Disagreement:
        return True
    except Exception:
        return False
    return False


def test_what_is_found_is_made_small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Situations, "root_ended", lambda self, owner: None)
    seed = next(seed for seed in range(COVERING) if disagrees(example(seed), seed))
    small = shrunk(example(seed), lambda candidate: disagrees(candidate, seed))
    assert len(str(small)) < len(str(example(seed))) / 2
    assert disagrees(small, seed)


FOUND = {
    "KILL is tried again when what was in service has ended without a step of its own": Example(
        "",
        (
            "E[3] # (ASSERT[s, 2]<x> | ASSERT[t, 4]<y>)",
            "KILL[3]",
            "DRAIN[t] ; Delay[1] ; FAIL[s, 1] ; Delay[1]",
        ),
    ),
    "a body that a FREEZE cuts off binds nothing": Example(
        "",
        (
            "ASSERT[s] | SIT[s]<k> : Give<x> : (NIL & (Give<y> ; IN[p]<z>)) | OUT[p, 1]",
            "Delay[0.5] ; FREEZE[s] ; Delay[1] ; DRAIN[s]",
        ),
    ),
    "a POST that is refused leaves its ADD to the next": Example(
        "",
        (
            "(E[1] # Never) | (ADD<m> :: (E[m] # (IN[q] : Delay[1])))",
            "POST[8] ; POST[7] ; Delay[1]",
            "POST[8] ; Delay[1]",
            "POST[8] ; Delay[1]",
        ),
    ),
    "a POST that waits is refused when its label comes into use": Example(
        "", ("Delay[1] ; (E[7] # Never)", "POST[7] ; Delay[2]")
    ),
    "what ends by a communication may be the last that kept a KILL": Example(
        "", ("STREAM[p, 1] | (E[3] # ((ASSERT[s, 0] | IN[p]) | IN[p]<x>))", "DRAIN[s] : KILL[3]")
    ),
    "two strands at one SIT are both served when an inhibition ends": Example(
        "",
        (
            "IN[p]<x> :: (SIT[s]<k> : Delay[1])",
            "ASSERT[s] | ASSERT[s] | (Delay[1] ; INHIBIT[s] ; OUT[p, 1] ; OUT[p, 2] ; Delay[1] ; UNINHIBIT[s])",
        ),
    ),
    "a string that a function doubles at every round comes to an end": Example(
        "",
        ("(IN[p]<x> :: OUT[p, twice(x)]) # Never", "OUT[p, red]"),
    ),
}
"""What campaigns have found, made small."""


@pytest.mark.parametrize("what", FOUND)
def test_what_was_found_once_conforms(what: str) -> None:
    for seed in range(1, 12):  # a fifth of the seeds kills a root
        conforms(FOUND[what], seed)
