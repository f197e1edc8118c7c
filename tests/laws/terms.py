"""Random small terms to try the laws on, and the contexts that they are put into.

Terms are closed up to the port p and the basic processes a and b, each of which may end either way at any time. The
results of a term are named after the metavariable that it stands for, so that no two parts of a law bind the same.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable, Mapping, Sequence

from planner_reactor.rs.configurations import World
from planner_reactor.rs.terms import (
    ABORT,
    NIL,
    STOP,
    All,
    Call,
    Cond,
    Disable,
    If,
    Loop,
    Not,
    Number,
    Par,
    Process,
    Seq,
    Spawn,
    Symbol,
    Variable,
    cond,
    seq,
)
from planner_reactor.rs.vocabulary import BUILT_IN, Signature

BASIC = {n: Signature(n, (), ("x",), window=(0.0, float("inf"))) for n in "abc"}
WORLD = World(
    signatures={**BUILT_IN, **BASIC}, endings=lambda name, arguments: [(True, (1,)), (False, (0,))]
)
"""Basic processes stop with 1 and abort with 0, at any time."""

SIZES = {1: (1, 2, 2, 3), 2: (1, 1, 2), 3: (1, 1, 1, 1, 1, 1, 2)}
"""How many leaves a term may have, by how many terms there are: the more parts, the smaller."""

Scope = tuple[str, ...]
Instance = tuple[Mapping[str, Process], Callable[[Process], Process]]
"""Terms for the metavariables, and a context."""


def rebuilt(process: Process, leaf: Callable[[Call], Process]) -> Process:
    """The process with another in place of each call; sequences stay flat, as the parser makes them."""
    match process:
        case Call():
            return leaf(process)
        case Seq(parts):
            return seq(*(rebuilt(p, leaf) for p in parts))
        case Cond(parts):
            return cond(*(rebuilt(p, leaf) for p in parts))
        case Par(parts) | All(parts) | Disable(parts):
            return type(process)(tuple(rebuilt(p, leaf) for p in parts))
        case Not(body):
            return Not(rebuilt(body, leaf))
        case Loop(condition, body) | Spawn(condition, body):
            return type(process)(rebuilt(condition, leaf), rebuilt(body, leaf))
        case If(test, then, otherwise):
            return If(rebuilt(test, leaf), rebuilt(then, leaf), rebuilt(otherwise, leaf))


class Draw:
    """Random terms, from one seed."""

    def __init__(self, seed: str, *, timed: bool) -> None:
        self._random = random.Random(seed)
        self._timed = timed
        self._names = Counter[str]()

    def instance(self, names: Sequence[str], *, context: str, guarded: bool) -> Instance:
        """Terms for these of P, Q and R; at least one of them has a delay if time is to be seen."""
        sizes = SIZES[3 if context == "driven" else len(names)]
        while True:
            self._names = Counter[str]()
            terms = {}
            for name in names:
                terms[name] = self.term(self._random.choice(sizes), name.lower(), ())
            if context == "driven":
                terms["P"] = cond(Call("IN", (Symbol("d"),), ("d0",)), terms["P"])
            elif guarded:
                terms["P"] = cond(Call("a", (), ("a0",)), terms["P"])
            if not self._timed or "Delay" in repr(terms):
                return terms, self.context(context)

    def context(self, kind: str) -> Callable[[Process], Process]:
        """Something around a term, or nothing; `blind`: it reads no results of the term; `stable`: without `#`."""
        if kind == "driven":
            writes = seq(*(Call("OUT", (Symbol("d"), Number(n))) for n in (1, 2)))
            return lambda p: Par((p, writes))
        if self._random.random() < 0.6:
            return lambda p: p
        other = self.term(1, "t", ())
        after = self.term(1, "u", () if kind == "blind" else ("p1", "q1"))
        around: list[Callable[[Process], Process]] = [
            lambda p: seq(p, after),
            lambda p: cond(p, after),
            lambda p: seq(other, p),
            lambda p: cond(other, p),
            lambda p: Not(p),
            lambda p: Par((p, other)),
            lambda p: All((other, p)),
            lambda p: If(p, after, other),
            lambda p: Loop(Call("a", (), ("t0",)), p),
            lambda p: Loop(cond(Call("a", (), ("t0",)), p), other),
        ]
        if kind != "stable":
            around += [lambda p: Disable((p, other)), lambda p: Disable((other, p))]
        return self._random.choice(around)

    def term(self, size: int, prefix: str, scope: Scope) -> Process:
        """A term of so many leaves."""
        if size == 1:
            return Not(self.leaf(prefix, scope)) if self._random.random() < 0.15 else self.leaf(prefix, scope)
        left = self._random.randint(1, size - 1)
        kind = self._random.choice([";", ":", ";", ":", "|", "&", "#", "#", "~", ":;", "if"])
        if kind == "~":
            return Not(self.term(size, prefix, scope))
        first = self.term(left, prefix, scope)
        bound = (*scope, *_results(first)) if kind in (";", ":") else scope
        second = self.term(size - left, prefix, bound)
        match kind:
            case ";":
                return seq(first, second)
            case ":":
                return cond(first, second)
            case ":;":
                return Loop(self.basic(prefix), second)
            case "if":
                return If(first, second, self.leaf(prefix, scope))
            case _:
                return {"|": Par, "&": All, "#": Disable}[kind]((first, second))

    def leaf(self, prefix: str, scope: Scope) -> Process:
        kinds = ["a", "a", "STOP", "ABORT", "NIL", "IN", "OUT", *(["GTR", "GTR"] if scope else [])]
        kinds += ["Delay", "Delay"] if self._timed else []
        match self._random.choice(kinds):
            case "STOP":
                return STOP
            case "ABORT":
                return ABORT
            case "NIL":
                return NIL
            case "IN":
                return Call("IN", (Symbol("p"),), (self._name(prefix),))
            case "OUT":
                return Call("OUT", (Symbol("p"), Number(self._random.choice([0, 1]))))
            case "GTR":
                return Call("GTR", (Variable(self._random.choice(scope)), Number(0)))
            case "Delay":
                return Call("Delay", (Number(self._random.choice([1, 2])),))
            case _:
                return self.basic(prefix)

    def basic(self, prefix: str) -> Call:
        return Call(self._random.choice("ab"), (), (self._name(prefix),))

    def _name(self, prefix: str) -> str:
        self._names[prefix] += 1
        return f"{prefix}{self._names[prefix]}"


def _results(process: Process) -> Scope:
    match process:
        case Call(_, _, results):
            return results
        case _:
            return ()
