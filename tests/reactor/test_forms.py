"""A text read by its form comes to what it comes to when it is read anew, places included, or is refused like it."""

from __future__ import annotations

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner_reactor.link.messages import Adaptation, Change
from planner_reactor.reactor import forms
from planner_reactor.reactor.preparing import Preparing, Vocabulary
from planner_reactor.reactor.reactor import EQUATION_3, Reactor
from planner_reactor.reactor.structure import bound_of
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import Process
from planner_reactor.rs.vocabulary import BUILT_IN, Signature
from tests.reactor.driving import Bench
from tests.strategies import HOST, OPERATORS, any_call, processes, sound_leaf

VOCABULARY = Vocabulary(
    {**BUILT_IN, **HOST, "Act2": Signature("Act2", ("any",)), "Act3": Signature("Act3", ("number",))},
    {"f": lambda *given: 0, "g1": lambda *given: 0},
    EQUATION_3,
)

SOUND = """P[12] = SIT[s7]<k1, x>
  :; (~(Act[x + 40] : REASSERT[t7, x, 12] : SUCCEED[s7, k1]) : FAIL[s7, k1])  // 7 of 12
P[13] = SIT[t7]<k, y, n> :: (Act[0] ; (Act[y] | ASSUMONITOR[a7, 30]) ;
         (if Equal[n, 12] then SUCCEED[t7, k] else FAIL[t7, k]))"""


def preparing() -> Preparing:
    return Preparing(VOCABULARY, lambda schemas: tuple(schemas))  # type: ignore[arg-type]  # shows them


def read(by: Preparing, text: str) -> str:
    """All that it comes to, places included."""
    prepared = by.prepare(Adaptation(id=5, definitions=text))
    return repr((prepared.reactions, prepared.clauses, prepared.compiled, str(prepared.refusal)))


def known(by: Preparing, text: str) -> bool:
    found = forms.key_of(text)
    return found is not None and by._forms.get(found[0]) is not None


def renumbered(text: str, numbers: dict[str, str]) -> str:
    return re.sub("[0-9]+", lambda run: numbers.get(run[0], run[0]), text)


def taught(text: str) -> Preparing:
    by = preparing()
    for _ in range(3):
        read(by, text)
    return by


def test_another_text_of_a_form_is_not_checked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    other = renumbered(SOUND, {"12": "1203", "13": "9", "7": "88", "40": "5"})
    anew, by = read(preparing(), other), taught(SOUND)
    monkeypatch.setattr(Preparing, "_load", None)  # whoever reads a text now fails
    assert read(by, other) == anew
    assert "s88" in anew
    assert "Place(line=2" in anew


@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        (SOUND, {"12": "13"}),  # two clauses with one head
        (SOUND, {"13": "012"}),  # written otherwise
        (SOUND, {"7": "1" * 90}),
        ("P[1] = Act2[s4] :; NIL", {"2": "3"}),  # of another kind
        ("P[1] = Act2[s4] :; NIL", {"2": "4"}),  # there is none
        ("P[1] = Act[g1(4)] :; NIL", {"1": "2"}),
        ("P[1] = Act[-1] :; NIL\nP[2] = Act[0] :; NIL", {"1": "0"}),
        ("P[1] = Act[1.5] :; NIL", {"5": "50"}),
        ("P[1] = Act[1e3] :; NIL", {"3": "400"}),
        ('P[1] = Act["1"] :; NIL\nP[2] = Act[1] :; NIL', {"1": "3"}),
        ("P[1] = (Act[1] : P[1]) :; NIL", {"1": "2"}),
        ("P[1] = Act[1] : P[2]\nP[2] = Act[1] :; NIL", {"2": "3"}),
        ("P[1] = SIT[s1]<k> :; ASSERT[s2]\nP[2] = SIT[s2]<k> :; NIL", {"2": "1"}),
        ("P[1] = SIT[s1]<k1, k2> :; Act[k3]", {"3": "1"}),
        ("P[1] = SIT[s1]<k1, k2> :; Act[k1]", {"2": "1"}),
        ("Q[1] = Act[1] :; NIL", {"1": "2"}),
    ],
)
def test_what_only_looks_alike_is_read_for_itself(text: str, numbers: dict[str, str]) -> None:
    other = renumbered(text, numbers)
    assert read(taught(text), other) == read(preparing(), other)
    assert read(taught(text), text) == read(preparing(), text)


