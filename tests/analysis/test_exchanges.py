"""What is called an exchange is right: every state of a family of them is explored, and of what is nearly one."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from itertools import product

import pytest
from msgspec.structs import replace

from planner_reactor.analysis.adaptations import LIMIT, _looking
from planner_reactor.analysis.exchanges import is_exchange
from planner_reactor.analysis.looking import finish
from planner_reactor.analysis.slicing import Slice, sliced
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.reactions import Reaction, Surgery, reaction_of

OLD = ("", "Do", "ASSERT[g]", "(REASSERT[g] & Do)", "(ASSERT[g] # Do)", "(if ASSERT[g] then Do else REASSERT[g])")
NEW = ("Do", "REASSERT[n]", "(ASSERT[n] & Do)", "(if Do then REASSERT[n] else Do)")
BELOW = ("Do", "ASSERT[h]")


def body(situation: str, does: str) -> str:
    """A reaction's text; one that does nothing is a stub."""
    if not does:
        return f"SIT[{situation}]<k> :; (STUB[{situation}] : SUSPEND[2000] ; FAIL[{situation}, k])"
    return f"SIT[{situation}]<k> :; (~({does} : SUCCEED[{situation}, k]) : FAIL[{situation}, k])"


def reactions(*bodies: str, first: int = 0) -> list[Reaction]:
    text = "\n".join(f"P[{n}] = {body}" for n, body in enumerate(bodies, first))
    found = [reaction_of(schema) for schema in parse_program(text).schemas]
    return [reaction for reaction in found if reaction is not None]


@cache
def family(askers: int) -> tuple[Slice, ...]:
    """One situation's reaction exchanged: what it asserted goes, what the new one asserts comes."""
    found = []
    for old, new, below in product(OLD, NEW, BELOW):
        going = ["s", *(["g"] if "[g]" in old else []), *(["h"] if "[g]" in old and "[h]" in below else [])]
        if below != "Do" and len(going) < 3:
            continue
        coming = ["n", "s"] if "[n]" in new else ["s"]
        texts = {"s": old, "g": below, "h": "Do"}
        before = reactions(*(body(name, texts[name]) for name in going))
        after = reactions(*(body(name, {"s": new, "n": "Do"}[name]) for name in coming), first=10)
        asking = reactions(*["Ask :; ASSERT[s]"] * askers, first=20)
        surgery = Surgery(
            held=tuple(going), kills=tuple(r.label for r in before), adds=tuple(r.label for r in after),
            named=tuple(dict.fromkeys([*going, *coming])), removed=tuple(going[1:]),
        )  # fmt: skip
        found.append(sliced([*before, *asking], after, surgery).slice)
    return tuple(found)


def is_right(part: Slice) -> bool:
    return not finish(_looking(part, "drain", LIMIT)).broken


@pytest.mark.parametrize("askers", [1, 2])
def test_all_of_the_family_are_exchanges_and_right(askers: int) -> None:
    for part in family(askers)[:: 1 if askers == 1 else 9]:
        assert is_exchange(part)
        assert is_right(part)


def spoilt(part: Slice) -> Iterator[tuple[str, Slice]]:
    """What is nearly an exchange."""
    surgery = part.surgery
    yield "held in no order", replace(part, surgery=replace(surgery, held=surgery.held[::-1]))
    yield "not held", replace(part, surgery=replace(surgery, held=surgery.held[1:]))
    yield "what goes is not held", replace(part, surgery=replace(surgery, held=surgery.held[:1]))
    yield "a reaction stays", replace(part, surgery=replace(surgery, kills=surgery.kills[:-1]))
    yield "nothing comes", replace(part, surgery=replace(surgery, adds=()))
    yield "what goes is asked for", replace(part, asked=(*part.asked, *surgery.held[1:2]))
    yield "parents first", replace(part, surgery=replace(surgery, adds=surgery.adds[::-1]))


def test_what_is_nearly_an_exchange_is_none_if_it_is_wrong() -> None:
    wrong: dict[str, int] = {}
    for part in family(1)[::8]:
        for what, other in spoilt(part):
            if other != part and not is_right(other):
                wrong[what] = wrong.get(what, 0) + 1
                assert not is_exchange(other), what
    assert {"not held", "held in no order", "nothing comes", "what goes is asked for"} <= {*wrong}


@pytest.mark.parametrize(
    "text",
    [
        "SIT[s]<k> :: (~(Do : SUCCEED[s, k]) : FAIL[s, k])",
        "SIT[s]<k> :; (~((Do :; Do) : SUCCEED[s, k]) : FAIL[s, k])",
        "SIT[s]<k> :; (~(Do : SUCCEED[s, k]) ; FAIL[s, k])",
        "SIT[s]<k> :; (~(Do : SUCCEED[s, k] : ASSERT[n]) : FAIL[s, k])",
        "STOP :; ASSERT[s]",
    ],
)
def test_what_serves_in_another_way_is_explored(text: str) -> None:
    (old,), (new,) = reactions(text), reactions(body("s", "Do"), first=10)
    part = sliced([old], [new], Surgery(held=("s",), kills=(0,), adds=(10,), named=("s",))).slice
    assert not is_exchange(part)
