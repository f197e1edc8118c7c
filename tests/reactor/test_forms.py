"""A text read by its form comes to what it comes to when it is read anew, places included, or is refused like it."""

from __future__ import annotations

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner_reactor.link.messages import Adaptation
from planner_reactor.reactor import forms
from planner_reactor.reactor.preparing import Preparing, Vocabulary
from planner_reactor.reactor.reactor import EQUATION_3
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import Process
from planner_reactor.rs.vocabulary import BUILT_IN, Signature
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
