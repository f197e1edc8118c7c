"""What a mutant meets after the tests of the rules: some random programs, and some laws on a few terms."""

from __future__ import annotations

import pytest

from tests.conformance.running import conforms
from tests.conformance.texts import example
from tests.laws.checking import checked
from tests.laws.table import LAWS, Law

CHUNK = 10
PROGRAMS = 100
TERMS = 8


@pytest.mark.parametrize("first", range(0, PROGRAMS, CHUNK))
def test_random_programs_conform(first: int) -> None:
    for seed in range(first, first + CHUNK):
        conforms(example(seed), seed)


@pytest.mark.parametrize("law", LAWS)
def test_a_law_holds_for_a_few_terms(law: Law) -> None:
    assert not checked(law, TERMS, timed=False, independent=TERMS).failures
