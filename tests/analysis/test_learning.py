"""What a model leaves open is learned from what a sensor tells (X §7)."""

from __future__ import annotations

from math import floor
from random import Random

import pytest

from planner_reactor.analysis.denseness import Netlist, asked, opened
from planner_reactor.analysis.learning import learned, observed
from planner_reactor.errors import InputError
from planner_reactor.rs.parser import parse_program
from planner_reactor.workcell.environments.dynamics import host, model


def nets(name: str, process: str) -> Netlist:
    world = opened(parse_program(model(name)), host.signatures)
    return Netlist(asked(process, world, {}), world)


def belt(mu: float, tm0: float, seed: int, every: float = 0.05) -> list[tuple[float, float]]:
    """What is read of a belt now and then, not always."""
    random, now, readings = Random(seed), 0.0, []
    while now < 20 * tm0:
        readings.append((now, mu * floor(now / tm0 + 1e-9)))
        now += random.uniform(0.2, 1.0) * every
    return readings


@pytest.mark.parametrize(("mu", "tm0"), [(0.5, 1.0), (-0.3, 0.7), (0.02, 2.5)])
def test_the_speed_of_a_belt_is_learned_from_readings(mu: float, tm0: float) -> None:
    found = learned(nets("belt", "BEM[p, a, pr]"), "op", belt(mu, tm0, 1))
    assert found.values["mu"] == pytest.approx(mu)
    assert abs(found.values["tm0"] - tm0) <= found.errors["tm0"] < 0.02
    assert found.changes == 19


def test_changes_that_nobody_saw_do_not_make_it_slower() -> None:
    seen = [r for n, r in enumerate(belt(0.5, 1.0, 2)) if not 6.5 < r[0] < 9.5]
    found = observed(seen)
    assert (found.period, found.mean) == (pytest.approx(1.0, abs=0.01), pytest.approx(0.5))


def test_how_far_an_object_moves_at_random_is_at_least_the_farthest_seen() -> None:
    random = Random(3)
    places = [0.0]
    for _ in range(200):
        places.append(places[-1] + random.uniform(-0.4, 0.4))
    readings = [(n * 0.1, places[n // 10]) for n in range(2_000)]
    found = learned(nets("tracking", "TEM[p, a]"), "op", readings)
    assert 0.38 < found.values["eps"] <= 0.4
    assert found.values["t0"] == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize(
    ("port", "readings", "said"),
    [
        ("op", [(0.0, 1.0), (1.0, 1.0)], "0 changes in 2 readings, expected at least 3"),
        ("pos", [(0.0, 0.0)], "pos is no source: what it shows depends on op"),
        ("angle", [(0.0, 0.0)], "nobody writes it"),
    ],
)
def test_what_cannot_be_learned_is_refused(port: str, readings: list[tuple[float, float]], said: str) -> None:
    with pytest.raises(InputError, match=said):
        learned(nets("tracking", "TEM[p, a]"), port, readings)
