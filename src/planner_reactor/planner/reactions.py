"""The text of a situation: from its refinement to a reaction in RS (R §8.3).

    SIT[s]<k, x1, …> :; (~(body : SUCCEED[s, k]) : FAIL[s, k])

Results go back by `(UPDATE[s, k, x] ; SUCCEED[s, k])`; sub-situations are asserted until they succeed.
Where something must be cleaned up if the rest of the body fails, the rest stands in `if rest then … else
(cleanup ; ABORT)`. A situation that is not refined yet has a stub. Where several instances of a situation
may be on at once its loop is `::`, so that each is served. Names: `k` is the instance, `x1` to `xn` the
arguments that are no constants, then the results in the order of the text.
"""

from __future__ import annotations

import re
from typing import Protocol

from planner_reactor.logic.formulas import Numeral, Term
from planner_reactor.planner.inlining import Inliner
from planner_reactor.planner.plan import Parameter, Result
from planner_reactor.planner.situations import Composition, Situation, situation_of
from planner_reactor.planner.structure import (
    Action,
    Choice,
    During,
    InOrder,
    Meanwhile,
    Run,
    Together,
    Tree,
    actions_of,
)
from planner_reactor.rs.terms import (
    ABORT,
    STOP,
    All,
    Call,
    Cond,
    Disable,
    Expression,
    If,
    Loop,
    Not,
    Number,
    Par,
    Process,
    Seq,
    Spawn,
    Symbol,
    Text,
    Variable,
    cond,
)

REACTION = "P"
"""The schema of which every reaction is a clause `P[n] = …`."""
INSTANCE = "k"
ROUND = 2
"""Seconds after which what is kept at all times is asked for anew, so that it can be adapted meanwhile."""
_OWN = re.compile(r"k|[xv]\d+")
_NAME = re.compile(r"[A-Za-z_]\w*")


class Names(dict[Situation, str]):
    """A `Lettering`: a name of its own for every situation, the action's, then its constants (`Tend`, `fern` →
    `TendFern`).
    """

    def __init__(self) -> None:
        super().__init__()
        self._situations: dict[str, Situation] = {}

    def named(self, name: str) -> Situation | None:
        """The situation that was given this name."""
        return self._situations.get(name)

    def situation(self, situation: Situation) -> Symbol:
        """Its name as it stands in a text."""
        return Symbol(self[situation])

    def constant(self, term: Term) -> Expression:
        """A constant as it stands in a text."""
        return constant(term)

    def __missing__(self, situation: Situation) -> str:
        parts = [str(a) for a in situation.arguments if a is not None]
        wanted = situation.schema + "".join(part[:1].upper() + part[1:] for part in parts)
        wanted = name = re.sub(r"\W", "_", wanted)
        count = 1
        while name in self._situations:
            count += 1
            name = f"{wanted}_{count}"
        self._situations[name] = situation
        self[situation] = name
        return name


class Lettering(Protocol):
    """What stands for the names of situations and for constants."""

    def situation(self, situation: Situation) -> Symbol: ...

    def constant(self, term: Term) -> Expression: ...


def reaction(situation: Situation, composition: Composition, lettering: Lettering, *, fold: bool) -> Process:
    """The reaction of a refined situation."""
    return _Writing(situation, composition, lettering, fold).reaction(composition.tree)


def names_of(situation: Situation, composition: Composition, *, fold: bool) -> dict[Term, str]:
    """What the reaction calls its parameters and results."""
    return _Writing(situation, composition, Names(), fold).names(composition.tree)


def stub(situation: Situation, lettering: Lettering, period_ms: int) -> Process:
    """The reaction of a situation that is not refined yet: it tells the planner, waits and fails (P4
    of R §8.3).
    """
    name = lettering.situation(situation)
    parameters = [f"x{n + 1}" for n in range(situation.arguments.count(None))]
    waiting = Cond((Call("STUB", (name,)), Call("SUSPEND", (Number(period_ms),))))
    body = Seq((waiting, Call("FAIL", (name, Variable(INSTANCE)))))
    return Loop(Call("SIT", (name,), (INSTANCE, *parameters)), body)


def root(situation: Situation, names: Names, instead: tuple[Situation, ...] = ()) -> Process:
    """`STOP :; ASSERT[s]`: the goal, asserted for ever (P0).

    Instead of others it is `DISABLED[t] :; ASSERT[s]`, with `#` between several: while one of them is disabled.
    """
    disabled = tuple(Call("DISABLED", (Symbol(names[other]),)) for other in instead)
    condition = Disable(disabled) if len(disabled) > 1 else disabled[0] if disabled else STOP
    return Loop(condition, Call("ASSERT", (Symbol(names[situation]),)))


def monitor(kind: str, assumption: str, period_ms: int) -> Process:
    """`ASSUMONITOR[a, ms]` or `HOLDMONITOR[a, ms]`."""
    return Call(kind, (constant(assumption), Number(period_ms)))


def request(action: Action, predicate: str, arguments: tuple[Term, ...]) -> Process:
    """A perception request: run the sensing action, report what it says of the condition."""
    about = (constant(predicate), *(constant(a) for a in arguments))
    told = Call(_process_name(action.name), tuple(constant(a) for a in action.arguments))
    return If(told, Call("REPORT", (*about, Symbol("holds"))), Call("REPORT", (*about, Symbol("fails"))))


def clause(label: int, text: str) -> str:
    """`P[n] = …` as text."""
    return f"{REACTION}[{label}] = {text}"


