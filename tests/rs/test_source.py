"""Places: from offsets to lines and columns, and from places to lines."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from planner_reactor.errors import Diagnostic, Place
from planner_reactor.rs.source import LONGEST_LINE, Source


@given(st.text(alphabet="ab\n\té", max_size=40), st.data())
def test_a_place_leads_back_to_its_character(text: str, data: st.DataObject) -> None:
    offset = data.draw(st.integers(0, len(text)))
    place = Source(text).place(offset)
    lines = text.split("\n")
    assert sum(len(line) + 1 for line in lines[: place.line - 1]) + place.column - 1 == offset
    assert Source(text).line(place.line) == lines[place.line - 1]


def test_lines_end_before_their_line_break() -> None:
    source = Source("one\r\ntwo\n")
    assert [source.line(number) for number in range(5)] == ["", "one", "two", "", ""]


def test_findings_are_put_in_order_and_given_their_lines() -> None:
    found = [Diagnostic(Place(line, 1, file), "error", "c", "m") for line, file in [(2, "a"), (1, "b"), (1, "a")]]
    shown = Source("one\ntwo", "a").shown(found)
    assert [(f.place.file, f.place.line, f.line_text) for f in shown] == [
        ("a", 1, "one"),
        ("a", 2, "two"),
        ("b", 1, ""),
    ]


def test_a_line_is_cut_where_it_would_hide_the_message() -> None:
    source = Source("x" * 10_000)
    assert len(source.finding(0, "error", "c", "m").line_text) == LONGEST_LINE + 1
    assert source.finding(5_000, "error", "c", "m").line_text == ""
