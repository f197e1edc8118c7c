"""Domains from text: the papers' notation and ours beside it, and what each fault says."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner_reactor.errors import DomainError
from planner_reactor.logic.allen import NAMED, relations
from planner_reactor.logic.domain import AT_START, MEETS, Domain
from planner_reactor.logic.formulas import Atom, Numeral
from planner_reactor.logic.reader import check_domain, read_domain

NOTATION = Path(__file__).with_name("notation.itl")
"""The domain of a derivation that was tried before: a file written in its notation must load."""

SCHEMA = """
atp_actionschema Act <x><y>
intervals i1, i2;
    executability: Before(x) @ i1 and ITL(i1, encompasses, Act);
    effects:       After(x, y) @ i2 and ITL(Act, meets, i2);
endactionschema
"""
REST = """
atp_fact Before(a);
atp_goal Goal Exists i, y: After(a, y) @ i;
"""


def only_error(text: str) -> str:
    with pytest.raises(DomainError) as caught:
        read_domain(text, file="d.itl")
    return str(caught.value)


def test_the_notation_of_the_tried_derivation_loads() -> None:
    domain = read_domain(NOTATION)
    assert list(domain.assumptions) == ["AQ", "AS", "AF", "ACT", "ACP", "ADT", "AM", "ADD", "AO"]
    assert domain.assumptions["AM"].monitor == "reaction"
    assert domain.assumptions["ADD"].reinstatable
    assert len(domain.schemas) == 22
    assert check_domain(NOTATION.read_text(), file="notation.itl")[0].code == "unused-interval"


def test_intervals_become_relations() -> None:
    act = read_domain(SCHEMA + REST).schemas["Act"]
    assert act.executability[0].relation == NAMED["encompasses"]
    assert act.effects[0].relation == MEETS
    assert (act.inputs, act.outputs, act.abstract) == ((0,), (1,), False)


def test_an_interval_may_be_related_through_another() -> None:
    text = SCHEMA.replace("i1, i2", "i1, i2, i3").replace(
        "ITL(i1, encompasses, Act)", "ITL(i1, finishes, i3) and ITL(i3, meets, Act)"
    )
    assert read_domain(text + REST).schemas["Act"].executability[0].relation == relations(["m"])


def test_without_constraints_a_condition_holds_at_the_start_and_an_effect_from_the_end() -> None:
    text = SCHEMA.replace(" and ITL(i1, encompasses, Act)", "").replace(" and ITL(Act, meets, i2)", "")
    act = read_domain(text + REST).schemas["Act"]
    assert act.executability[0].relation == AT_START
    assert act.effects[0].relation == MEETS


def test_an_effect_may_hold_while_the_action_runs() -> None:
    """X §4.2: `ObjectPosition(outport) @ LOOK`."""
    text = SCHEMA.replace("After(x, y) @ i2 and ITL(Act, meets, i2)", "After(x, y) @ Act")
    assert read_domain(text + REST).schemas["Act"].effects[0].relation == NAMED["equal"]


def test_action_schemas_as_the_second_paper_prints_them() -> None:
    """X §6.3: generated schemas, with hyphens in names and without semicolons."""
    text = """
    atp_actionschema camera-55 Input: [m1] Output: []
    Intervals: [int-camera-55, int-54]
    Executability:
        objectposition(m1) @ int-54 and ITL(int-54, [si,e,di,fi], camera-55)
    Effects:
        cameraposition(m1) @ camera-55 and objectinview(m1) @ camera-55
    endactionschema camera-55
    atp_fact objectposition(p);
    """
    camera = read_domain(text).schemas["camera-55"]
    assert camera.inputs == (0,)
    assert [e.atom.predicate for e in camera.effects] == ["cameraposition", "objectinview"]


def test_a_definition_is_used_from_right_to_left() -> None:
    """R (14): the interval of a group in brackets is that of each of its parts."""
    text = """
    atp_rule forall t, i: Full(t) @ i <=> Exists x: [Is(cap, x) and In(t, x)] @ i;
    atp_fact Is(cap, c) and In(box, c);
    """
    (rule,) = read_domain(text).rules
    assert rule.head == Atom("Full", (0,))
    assert [c.atom for c in rule.body] == [Atom("Is", ("cap", 1)), Atom("In", (0, 1))]
    assert all(c.relation == NAMED["equal"] for c in rule.body)


def test_assumptions_are_set_apart_in_rules() -> None:
    text = "atp_assumption A(k); atp_rule forall x, i, j: A(x) @ j and P(x) @ i => Q(x) @ i; atp_fact P(a);"
    (rule,) = read_domain(text).rules
    assert rule.assumptions == (Atom("A", (0,)),)
    assert [c.atom for c in rule.body] == [Atom("P", (0,))]


def test_an_exclusion_names_what_never_holds_together() -> None:
    domain = read_domain(NOTATION)
    position, held = domain.exclusions
    assert position.distinct == ((1, 2),)
    assert (held.first, held.second) == (Atom("Held", (0,)), Atom("Free", ("arm",)))


def test_numbers_are_constants() -> None:
    assert read_domain("atp_fact At(box, 3) and At(lid, 2.5);").facts["At"][0] == Atom("At", ("box", Numeral(3)))


def test_names_in_a_persistence_are_variables_unless_used_as_constants() -> None:
    domain = read_domain("atp_assumption A(); atp_persistence At(x, home) while A(); atp_fact At(box, home);")
    assert domain.persistences["At"][0].atom == Atom("At", (0, "home"))


def test_a_file_or_a_text_can_be_read(tmp_path: Path) -> None:
    path = tmp_path / "d.itl"
    path.write_text(SCHEMA + REST)
    for source in (path, str(path), SCHEMA + REST):
        assert isinstance(read_domain(source), Domain)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (
            SCHEMA.replace("@ i1", "@ i9") + REST,
            "d.itl:4:32: the interval i9 is not declared, known here: time, i1, i2",
        ),
        (SCHEMA.replace("Before(x)", "Befor(x)") + REST, "nothing brings about Befor"),
        (SCHEMA.replace("encompasses", "encompases") + REST, "did you mean encompasses?"),
        (SCHEMA.replace("[", "").replace("meets", "[m q]") + REST, "q is not a relation between intervals"),
        (SCHEMA.replace("executability:", "executabilty:") + REST, "did you mean executability?"),
        (SCHEMA + SCHEMA + REST, "the action schema Act has the name of the action schema in line 2"),
        (SCHEMA + REST + "atp_fact Before(a, b);", "Before with 2 arguments, expected 1, as in line 4"),
        (SCHEMA.replace("<x><y>", "<x><x>") + REST, "x is declared twice"),
        (SCHEMA.replace("i1, i2;", "i1, i1;") + REST, "i1 is declared twice"),
        (SCHEMA.replace("encompasses, Act)", "meets, Act) and ITL(i1, after, Act)") + REST, "contradict each other"),
        (SCHEMA.replace("Before(x)", "Before(i1)") + REST, "the interval i1 stands as an argument"),
        (SCHEMA.replace("endactionschema", "") + REST, "expected endactionschema before the next sentence"),
        (SCHEMA.replace("After(x, y) @", "After(x y) @") + REST, "unexpected y, expected , or )"),
        (REST.replace("atp_goal Goal", "atp_goal"), "unexpected ,, expected ("),
        ("atp_asumption A();", "did you mean atp_assumption?"),
        ("atp_assumption A() likelihood 1.5;", "a likelihood of 1.5, expected 0 to 1"),
        ("atp_assumption A() monitor flag 0;", "a period of 0 ms"),
        ("atp_assumption A() monitor poll;", "expected flag MILLISECONDS or reaction"),
        ("atp_assumption A(); atp_assumption A();", "has the name of the assumption"),
        ("atp_persistence P(x) while B();", "B is not an assumption"),
        ("atp_assumption ADT(); atp_persistence P(x) while AD();", "AD is not an assumption, did you mean ADT?"),
        ("atp_assumption A(); atp_fact A();", "the assumption A cannot be a fact"),
        ("atp_assumption A(); atp_rule forall i: P(a) @ i => A() @ i; atp_fact P(a);", "A cannot follow from a rule"),
        ("atp_assumption A(k); atp_rule forall i: A() @ i => P(a) @ i;", "expected 1, as the assumption declares"),
        ("atp_rule forall i, j: P(a) @ i and Q(a) @ j => ITL(i, meets, j);", "expected disjunct"),
        ("atp_rule forall i: P(a) @ i => Q(a) @ j; atp_fact P(a);", "the interval j is not declared"),
        ("atp_rule forall i, j, k: P(a) @ i and Q(a) @ j => ITL(i, disjunct, k);", "nothing in the rule holds over k"),
        ("atp_fact Exists x: P(x);", "Exists in a fact"),
        ("atp_fact P(a)", "unexpected the end of the text, expected ;"),
        ("atp_fact P($);", "'$' has no meaning in a domain"),
        ("# a comment", "comments begin with //"),
    ],
)
def test_a_fault_has_its_place_its_cause_and_what_was_expected(text: str, says: str) -> None:
    message = only_error(text)
    assert says in message
    assert message.startswith("d.itl:")
    assert "^" in message


def test_several_faults_are_found_in_one_reading() -> None:
    faults = check_domain("atp_fact P(;\natp_fact Q(a, ;\n" + SCHEMA + "atp_goal G Exists i: Nowhere(a) @ i")
    assert [(f.place.line, f.severity) for f in faults][:2] == [(1, "error"), (2, "error")]


def test_what_is_odd_is_a_warning() -> None:
    codes = {f.code: f.severity for f in check_domain(SCHEMA + "atp_assumption A();\natp_fact Before(xx);")}
    assert codes == {"unused-assumption": "warning", "no-goal": "warning"}
    slip = SCHEMA.replace("Before(x)", "Before(xx)")
    assert "lone-constant" in {f.code for f in check_domain(slip + REST)}


def test_a_bomb_is_refused() -> None:
    for bomb in (
        "(" * 200_000,
        "atp_fact " + "(" * 200_000,
        "atp_rule " + "[" * 100_000 + "P(a)",
        "a " * 5_000_000,
        ")" * 5000 + "atp_rule " + "(" * 5000,
    ):
        only_error(bomb)


@settings(max_examples=150)
@given(st.integers(0, 10_000), st.integers(0, 400), st.text("atp_ ()[]<>@;,:=i1xABC/\n", max_size=12))
def test_a_damaged_domain_raises_nothing_but_domain_errors(start: int, length: int, patch: str) -> None:
    text = NOTATION.read_text()[:6000]
    start %= len(text)
    damaged = text[:start] + patch + text[start + length :]
    with suppress(DomainError):
        read_domain(damaged)
