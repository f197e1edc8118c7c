"""Random terms of RS for property tests: expressions, processes with all operators, programs that pass all
checks.

Every strategy gives terms as the parser gives them: names bound, `;` and `:` flattened, no result bound twice
where it is in scope. Names never collide: variables are x1, x2, … and parameters a, b, …; symbols and ports
come from `SYMBOLS`. A term is read off a string of random bytes, its `Tape`: that is fast, and shrinks to
small terms. What stands at the leaves can be given: a function from the tape, the variables in scope and a
fresh name to a call.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

from hypothesis import strategies as st

from planner_reactor.rs.terms import (
    ABORT,
    NIL,
    STOP,
    All,
    Apply,
    Call,
    Cond,
    Disable,
    Expression,
    Head,
    If,
    Loop,
    Negative,
    Not,
    Number,
    Operation,
    Par,
    Parameter,
    Process,
    Program,
    Schema,
    Seq,
    Spawn,
    Symbol,
    Text,
    Variable,
    cond,
    seq,
)
from planner_reactor.rs.vocabulary import Signature

T = TypeVar("T")

SYMBOLS = ("p", "q", "red", "green", "north")
NUMBERS = (0, 1, 2, 3, 10, -1, -2, 0.5, 2.5, -0.25, 1e-7, 1e20, 123456789)
STRINGS = ("", "red", "two words", '"', "\\", "\n", "// not a comment", "é\u2028", "\x00\t")
FUNCTIONS = ("f", "g")
ARITHMETIC = ("+", "-", "*", "/")
COMPARISON = ("==", "/=", "<", "<=", ">", ">=")
OPERATORS: tuple[type[Process], ...] = (Seq, Cond, Par, All, Disable, Not, Loop, Spawn, If)

HOST = {
    "Act": Signature("Act", ("any",), window=(0.0, 2.0)),
    "Sense": Signature("Sense", (), ("x",), window=(0.5, 1.0)),
}
"""Basic processes that the leaves of `programs` use, beside built-in ones."""


class Tape:
    """A source of choices; when it has run out, the first option is always taken."""

    def __init__(self, content: bytes) -> None:
        self._rest = iter(content)

    def choose(self, options: Sequence[T]) -> T:
        return options[next(self._rest, 0) % len(options)]

    def expression(self, variables: Sequence[str], depth: int = 3) -> Expression:
        """Any expression over these variables."""
        form = self.choose(("atom", "atom", "operation", "negative", "apply")) if depth else "atom"
        if form == "atom":
            names = [Variable(name) for name in variables]
            atoms = (Number, *([Variable] if names else ()), Symbol, Text)
            match self.choose(atoms).__name__:
                case "Number":
                    return Number(self.choose(NUMBERS))
                case "Variable":
                    return self.choose(names)
                case "Symbol":
                    return Symbol(self.choose(SYMBOLS))
                case _:
                    return Text(self.choose(STRINGS))
        if form == "negative":
            return Negative(self.expression(variables, depth - 1))
        if form == "operation":
            sign = self.choose(ARITHMETIC + COMPARISON)
            return Operation(sign, self.expression(variables, depth - 1), self.expression(variables, depth - 1))
        return Apply(self.choose(FUNCTIONS), self.expressions(variables, depth - 1))

    def expressions(self, variables: Sequence[str], depth: int = 2) -> tuple[Expression, ...]:
        return tuple(self.expression(variables, depth) for _ in range(self.choose((0, 1, 1, 2, 3))))

    def number(self, variables: Sequence[str], depth: int = 1) -> Expression:
        """An expression that the checks take for a number."""
        form = self.choose(("number", "variable", "operation"))
        if form == "operation" and depth:
            sign = self.choose(("+", "-", "*"))
            return Operation(sign, self.number(variables, depth - 1), self.number(variables, depth - 1))
        if form == "variable" and variables:
            return Variable(self.choose(variables))
        return Number(self.choose(NUMBERS))


Scope = tuple[str, ...]
Leaf = Callable[[Tape, Scope, str], Call]
"""From a tape, the variables in scope and a name that it may bind, to a call."""


def any_call(tape: Tape, scope: Scope, fresh: str) -> Call:
    """A call of any name with any arguments: right in form, wrong in every other way."""
    name = tape.choose(("STOP", "ABORT", "NIL", "Act", "Sense", "IN", "SIT", "E", "Äkt_2"))
    results: tuple[Scope, ...] = ((), (fresh,), (fresh, f"{fresh}_"))
    return Call(name, tape.expressions(scope), tape.choose(results))


def step(tape: Tape, scope: Scope, fresh: str) -> Call:
    """A call that takes a step and is right in every way: a test, a delay, a port, a process of `HOST`."""
    bound = tape.choose(((), (fresh,)))
    match tape.choose(("Act", "test", "Delay", "IN", "OUT", "Sense")):
        case "test":
            tests = ("GTR", "LST", "Equal")
            return Call(tape.choose(tests), (tape.number(scope), tape.number(scope)))
        case "Delay":
            return Call("Delay", (Number(tape.choose((0, 1, 2, 0.5))),))
        case "IN":
            return Call("IN", (Symbol(tape.choose(SYMBOLS)),), bound)
        case "OUT":
            return Call("OUT", (Symbol(tape.choose(SYMBOLS)), tape.number(scope)))
        case "Sense":
            return Call("Sense", (), bound)
        case _:
            return Call("Act", (tape.number(scope),))


def sound_leaf(tape: Tape, scope: Scope, fresh: str) -> Call:
    """A `step`, or an end at once, or none ever."""
    end = tape.choose((None, None, None, STOP, ABORT, NIL))
    return step(tape, scope, fresh) if end is None else end


def expressions(variables: Sequence[str] = (), *, depth: int = 4) -> st.SearchStrategy[Expression]:
    """Expressions of every form over these variables."""
    return tapes().map(lambda tape: tape.expression(variables, depth))


def processes(
    *,
    bound: Sequence[str] = (),
    depth: int = 3,
    operators: tuple[type[Process], ...] = OPERATORS,
    leaf: Leaf = any_call,
    guarded: bool = False,
) -> st.SearchStrategy[Process]:
    """Processes in which the names `bound` are variables; with `guarded` no loop goes round without a
    step."""

    def grown(tape: Tape) -> Process:
        process, _ = _Growth(tape, operators, leaf, guarded).process(tuple(bound), depth)
        return process

    return tapes().map(grown)


def programs(*, depth: int = 3, operators: tuple[type[Process], ...] = OPERATORS) -> st.SearchStrategy[Program]:
    """Programs without static errors under the signatures of `HOST`: definitions D1, D2, … that call later
    ones; some are clauses told apart by their first argument."""

    def grown(tape: Tape) -> Program:
        names = ((), ("a",), ("a", "b"))
        heads = [(tape.choose(names), tape.choose((1, 1, 2))) for _ in range(tape.choose((1, 2, 3, 4)))]
        schemas = []
        for number, (parameters, clauses) in enumerate(heads, 1):
            for clause in range(clauses):
                head: tuple[Head, ...] = tuple(map(Parameter, parameters))
                growth = _Growth(tape, operators, _calling(heads, number), guarded=True)
                body, _ = growth.process(parameters, depth)
                head = (Number(clause), *head) if clauses > 1 else head
                schemas.append(Schema(f"D{number}", head, (), body))
        return Program(schemas)

    return tapes(least=100).map(grown)


def tapes(*, least: int = 20) -> st.SearchStrategy[Tape]:
    """Tapes of at least so many choices."""
    return st.binary(min_size=least, max_size=400).map(Tape)


def _calling(heads: Sequence[tuple[Scope, int]], number: int) -> Leaf:
    """Leaves of definition `number`: sound ones, and calls of later definitions."""

    def leaf(tape: Tape, scope: Scope, fresh: str) -> Call:
        later = tape.choose((0, 0, *range(number + 1, len(heads) + 1)))
        if not later:
            return sound_leaf(tape, scope, fresh)
        parameters, clauses = heads[later - 1]
        given = tuple(tape.number(scope) for _ in parameters)
        clause = (Number(tape.choose(range(clauses))),) if clauses > 1 else ()
        return Call(f"D{later}", (*clause, *given))

    return leaf


class _Growth:
    """Grows one process from a tape."""

    def __init__(self, tape: Tape, operators: tuple[type[Process], ...], leaf: Leaf, guarded: bool) -> None:
        self._tape = tape
        self._operators = operators
        self._leaf = leaf
        self._guarded = guarded
        self._count = 0

    def process(self, scope: Scope, depth: int) -> tuple[Process, Scope]:
        """A process, and the names that it binds for what follows it."""
        operator = self._tape.choose((Call, *self._operators, Call)) if depth else Call
        if operator is Call:
            return self._call(scope, self._leaf)
        if operator in (Seq, Cond):
            return self._sequence(operator, scope, depth)
        if operator in (Par, All, Disable):
            grown = [self.process(scope, depth - 1) for _ in range(self._tape.choose((2, 3)))]
            return operator(tuple(p for p, _ in grown)), tuple(n for _, bound in grown for n in bound)
        if operator is Not:
            inner, bound = self.process(scope, depth - 1)
            return Not(inner), bound
        if operator in (Loop, Spawn):
            condition, bound = self._condition(scope, depth - 1)
            body, _ = self.process((*scope, *bound), depth - 1)
            return operator(condition, body), bound
        return self._branches(scope, depth)

    def _call(self, scope: Scope, leaf: Leaf) -> tuple[Process, Scope]:
        self._count += 1
        call = leaf(self._tape, scope, f"x{self._count}")
        return call, call.results

    def _sequence(self, operator: type[Process], scope: Scope, depth: int) -> tuple[Process, Scope]:
        parts: list[Process] = []
        bound: Scope = ()
        for _ in range(self._tape.choose((2, 3))):
            part, more = self.process((*scope, *bound), depth - 1)
            parts.append(part)
            bound += more
        return (seq if operator is Seq else cond)(*parts), bound

    def _condition(self, scope: Scope, depth: int) -> tuple[Process, Scope]:
        """The condition of a loop; a guarded one takes a step before it ends."""
        if not self._guarded:
            return self.process(scope, depth)
        first, bound = self._call(scope, step)
        rest, more = self.process((*scope, *bound), depth)
        return seq(first, rest), (*bound, *more)

    def _branches(self, scope: Scope, depth: int) -> tuple[Process, Scope]:
        """An `if`, of which the branches may bind the same names."""
        test, bound = self.process(scope, depth - 1)
        before = self._count
        then, of_then = self.process((*scope, *bound), depth - 1)
        after, self._count = self._count, before
        otherwise, of_otherwise = self.process((*scope, *bound), depth - 1)
        self._count = max(self._count, after)
        return If(test, then, otherwise), tuple(dict.fromkeys((*bound, *of_then, *of_otherwise)))
