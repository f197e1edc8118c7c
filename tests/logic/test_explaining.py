"""A contradiction is explained by statements of which none could be spared."""

from __future__ import annotations

import random

from planner_reactor.errors import Place
from planner_reactor.logic.allen import NAMED, relations
from planner_reactor.logic.explaining import explanation
from planner_reactor.logic.problems import Capacity, Lasts, Lies, Statement, Uses
from planner_reactor.logic.solving import solve
from tests.logic import worlds


def said(first: str, names: str, second: str, words: str = "") -> Lies:
    return Lies(first=first, relation=relations(names.split()), second=second, words=words)


def test_a_circle_is_explained_by_itself_alone() -> None:
    circle = [said("a", "b", "b1"), said("b1", "b m", "c"), said("c", "b", "a")]
    others = [said("a", "b m o", "x"), said("x", "d f", "y"), said("b1", "o", "z")]
    mixed = [others[0], circle[0], others[1], circle[1], others[2], circle[2]]
    assert explanation(mixed) == tuple(circle)
    assert explanation([*others, *circle[:2]]) is None


def test_it_speaks_in_the_words_that_were_given() -> None:
    place = Place(12, 5, "kitting.itl")
    statements: list[Statement] = [
        said("Insert", "b m", "Verify", "Verify comes after Insert, for it needs In(t, x)"),
        Lies(first="Verify", relation=NAMED["during"], second="Insert", words="Verify watches Insert", place=place),
    ]
    found = explanation(statements)
    assert found is not None
    assert [str(one) for one in found] == ["Verify comes after Insert, for it needs In(t, x)", "Verify watches Insert"]
    assert found[1].place == place


def test_words_of_its_own_are_the_notation_of_network_texts() -> None:
    statements: list[Statement] = [
        said("i", "d s", "j"),
        Lasts(interval="i", least=3000, most=None),
        Lasts(interval="j", least=0, most=2000.5),
        Uses(interval="i", resource="arm", amount=2),
        Capacity(resource="arm", amount=2),
    ]
    assert [str(one) for one in statements] == [
        "i [s d] j", "i lasts 3000 ..", "j lasts 0 .. 2000.5", "i uses arm 2", "resource arm 2",
    ]  # fmt: skip
    assert explanation(statements) == tuple(statements[:3])


def test_a_resource_is_part_of_an_explanation() -> None:
    statements: list[Statement] = [
        Capacity(resource="camera", amount=3),
        said("look", "o d s f e", "track"),
        Uses(interval="look", resource="camera", amount=2),
        Uses(interval="move", resource="arm"),
        Uses(interval="track", resource="camera", amount=2),
    ]
    found = explanation(statements)
    assert found is not None
    assert [str(one) for one in found] == [
        "resource camera 3", "look [o s d f e] track", "look uses camera 2", "track uses camera 2",
    ]  # fmt: skip


def test_every_statement_of_an_explanation_is_needed() -> None:
    rng = random.Random(17)
    explained = 0
    while explained < 60:
        network = worlds.uniform(rng, 2.2)
        statements = [Lies(first=i, relation=relation, second=j) for (i, j), relation in network.items()]
        found = explanation(statements)
        assert (found is None) == (worlds.fitting(network) != 0)
        if found is not None:
            explained += 1
            assert solve(found).times is None
            for n in range(len(found)):
                assert solve(found[:n] + found[n + 1 :]).times is not None
