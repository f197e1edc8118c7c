"""A verdict from memory is the verdict that looking again would give, whatever came before; so are bounds."""

from __future__ import annotations

from random import Random
from typing import TypeVar

import pytest
from msgspec.structs import replace

from planner_reactor.analysis.adaptations import Environment, Verifier
from planner_reactor.analysis.forms import Forms, Known
from planner_reactor.analysis.looking import finish
from planner_reactor.analysis.slicing import Slice, sliced
from planner_reactor.analysis.standing import Standing, shape
from planner_reactor.errors import RSError
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.reactions import Reaction, Surgery, reaction_of
from planner_reactor.rs.vocabulary import Signature

ENVIRONMENT = Environment({n: Signature(n, window=(0.0, t)) for n, t in (("Find", 3.0), ("Put", 5.0))})
LEAVES = 2
NAMES = ("a", "b", "c", "d", "e", "f")


class Reactors:
    """Random reactors over a few situations, each asserting some of those after it, and changes of them."""

    def __init__(self, seed: int, forms: Forms) -> None:
        self.draw = Random(seed)
        self.next = 0
        self.forms = forms
        self.standing = Standing()
        self.present: dict[int, Reaction] = {}
        for at in reversed(range(len(NAMES))):
            self.come(self.text(at))
        for name in self.draw.sample(NAMES, 2):
            self.come(f"P[{self.label()}] = STOP :; ASSERT[{name}]")

    def label(self) -> int:
        self.next += 1
        return self.next

    def text(self, at: int) -> str:
        """A reaction for the situation at this place."""
        draw, name = self.draw, NAMES[at]
        below = [f"REASSERT[{n}, p{draw.randint(0, 9)}]" for n in NAMES[at + 1 :]]
        asked = draw.sample(below, min(len(below), draw.randint(0, 2))) if at < LEAVES else []
        body = " : ".join([*asked, draw.choice(["Find<y> : Put[y]", f"Put[{draw.choice(NAMES)}]"])])
        loop = "::" if at < LEAVES and draw.random() < 0.2 else ":;"
        return f"P[{self.label()}] = SIT[{name}]<k> {loop} (~(({body}) : SUCCEED[{name}, k]) : FAIL[{name}, k])"

    def come(self, text: str) -> None:
        for known in self.forms.read(text):
            self.standing.add(known)
        self.present |= {r.label: r for r in parsed(text)}

    def change(self) -> tuple[str, Surgery]:
        """One or two situations anew: right, or with a defect."""
        draw = self.draw
        chosen = (
            sorted(draw.sample(range(len(NAMES)), 2)) if draw.random() < 0.05 else [draw.randint(0, len(NAMES) - 1)]
        )
        held = tuple(NAMES[n] for n in chosen)
        kills = tuple(n for s in held for n, r in self.present.items() if r.situation == s)
        texts = [self.text(n) for n in chosen]
        adds = tuple(reversed(range(self.next - len(texts) + 1, self.next + 1)))
        right = Surgery(held=held, kills=kills, adds=adds, named=held)
        return "\n".join(texts), draw.choice([
            right, right, right,
            replace(right, held=held[1:]), replace(right, held=tuple(reversed(held))), replace(right, named=()),
            replace(right, kills=(*kills, 999)), replace(right, adds=(*adds, 998)),
        ])  # fmt: skip


def parsed(text: str) -> list[Reaction]:
    return [r for r in map(reaction_of, parse_program(text).schemas) if r is not None]


@pytest.mark.parametrize("seed", range(3))
def test_a_verdict_from_memory_is_that_of_looking_again(seed: int) -> None:
    """And equal shapes have equal slices."""
    remembering, plain, forms = Verifier(ENVIRONMENT), Verifier(ENVIRONMENT), Forms()
    slices, known, wrong = dict[object, Slice](), 0, 0
    for number in range(3):
        reactors = Reactors(10 * seed + number, forms)
        for _ in range(16):
            text, surgery = reactors.change()
            read, new = of(surgery, forms.read(text)), of(surgery, parsed(text))
            before = len(remembering.right)
            found = finish(remembering.looking(reactors.standing, read, surgery))
            whole = plain.verify(reactors.present.values(), new, surgery)
            assert replace(found, states=0) == replace(whole, states=0)
            known += found.holds and len(remembering.right) == before
            wrong += not found.holds
            part = sliced(list(reactors.present.values()), new, surgery).slice
            alike = shape(reactors.standing.around(read, surgery), read, surgery)
            assert slices.setdefault(alike, part) == part
            if found.holds:
                for label in surgery.kills:
                    reactors.standing.remove(label)
                    del reactors.present[label]
                reactors.come(text)
    assert known > 0
    assert wrong > 0


T = TypeVar("T", Known, Reaction)


def of(surgery: Surgery, reactions: list[T]) -> list[T]:
    """In the order of the adds."""
    found = {r.label: r for r in reactions}
    return [found[n] for n in surgery.adds if n in found]


@pytest.mark.parametrize(
    ("one", "other", "alike"),
    [
        ("SIT[a]<k> :; SUCCEED[a, k]", "SIT[b]<x> :; SUCCEED[b, x]", True),
        ("SIT[a]<k> :; SUCCEED[a, k]", "SIT[a]<k> :; SUCCEED[b, k]", False),  # other names are the same
        ("SIT[a]<k> :; SUCCEED[a, k]", "SIT[a]<k> :; SUCCEED[a, x]", False),  # bound, and not
        ("Delay[1] :; ASSERT[a]", "Delay[2] :; ASSERT[a]", False),  # numbers count
        ("Find[a] :; ASSERT[a]", "Put[a] :; ASSERT[a]", False),  # and who is called
        ("Find[if1] :; ASSERT[a]", "Find[c] :; ASSERT[a]", True),
    ],
)
def test_a_form_is_a_text_up_to_names(one: str, other: str, alike: bool) -> None:
    forms = Forms()
    (first,), (second,) = forms.read(f"P[1] = {one}"), forms.read(f"P[2] = {other}")
    assert (first.form is second.form) == alike
    for known, text in ((first, one), (second, other)):
        (reaction,) = parsed(f"P[{known.label}] = {text}")
        assert (known.situation, known.asserts, known.reaction) == (reaction.situation, reaction.asserts, reaction)


@pytest.mark.parametrize(
    "text",
    [
        'SIT["a"]<k> :; SUCCEED["a", k]',
        "SIT[a]<k> :; Put[f(k)] : SUCCEED[a, k]",
        "SIT[a]<k> :; Put[k > x] : SUCCEED[a, k]",
        "SIT[a]<k> :; Put[(k)] : SUCCEED[a, k]",
        "SIT[ä]<k> :; SUCCEED[ä, k]",
        "SIT[a]<k>\n  :; SUCCEED[a, k]",
    ],
)
def test_what_is_not_plain_is_parsed_by_itself(text: str) -> None:
    (known,) = Forms().read(f"P[1] = {text}")
    assert known.form.number < 0
    assert known.reaction == parsed(f"P[1] = {text}")[0]


def test_what_cannot_be_read_is_told_of_the_whole_text() -> None:
    with pytest.raises(RSError, match="<adaptation 3>"):
        Forms().read("P[1] = STOP\nP[2] = SIT[a", file="<adaptation 3>")
