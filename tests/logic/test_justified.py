"""A network that remembers why: the same relations, reasons that suffice, constraints that can be taken back."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from planner_reactor.logic.allen import ALL, relations
from planner_reactor.logic.chordal import Chordal, triangulated
from planner_reactor.logic.justified import Justified
from planner_reactor.logic.network import Network

Constraint = tuple[int, int, int]


@st.composite
def constraints(draw: st.DrawFn) -> list[Constraint]:
    pair = st.tuples(st.integers(0, 5), st.integers(0, 5)).filter(lambda p: p[0] != p[1])
    some = st.sets(st.sampled_from(range(13)), min_size=1, max_size=5)
    drawn = draw(st.lists(st.tuples(pair, some), min_size=1, max_size=10))
    return [(i, j, sum(1 << n for n in bases)) for (i, j), bases in drawn]


def justified(given: list[Constraint]) -> Justified:
    network = Justified()
    for i in range(6):
        network.add(i)
    all(network.constrain(i, j, relation, 1 << n) for n, (i, j, relation) in enumerate(given))
    return network


def plain(given: list[Constraint]) -> Network:
    network = Network()
    for i in range(6):
        network.add(i)
    network.extend(given)
    return network


@given(constraints())
def test_reasons_change_nothing_in_what_is_known(said: list[Constraint]) -> None:
    one, other = justified(said), plain(said)
    assert one.consistent == other.consistent
    assert not one.consistent or list(one.edges()) == list(other.edges())


@given(constraints())
def test_the_reasons_suffice(said: list[Constraint]) -> None:
    """The constraints that a pair names lead to what is known of it; those of a conflict to a contradiction."""
    network = justified(said)
    if not network.consistent:
        assert not plain([one for n, one in enumerate(said) if network.conflict >> n & 1]).consistent
        return
    for i, j, relation in network.edges():
        alone = plain([one for n, one in enumerate(said) if network.why(i, j) >> n & 1])
        assert alone.relation(i, j) == relation


@given(constraints(), st.data())
def test_taking_a_constraint_back_is_never_having_said_it(said: list[Constraint], data: st.DataObject) -> None:
    network = justified(said)
    gone = data.draw(st.integers(0, len(said) - 1))
    left = [(*one, 1 << n) for n, one in enumerate(said) if n != gone]
    again = plain([one for n, one in enumerate(said) if n != gone])
    if network.consistent:
        assert network.retract(1 << gone, left) == again.consistent
        assert list(network.edges()) == list(again.edges())


@given(constraints(), constraints())
def test_undo_returns_relations_and_reasons(said: list[Constraint], more: list[Constraint]) -> None:
    network = justified(said)
    if not network.consistent:
        return
    before = [(i, j, relation, network.why(i, j)) for i, j, relation in network.edges()]
    mark = network.mark()
    all(network.constrain(i, j, relation, 1 << 20) for i, j, relation in more)
    network.undo(mark)
    assert [(i, j, relation, network.why(i, j)) for i, j, relation in network.edges()] == before


@given(st.sets(st.tuples(st.integers(0, 7), st.integers(0, 7)).filter(lambda p: p[0] < p[1])))
def test_triangulation_leaves_no_long_circle_without_a_chord(pairs: set[tuple[int, int]]) -> None:
    """A graph is chordal if points whose neighbours all know each other can be taken away one by one."""
    chords = set(triangulated(pairs, 8))
    assert pairs <= chords
    near = {v: {a if b == v else b for a, b in chords if v in (a, b)} for v in range(8)}
    while near:
        simplicial = [v for v, n in near.items() if all((a, b) in chords for a in n for b in n if a < b)]
        assert simplicial
        del near[simplicial[0]]
        for others in near.values():
            others.discard(simplicial[0])


def test_a_chordal_network_knows_only_its_chords() -> None:
    network = Chordal([(0, 1), (1, 2)], 3)
    assert network.constrain(0, 1, relations(["b"]), 1)
    assert network.constrain(1, 2, relations(["b"]), 2)
    assert network.relation(0, 2) == ALL
    complete = Chordal([(0, 1), (1, 2), (0, 2)], 3)
    assert complete.constrain(0, 1, relations(["b"]), 1)
    assert complete.constrain(1, 2, relations(["b"]), 2)
    assert (complete.relation(0, 2), complete.why(0, 2)) == (relations(["b"]), 3)