DIGITS = st.sampled_from(("0", "1", "2", "3", "7", "10", "12", "345", "08", "99999999999999999999"))


def random_bodies() -> st.SearchStrategy[Process]:
    kinds = {"depth": 3, "operators": OPERATORS}
    sound = processes(leaf=sound_leaf, guarded=True, **kinds)  # type: ignore[arg-type]
    return st.one_of(sound, sound, processes(leaf=any_call, **kinds))  # type: ignore[arg-type]


@settings(max_examples=150, deadline=None)
@given(st.lists(random_bodies(), min_size=1, max_size=2), st.dictionaries(DIGITS, DIGITS))
def test_a_random_text_renumbered_at_random_comes_to_what_it_says(
    bodies: list[Process], numbers: dict[str, str]
) -> None:
    text = "\n".join(f"P[{label}] = SIT[s{label}]<k> :; ({show(body)})" for label, body in enumerate(bodies, 1))
    by = taught(text)
    for other in (text, renumbered(text, numbers)):
        assert read(by, other) == read(preparing(), other)


def test_random_texts_do_have_forms() -> None:
    """Otherwise the test above would say nothing."""
    texts = ["P[1] = SIT[s1]<k> :; (Act[k] ; Delay[2] : Act[10])", SOUND]
    assert all(known(taught(text), text) for text in texts)
    assert not known(taught("P[1] = Act[1.5] :; NIL"), "P[1] = Act[1.5] :; NIL")
    by = preparing()
    assert [known(by, SOUND) for _ in range(3) if read(by, SOUND)] == [False, True, True]


def test_forms_are_bounded() -> None:
    by = preparing()
    for number in range(2 * forms.MOST):
        name = "".join(chr(97 + int(c)) for c in str(number))
        for _ in range(2):
            read(by, f"P[1] = Act[{name}] :; NIL")
    assert len(by._forms._forms) <= forms.MOST
    assert len(by._forms._met) <= forms.MOST


TWO_LEVELS = """P[{0}] = SIT[top1]<k> :; (~((Long ; REASSERT[part1]) : SUCCEED[top1, k]) : FAIL[top1, k])
P[{1}] = SIT[part1]<k> :; (~(Do[a{0}, 2] : {2} : SUCCEED[part1, k]) : FAIL[part1, k])"""


@pytest.mark.parametrize(("rest", "kept"), [("Do[b7, 3]", True), ("Long", True), ("Delay[41]", False)])
def test_the_bound_of_what_was_read_by_its_form_is_the_bound_of_its_text(rest: str, kept: bool) -> None:
    bench = Bench()
    reactor, limits = bench.reactor, {name: process.limit for name, process in bench.host.processes.items()}
    found = []
    for number in range(1, 9):
        below, top = 20 + 2 * number, 21 + 2 * number
        adaptation = Adaptation(
            id=number,
            definitions=TWO_LEVELS.format(top, below, rest if number % 2 else "Do[b8, 1]"),
            changes=tuple(Change(situation=s, base=number - 1, fresh=number == 1) for s in ("top1", "part1")),
            kills=() if number == 1 else (top - 2, below - 2),
            adds=(below, top),
        )
        by_form = reactor.bound(adaptation)
        assert by_form == bound_of(adaptation, reactor.reactions, reactor.vocabulary.signatures, limits)
        found.append(by_form)
        reactor.receive(adaptation)
        bench.scheduler.run(bench.scheduler.now)
    assert reactor.counts["applied"] == 8
    assert found[0] == 1.0 < 500 < min(found[1:])
    assert any(label in reactor._durations for label in (36, 37))
    assert (91 in durations_of(reactor, rest)) is kept  # not if a number says how long


def durations_of(reactor: Reactor, rest: str) -> set[int]:
    """The labels of reactions with this rest of which it is known how long they take."""
    text = TWO_LEVELS.format(91, 90, rest)
    return set(reactor.prepare(Adaptation(id=99, definitions=text, adds=(90, 91))).durations)
