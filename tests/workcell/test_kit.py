"""Kit specifications: defaults, and errors that say where, what was expected, and the nearest name."""

from __future__ import annotations

from pathlib import Path

import pytest

from planner_reactor.errors import InputError
from planner_reactor.workcell.domains import contents_rule, with_kit
from planner_reactor.workcell.kit import SERVOMOTOR, kit_from, plain_kit, read_kit


def refused(text: str) -> str:
    with pytest.raises(InputError) as caught:
        kit_from(text, file="pump.toml")
    return str(caught.value)


def test_everything_but_the_kinds_has_a_default() -> None:
    kit = kit_from('[[part]]\nkind = "shaft"\n[[part]]\nkind = "seal"')
    assert kit.order == ("shaft", "seal")
    assert kit.by_kind["shaft"].wanted == "shaft"
    assert [part.slot for part in kit.parts] == [1, 2]
    assert kit.dwell_s == pytest.approx(3 * kit.parts[0].interval_s)


def test_all_that_can_be_said_is_read(tmp_path: Path) -> None:
    file = tmp_path / "pump.toml"
    file.write_text(
        'name = "pump"\norder = ["seal", "shaft"]\n[belt]\ninterval_s = 9\njitter = 0.1\ndwell_s = 33.0\n'
        '[trays]\nstock = 5\nplaces = 2\n[[part]]\nkind = "shaft"\nslot = 7\nquality = 0.9\n'
        'variants = ["sa", "sb", "sc"]\nwanted = "sb"\nsubstitutes = ["sa"]\nmix = { sc = 0.25 }\n'
        '[[part]]\nkind = "seal"\ninterval_s = 3.5\n',
        encoding="utf-8",
    )
    kit = read_kit(file)
    shaft, seal = kit.parts
    assert (kit.name, kit.priority["seal"], kit.trays, kit.places, kit.dwell_s) == ("pump", 0, 5, 2, 33.0)
    assert (shaft.accepted, shaft.misfits, shaft.mix, shaft.slot) == (
        ("sb", "sa"),
        ("sc",),
        (("sc", 0.25),),
        7,
    )
    assert (shaft.interval_s, seal.interval_s) == (9.0, 3.5)
    assert kit.kind_of["sc"] == "shaft"


def test_the_servomotor_is_the_product_of_the_papers() -> None:
    assert set(SERVOMOTOR.kinds) == {"cap", "motor", "body"}
    assert all(part.misfits for part in SERVOMOTOR.parts)


@pytest.mark.parametrize("kinds", [3, 100])
def test_kits_have_3_to_100_kinds(kinds: int) -> None:
    assert len(plain_kit(kinds).kinds) == kinds


def test_more_than_100_kinds_are_refused() -> None:
    rows = "".join(f'[[part]]\nkind = "k{n}"\n' for n in range(101))
    assert "101 part kinds, expected from 1 to 100" in refused(rows)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('[[part]]\nkind = "a"\n[[part]]\nkind = "b"\nwantd = "q"',
         "pump.toml:5:1: unknown key 'wantd' in [part], did you mean wanted?"),
        ('[[part]]\nkind = "a"\nvariants = ["red", "blue"]\nwanted = "blu"',
         "pump.toml:4:1: unknown wanted 'blu', did you mean blue?"),
        ('[[part]]\nkind = "a"\nvariants = ["red"]\nsubstitutes = ["rd"]',
         "pump.toml:4:1: 'rd' is not a variant, did you mean red?"),
        ('[[part]]\nkind = 3', "pump.toml:2:1: 'kind' is 3, expected a string"),
        ('[[part]]\nkind = "two words"', "cannot name a part kind"),
        ('[[part]]\nkind = "tray"', "cannot name a part kind"),
        ('[[part]]\nslot = 1', "a part without a kind"),
        ('[[part]]\nkind = "a"\n[[part]]\nkind = "a"',
         "pump.toml:3:1: 'a' names two things, already used by a"),
        ('[[part]]\nkind = "a"\nslot = 2\n[[part]]\nkind = "b"', "slot 2 is taken, by a"),
        ('order = ["b"]\n[[part]]\nkind = "a"', "pump.toml:1:1: 'b' in the order is no part kind"),
        ('order = []\n[[part]]\nkind = "a"', "the order lacks 'a'"),
        ('[[part]]\nkind = "a"\nquality = 2', "'quality' is 2.0, expected from 0 to 1"),
        ('[[part]]\nkind = "a"\nvariants = ["b", "c"]\nmix = { c = 1.5 }',
         "expected shares of 0 or more that sum to at most 1"),
        ('[belt]\ninterval = 3\n[[part]]\nkind = "a"',
         "unknown key 'interval' in [belt], did you mean interval_s?"),
        ("belt = 3\n[[part]]\nkind = 'a'", "expected a table [belt]"),
        ("name = 'x'", "no parts, expected a [[part]] table for each kind"),
        ("part = [3]", "no parts"),
        ("[[part]]\nkind = ", "pump.toml:2:8: Invalid value at the end of the file"),
    ],
)  # fmt: skip
def test_a_wrong_kit_is_refused_with_place_and_nearest_name(text: str, said: str) -> None:
    assert said in refused(text)


def test_the_wrong_line_is_shown_with_a_caret() -> None:
    assert refused('[[part]]\nkind = "a"\n  wantd = 1').endswith("\n      wantd = 1\n      ^")


def test_a_missing_file_is_an_input_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        read_kit(tmp_path / "none.toml")


def test_another_kit_gives_a_domain_another_contents_rule() -> None:
    kit = kit_from('[[part]]\nkind = "shaft"\n[[part]]\nkind = "seal"')
    rule = contents_rule(kit)
    assert rule == (
        "atp_rule forall t, x1, x2, i: Instance(shaft,x1) @ i and In(t,x1) @ i and Instance(seal,x2) @ i"
        " and In(t,x2) @ i => Contents(t) @ i;"
    )
    text = "a;\natp_rule forall t, i:\n  Instance(cap,x) @ i => Contents(t) @ i;\nb;"
    assert with_kit(text, kit) == f"a;\n{rule}\nb;"
    with pytest.raises(InputError, match="has 0"):
        with_kit("a; b;", kit)