class _Writing:
    """Writes one refinement; gives names to what is handed on."""

    def __init__(self, situation: Situation, composition: Composition, lettering: Lettering, fold: bool) -> None:
        self._situation = situation
        self._composition = composition
        self._lettering = lettering
        self._fold = fold
        self._variables: dict[Term, str] = {}
        self._ports: set[Term] = set()  # results that are handed on while the action lasts
        self._inliner = Inliner()
        for number, argument in enumerate(situation.arguments):
            if argument is None:
                self._variables[Parameter(number)] = f"x{len(self._variables) + 1}"
        self._parameters = tuple(self._variables.values())

    def reaction(self, tree: Tree) -> Process:
        name = self._lettering.situation(self._situation)
        self._name_results(tree)
        instance = Variable(INSTANCE)
        success: Process = Call("SUCCEED", (name, instance))
        if self._composition.outputs[0]:
            outputs = tuple(self._expression(term) for term in self._composition.outputs[0])
            success = Seq((Call("UPDATE", (name, instance, *outputs)), success))
        body = Cond((Not(self._body(tree, success)), Call("FAIL", (name, instance))))
        head = Call("SIT", (name,), (INSTANCE, *self._parameters))
        several = None in self._situation.arguments and not self._fold
        return Spawn(head, body) if several else Loop(head, body)

    def names(self, tree: Tree) -> dict[Term, str]:
        self._name_results(tree)
        return dict(self._variables)

    def _name_results(self, tree: Tree) -> None:
        """Number the results in the order of the text; an output has one name, whichever branch it
        comes from.
        """
        same: dict[Term, Term] = {}
        for outputs in self._composition.outputs[1:]:
            for first, other in zip(self._composition.outputs[0], outputs, strict=True):
                if isinstance(other, Result):
                    same[other] = first
        for action in actions_of(tree):
            for result in action.results:
                leader = same.get(result, result)
                name = self._variables.setdefault(leader, f"x{len(set(self._variables.values())) + 1}")
                self._variables[result] = name
                if action.process:
                    self._ports.add(result)

    def _body(self, tree: Tree, success: Process) -> Process:
        """The composition, then `success`; from what upsets something on, a failure is cleaned up after."""
        parts = list(tree.parts) if isinstance(tree, InOrder) else [tree]
        upsets = self._composition.upsets
        at = next((n for n, part in enumerate(parts) if not upsets.isdisjoint(actions_of(part))), len(parts))
        if at < len(parts):
            part = parts[at]
            if isinstance(part, Choice) and at == len(parts) - 1 and part.test not in upsets:
                then, otherwise = self._body(part.then, success), self._body(part.otherwise, success)
                return cond(*map(self._process, parts[:at]), If(self._call(part.test), then, otherwise))
            if isinstance(part, Run) and not part.action.abstract:
                at += 1  # it did what it had to, so only the rest can fail
        if at == len(parts):
            return cond(*map(self._process, parts), success)
        cleanup = Seq((*(self._call(action) for action in self._composition.cleanup), ABORT))
        rest = If(cond(*map(self._process, parts[at:])), success, cleanup)
        return cond(*map(self._process, parts[:at]), rest)

    def _process(self, tree: Tree) -> Process:
        match tree:
            case Run(action):
                return self._call(action)
            case InOrder(()):
                return STOP
            case InOrder(parts):
                return cond(*(self._process(part) for part in parts))
            case Together(parts):
                return All(tuple(self._process(part) for part in parts))
            case During(action, inner) if action.process:
                return _until(self._process(inner), (self._call(action),))
            case During(action, inner):
                return Disable((self._call(action), self._process(inner)))
            case Meanwhile(actions, InOrder(())):
                return _until(Call("Delay", (Number(ROUND),)), tuple(map(self._call, actions)))
            case Meanwhile(actions, inner):
                return _until(self._process(inner), tuple(map(self._call, actions)))
            case Choice(test, then, otherwise):
                return If(self._call(test), self._process(then), self._process(otherwise))

    def _call(self, action: Action) -> Process:
        if action.process:
            ports = tuple(map(self._expression, (*action.arguments, *action.results)))
            process = self._inliner.process(action.process, ports)
            if action.most is None:
                return process
            late = Cond((Call("Delay", (Number(action.most / 1000),)), ABORT))
            return _until(process, (late,))
        results = tuple(self._variables[result] for result in action.results)
        if not action.abstract:
            arguments = tuple(self._expression(term) for term in action.arguments)
            return Call(_process_name(action.name), arguments, results)
        situation = situation_of(action, fold=self._fold)
        given = [
            self._expression(term)
            for term, folded in zip(action.arguments, situation.arguments, strict=True)
            if folded is None
        ]
        return Call("REASSERT", (self._lettering.situation(situation), *given), results)

    def _expression(self, term: Term) -> Expression:
        name = self._variables.get(term)
        if term in self._ports:
            return Symbol(f"{self._lettering.situation(self._situation).name}_{name}")
        return Variable(name) if name is not None else self._lettering.constant(term)


def _until(process: Process, others: tuple[Process, ...]) -> Process:
    """The process beside the others, which go on side by side, until it has ended."""
    if not others:
        return process
    first = process.parts if isinstance(process, Disable) else (process,)
    return Disable((*first, others[0] if len(others) == 1 else Par(others)))


def constant(term: Term) -> Expression:
    """A constant as a symbol, or quoted where a symbol would be read as something else."""
    if isinstance(term, Numeral):
        return Number(term.value)
    text = str(term)
    return Symbol(text) if _NAME.fullmatch(text) and not _OWN.fullmatch(text) else Text(text)


def _process_name(name: str) -> str:
    return re.sub(r"\W", "_", name)
