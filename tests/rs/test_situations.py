"""Situations and reactions: what would cut a tail off, never return, or never be served."""

from __future__ import annotations

import pytest

from tests.rs.findings import errors, findings, messages, places


@pytest.mark.parametrize(
    ("reaction", "column"),
    [
        ("SIT[s]<k> : SUCCEED[s, k]", 5),
        ("SIT[s]<k> ; SUCCEED[s, k]", 5),
        ("Delay[1] ; (SIT[s]<k> : SUCCEED[s, k])", 17),
        ("(SIT[s]<k> : Delay[1]) :; SUCCEED[s, k]", 6),
        ("(SIT[s]<k> # Delay[1]) :: Act[1]", 6),
        ("Delay[1] :; SIT[s]", 17),
        ("(~SIT[s]) :; Act[1]", 7),
    ],
)
def test_in_a_reaction_a_sit_is_the_whole_left_side_of_a_loop(reaction: str, column: int) -> None:
    text = f"P = {reaction}\nR = E[1] # P\nA = ASSERT[s]"
    assert errors(text) == ["sit-position"]
    assert places(text, "sit-position") == [(1, column)]
    assert errors(f"P = {reaction}\nA = ASSERT[s]") == []


def test_reactions_written_beside_their_guard_and_called_ones_are_held_to_the_same_rule() -> None:
    assert places("R = E[1] # (SIT[s]<k> : SUCCEED[s, k])", "sit-position") == [(1, 13)]
    assert places("R = E[1] # P\nP = Q\nQ = SIT[s] ; Act[1]", "sit-position") == [(3, 5)]
    assert places("R = ADD<k> :: (E[k] # P[k])\nP[7] = SIT[s] ; Act[1]", "sit-position") == [(2, 8)]


@pytest.mark.parametrize("loop", [":;", "::"])
def test_both_loops_over_a_sit_are_reactions(loop: str) -> None:
    text = f"P[7] = SIT[s]<k> {loop} (Act[1] ; SUCCEED[s, k])\nR = ADD<m> :: (E[m] # P[m])\nA = ASSERT[s]"
    assert findings(text) == []


def test_no_body_of_a_reaction_calls_its_own_definition() -> None:
    direct = "R = E[1] # P\nP = SIT[s]<k> :; (Act[1] ; P)\nA = ASSERT[s]"
    assert messages(direct, "self-call") == [
        "the body of this SIT calls P, which holds it, a loop goes on by itself when its body has ended"
    ]
    assert places(direct, "self-call") == [(2, 28)]
    around = "R = E[1] # P\nP = SIT[s]<k> :; (Act[1] ; Q)\nQ = Act[2] ; P\nA = ASSERT[s]"
    assert places(around, "self-call") == [(2, 28)]
    beside = "R = E[1] # P\nP = SIT[s]<k> :; (Act[1] ; Q)\nQ = Act[2] : Q\nA = ASSERT[s]"
    assert errors(beside) == []
    unguarded = "P = SIT[s]<k> :; (Act[1] ; P)\nA = ASSERT[s]"
    assert errors(unguarded) == []


def test_a_situation_is_asserted_from_below_itself_only_if_it_is_served_by_spawning() -> None:
    text = "P = SIT[s]<k> {} (ASSERT[s] ; SUCCEED[s, k])\nA = ASSERT[s]"
    assert places(text.format(":;"), "asserted-below-itself") == [(1, 19)]
    assert errors(text.format("::")) == []


def test_below_itself_through_other_situations_and_definitions() -> None:
    text = "P = SIT[s] :; Q\nQ = REASSERT[t]\nR = SIT[t] {} (Act[1] ; ASSERT[s])"
    assert messages(text.format(":;"), "asserted-below-itself") == [
        "situation s is asserted from below itself, "
        "its `:;` would wait for itself (s → t → s); serve it with SIT[s]<k> :: …"
    ]
    assert len(messages(text.format("::"), "asserted-below-itself")) == 1


def test_hierarchies_that_share_a_situation_are_fine() -> None:
    text = "P = SIT[a] :; (ASSERT[b] ; ASSERT[c])  Q = SIT[b] :; ASSERT[c]  R = SIT[c] :; Act[1]"
    assert findings(f"{text}  A = ASSERT[a]") == []


def test_an_asserted_situation_that_nothing_serves_is_doubtful() -> None:
    text = "P = ASSERT[fill]\nQ = SIT[fil]<k> :; SUCCEED[fil, k]"
    (found,) = findings(text, "unserved-situation")
    assert (found.severity, found.place.column, found.hint) == ("warning", 12, "did you mean fil?")
    assert messages("P = REASSERT[fill]", "unserved-situation") == [
        "situation fill is asserted but never served, nothing here waits for it with SIT[fill]"
    ]


def test_situations_handed_on_as_arguments_are_seen() -> None:
    text = "P = Serve[a] | ASSERT[a] | Raise[b]\nServe[s] = SIT[s] :; Act[1]\nRaise[s] = ASSERT[s]"
    assert places(text, "unserved-situation") == [(1, 34)]
    open_text = "Serve[s] = SIT[s] :; Act[1]\nP = ASSERT[anything]"
    assert findings(open_text, "unserved-situation") == []
