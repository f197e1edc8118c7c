"""What a host registers, and what it is told when that makes no sense."""

from __future__ import annotations

import pytest

from planner_reactor.errors import InputError
from planner_reactor.runtime import Host


@pytest.fixture
def host() -> Host:
    return Host("h")


def test_kinds_come_from_annotations_and_defaults_may_be_left_out(host: Host) -> None:
    @host.process(results=("x", "y"), window=(0.5, 2))
    def Move(where: str, speed: float, what: object, times: int = 1) -> None: ...

    signature = host.signatures["Move"]
    assert signature.inputs == ("symbol", "number", "any", "number")
    assert (signature.results, signature.optional, signature.window) == (("x", "y"), 1, (0.5, 2))


def test_a_count_of_results_names_them(host: Host) -> None:
    @host.process(results=2, limit=1, name="Look")
    def look_around() -> None: ...

    assert host.signatures["Look"].results == ("r1", "r2")


@pytest.mark.parametrize(
    "options",
    [{}, {"window": (0, float("inf"))}, {"window": (2, 1)}, {"window": (-1, 1)}, {"limit": float("inf")},
     {"window": (3, 9), "limit": 2}, {"window": (0, 1), "outcomes": ("done",)}],
)  # fmt: skip
def test_a_process_without_an_end_or_with_a_wrong_window_is_refused(host: Host, options: dict[str, object]) -> None:
    with pytest.raises(InputError, match="Move"):

        @host.process(**options)  # type: ignore[arg-type]
        def Move() -> None: ...


def test_a_name_is_registered_once_and_never_a_built_in_one(host: Host) -> None:
    @host.process(limit=1)
    def Move() -> None: ...

    with pytest.raises(InputError, match="twice"):

        @host.process(limit=1, name="Move")
        def Other() -> None: ...

    with pytest.raises(InputError, match="built-in"):

        @host.process(limit=1)
        def Delay() -> None: ...


def test_assumptions_are_asked_and_reports_are_passed_on(host: Host) -> None:
    @host.assumption("Settled")
    def settled() -> bool | None:
        return None

    heard: list[tuple[str, bool, str]] = []
    host.listen(lambda *report: heard.append(report))
    host.report("Settled", False, "it was not there")
    assert host.assumptions["Settled"]() is None
    assert heard == [("Settled", False, "it was not there")]
    with pytest.raises(InputError, match="did you mean Settled"):
        host.report("Setled", True)
