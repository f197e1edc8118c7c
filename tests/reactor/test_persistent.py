"""A mapping that is a value: whoever holds an older version sees it as it was, and changing the newest is cheap."""

from __future__ import annotations

from random import Random

from planner_reactor.reactor.persistent import Persistent


def test_every_version_stays_as_it_was() -> None:
    random = Random(3)
    versions = [Persistent({n: str(n) for n in range(5)})]
    copies = [dict(versions[0])]
    for step in range(400):
        which = random.randrange(len(versions)) if step % 5 == 0 else len(versions) - 1
        gone = random.sample(range(12), 3)
        puts = dict.fromkeys(random.sample(range(12), 2), f"{step}")
        versions.append(versions[which].changed(puts, without=gone))
        copies.append({**{k: v for k, v in copies[which].items() if k not in gone}, **puts})
        checked = random.randrange(len(versions))
        assert versions[checked] == copies[checked]
        assert [versions[checked].get(key) for key in range(12)] == [copies[checked].get(key) for key in range(12)]
    assert versions == copies
    assert [len(version) for version in versions] == [len(copy) for copy in copies]


def test_the_newest_has_the_order_of_a_dict() -> None:
    made = Persistent({"b": 1, "a": 2}).changed({"a": 3, "c": 4}).changed({"b": 5}, without=["b"])
    assert list(made.items()) == [("a", 3), ("c", 4), ("b", 5)]


def test_what_may_differ_between_two_versions_is_told() -> None:
    first = Persistent({1: "x", 2: "y"})
    second = first.changed({3: "z"})
    third = second.changed({}, without=[1])
    assert first.keys_changed_until(third) == {1, 3}
    assert third.keys_changed_until(third) == set()
    assert second.keys_changed_until(first) is None
    assert first.keys_changed_until(Persistent({1: "x"})) is None
