"""The size of a reduction (R §7.2) follows the response time, what is uncertain, and the resources."""

from __future__ import annotations

import pytest

from planner_reactor.errors import InputError
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner
from planner_reactor.planner.sizing import UNIT_MS
from tests.planner.driving import GREENHOUSE, TENDING, Book, first_adaptations, image, kitting, perception, settle

TIMES = (None, 0.0, 2.4, 2.8, 3.2, 1000.0)


def issued(response_ms: float | None) -> list[int]:
    """The sizes of the adaptations up to the first ω-ideal reactor: reactions that they add."""
    planner = Planner(kitting(), relax=(), verify=False, response_ms=response_ms)
    return [len(adaptation.changes) for adaptation in settle(planner) if adaptation.changes]


def test_the_longer_the_response_time_the_fewer_and_larger_the_adaptations() -> None:
    sizes = [issued(response_ms) for response_ms in TIMES]
    counts = [len(found) for found in sizes]
    assert counts[0] == counts[1] == 5
    assert counts == sorted(counts, reverse=True)
    assert counts[-1] == 1
    firsts = [found[0] for found in sizes]
    assert firsts == sorted(firsts)
    assert len(set(counts)) >= 3


@pytest.mark.parametrize("response_ms", TIMES)
def test_whatever_the_response_time_the_reactor_comes_out_the_same(response_ms: float | None) -> None:
    planner = Planner(kitting(), relax=(), response_ms=response_ms)
    usual = Planner(kitting(), relax=())
    book, other = Book(planner.domain), Book(planner.domain)
    settle(planner, book), settle(usual, other)
    assert image(planner) == image(usual)
    assert planner.breaches == ()
    planner.perceive(perception("assumption_failure", "AQ"))
    usual.perceive(perception("assumption_failure", "AQ"))
    settle(planner, book), settle(usual, other)
    assert image(planner) == image(usual)


def test_a_step_is_as_short_as_ever() -> None:
    """The time goes into an adaptation, not into a step: a perception is heard as soon."""
    planner = Planner(kitting(), relax=(), verify=False, response_ms=1000.0)
    settle(planner)
    assert planner.statistics()["longest_step"] <= 24


def test_what_a_perception_request_could_make_different_waits_for_the_answer() -> None:
    planner = Planner(kitting(GREENHOUSE), relax="none", verify=False, response_ms=1000.0)
    (first,) = first_adaptations(planner, 1)
    assert "STUB[TendBasil]" in first.definitions  # nobody knows whether there is a hose
    told = Planner(kitting(GREENHOUSE), relax="none", verify=False, response_ms=1000.0)
    told.perceive(perception("information", "Connected", "hose", "holds"))
    (first,) = first_adaptations(told, 1)
    assert "Spray[fig]" in first.definitions
    assert "STUB" not in first.definitions


def test_what_has_its_resource_to_itself_comes_before_what_waits_for_one() -> None:
    """The mill's loading has to wait for the arm; something that needs none is made concrete first."""
    text = TENDING.read_text().replace("=> Made(m);", "=> Made(m) and Logged(m);", 1)
    text += """
atp_actionschema Log <m><>
    effects: Logged(m);
    expansions: Logged(m);
endactionschema
atp_actionschema Write <m><>
    effects: Logged(m);
endactionschema
"""
    least = begun(Planner(read_domain(text), relax="none", verify=False))
    ms = (least.statistics()["units"] + 4) * UNIT_MS
    planner = begun(Planner(read_domain(text), relax="none", verify=False, response_ms=ms))
    stubs = [segment.name for segment in planner.model if segment.is_stub]
    assert {"LoadMill", "UnloadMill"} <= {*stubs}
    assert "LogLathe" not in stubs


def begun(planner: Planner) -> Planner:
    """Up to its first adaptation."""
    first_adaptations(planner, 1)
    return planner


def test_a_response_time_that_is_none_is_refused() -> None:
    with pytest.raises(InputError, match="response time is -1 ms, expected 0 or more"):
        Planner(kitting(), response_ms=-1)
