"""Compiled expressions mean what `rs.expressions.evaluate` says they mean."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from planner_reactor.rs.expressions import EvaluationError, evaluate
from planner_reactor.rs.terms import Apply, Expression, Negative, Number, Operation, Symbol, Text, Variable
from planner_reactor.runtime.strands import UNBOUND
from planner_reactor.runtime.values import frames, reader, tuples

FUNCTIONS = {"half": lambda x: x / 2}
NAMES = ("a", "b", "c", "nowhere")

leaves = (
    st.builds(Number, st.integers(-3, 3) | st.floats(-2, 2) | st.just(2**255))
    | st.builds(Variable, st.sampled_from(NAMES))
    | st.builds(Symbol, st.sampled_from("ab"))
    | st.builds(Text, st.sampled_from("ab"))
)
expressions: st.SearchStrategy[Expression] = st.recursive(
    leaves,
    lambda inner: (
        st.builds(Operation, st.sampled_from(["+", "-", "*", "/", "==", "/=", "<", "<=", ">", ">="]), inner, inner)
        | st.builds(Negative, inner)
        | st.builds(Apply, st.sampled_from(["half", "unknown"]), st.tuples(inner))
    ),
    max_leaves=5,
)
values = st.integers(-5, 5) | st.just(2**255) | st.floats(-1, 1) | st.booleans() | st.sampled_from(["a", "b"])


def slot(name: str) -> int:
    return NAMES.index(name) if name != "nowhere" else -1


def outcome(ask: object) -> object:
    try:
        return ask()  # type: ignore[operator]
    except EvaluationError as problem:
        return type(problem)


@given(st.lists(expressions, max_size=3), st.lists(values | st.just(UNBOUND), min_size=3, max_size=3))
def test_closures_agree_with_evaluate(terms: list[Expression], frame: list[object]) -> None:
    bound = {name: value for name, value in zip(NAMES, frame, strict=False) if value is not UNBOUND}
    expected = [outcome(lambda t=t: evaluate(t, bound, FUNCTIONS)) for t in terms]
    assert [outcome(lambda t=t: reader(t, slot, FUNCTIONS)(frame)) for t in terms] == expected
    wrong = [e for e in expected if isinstance(e, type)]
    together = outcome(lambda: tuples(tuple(terms), slot, FUNCTIONS)(frame))
    assert together == (wrong[0] if wrong else tuple(expected))
    assert outcome(lambda: frames(tuple(terms), slot, FUNCTIONS)(frame)) == (wrong[0] if wrong else expected)
