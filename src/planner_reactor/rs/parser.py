"""Reads RS: text to terms, with places, and with errors that say what was expected.

Operator precedence after Pratt: one loop reads all operators on processes by their strengths in `grammar`;
what stands in brackets is read by `arguments`. `parse_program` and `parse_process` then bind names (`scope`)
and raise `RSError`; whether processes exist and are called rightly is for `checks`. After an error reading
goes on at the next line that begins a definition, so that one look at a text shows several. Budgets
(`tokens`) keep hostile texts cheap.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from planner_reactor.errors import Diagnostic, RSError
from planner_reactor.rs import scope
from planner_reactor.rs.arguments import read_arguments, read_head, read_results
from planner_reactor.rs.grammar import INFIX, Operator
from planner_reactor.rs.source import Source
from planner_reactor.rs.terms import (
    All,
    Call,
    Cond,
    Disable,
    If,
    Loop,
    Not,
    Par,
    Process,
    Program,
    Schema,
    Seq,
    Spawn,
    cond,
    seq,
)
from planner_reactor.rs.tokens import BUDGETS, EXCEEDED, Budgets, Cursor

AFTER = {
    ")": "no parenthesis is open here",
    "]": "no bracket is open here",
    "then": "no `if` is open here",
    "else": "no `if` is open here",
    ",": "processes are composed by `;` `:` `|` `&` `#` `:;` `::`",
}

MIXED = (
    "`:` and `;` are mixed without parentheses",
    "`:` binds tighter: A:B;C is (A:B);C, and A;B:C is A;(B:C)",
)

BUILD: Mapping[str, Callable[[list[Process]], Process]] = {
    "|": lambda parts: Par(tuple(parts)),
    "&": lambda parts: All(tuple(parts)),
    "#": lambda parts: Disable(tuple(parts)),
    ";": lambda parts: seq(*parts),
    ":": lambda parts: cond(*parts),
    ":;": lambda parts: Loop(*parts),
    "::": lambda parts: Spawn(*parts),
}
"""From an operator and its operands to a term, flattened as `terms` has it."""


def parse_program(text: str, *, file: str = "<text>", budgets: Budgets = BUDGETS) -> Program:
    """The definitions in `text`, names bound; raises `RSError` with every error found."""
    program, findings = read_program(text, file=file, budgets=budgets)
    errors = [f for f in findings if f.severity == "error"]
    if errors:
        raise RSError(errors)
    return program


def parse_process(text: str, *, bound: Iterable[str] = (), file: str = "<text>", budgets: Budgets = BUDGETS) -> Process:
    """One process; the names in `bound` are variables. Raises `RSError`."""
    source = Source(text, file)
    parser = _Parser(source, budgets)
    process, findings = scope.resolve_process(parser.lone_process(), bound=bound, depth=budgets.depth)
    if findings:
        raise RSError(source.shown(findings))
    return process


def read_program(
    text: str, *, file: str = "<text>", budgets: Budgets = BUDGETS
) -> tuple[Program, tuple[Diagnostic, ...]]:
    """The definitions that could be read, and all findings, warnings included, in the order of the text."""
    source = Source(text, file)
    try:
        parser = _Parser(source, budgets)
    except RSError as error:
        return Program(), error.diagnostics
    schemas, findings = parser.definitions()
    bound = []
    for schema in schemas:
        resolved, wrong = scope.resolve(schema, depth=budgets.depth)
        bound.append(resolved)
        findings.extend(wrong)
    return Program(bound), source.shown(findings)


class _Parser:
    """Reads processes and definitions. A level of nesting is at most two calls of Python."""

    def __init__(self, source: Source, budgets: Budgets) -> None:
        self._source = source
        self._budgets = budgets
        self._token = Cursor(source, budgets)
        self._joined: Process | None = None  # the latest composition without parentheses around it
        self._warnings: list[Diagnostic] = []

    def definitions(self) -> tuple[list[Schema], list[Diagnostic]]:
        """All definitions up to the end of the text, and what was found wrong on the way."""
        schemas: list[Schema] = []
        errors: list[Diagnostic] = []
        while self._token.kind != "end" and len(errors) < self._budgets.errors:
            try:
                schemas.append(self._definition())
            except RSError as error:
                errors.extend(error.diagnostics)
                if errors[-1].code in EXCEEDED or not self._recovers(errors):
                    break
        return schemas, errors + self._warnings

    def lone_process(self) -> Process:
        """A process and nothing after it."""
        process = self._process()
        if self._token.kind != "end":
            raise self._left_over()
        return process

    def _recovers(self, errors: list[Diagnostic]) -> bool:
        try:
            self._token.skip_to_definition()
        except RSError as error:
            errors.extend(error.diagnostics)
            return False
        return True

    def _definition(self) -> Schema:
        token = self._token
        place = token.place()
        if token.kind != "name":
            found = token.found()
            raise token.error("syntax", f"{found} where a definition should begin", "expected Name[…]<…> = P")
        name = token.advance()
        head = read_head(token) if token.text == "[" else ()
        results = read_results(token) if token.text == "<" else ()
        if token.text != "=":
            hint = f"or is an operator missing before {name}?"
            raise token.error("syntax", f"expected `=` after {name}, found {token.found()}", hint)
        token.advance()
        body = self._process()
        if token.kind not in ("end", "name"):
            raise self._left_over()
        return Schema(name, head, results, body, place)

    def _process(self, floor: int = 0) -> Process:
        """A process composed by operators stronger than `floor`."""
        token = self._token
        if floor == 0 and token.text == "if":
            return self._if()
        left = self._operand()
        while (operator := INFIX.get(token.text)) is not None and operator.strength > floor:
            left = self._join(left, operator)
        return left

    def _join(self, left: Process, operator: Operator) -> Process:
        """`left`, and what the operator joins to it."""
        token = self._token
        at = token.at
        token.enter()
        parts = [left]
        mixes = self._mixes(operator, left)
        while token.text == operator.sign and (len(parts) == 1 or operator.joining != "once"):
            token.advance()
            parts.append(self._process(operator.strength))
            mixes = mixes or self._mixes(operator, parts[-1])
        following = INFIX.get(token.text)
        if following is not None and following.strength == operator.strength:
            raise self._ungrouped(operator, following)
        if mixes:
            self._warnings.append(self._source.finding(at, "warning", "mixed-operators", *MIXED))
        token.leave()
        self._joined = joined = BUILD[operator.sign](parts)
        return joined

    def _operand(self) -> Process:
        token = self._token
        if token.kind == "name":
            return self._call()
        if token.text == "(":
            opened = token.at
            token.enter()
            token.advance()
            inner = self._process()
            token.close(")", opened)
            token.leave()
            self._joined = None
            return inner
        if token.text == "~":
            token.advance()
            token.enter()
            inner = self._operand()
            token.leave()
            return Not(inner)
        if token.text == "if":
            raise token.error("syntax", "`if` within a larger expression", "put it in parentheses")
        hint = "expected a name, `~P`, `(P)` or `if`"
        raise token.error("syntax", f"{token.found()} where a process should stand", hint)

    def _call(self) -> Process:
        token = self._token
        place = token.place()
        name = token.advance()
        arguments = read_arguments(token) if token.text == "[" else ()
        results = read_results(token) if token.text == "<" else ()
        if token.text == "(":
            hint = f"arguments stand in square brackets: {name}[…]"
            raise token.error("syntax", f"`(` after the process {name}", hint)
        if token.text == "[":
            raise token.error("syntax", "`[` after results", "arguments stand before results: Name[…]<…>")
        return Call(name, arguments, results, place)

    def _if(self) -> Process:
        token = self._token
        token.enter()
        parts = []
        for word in ("if", "then", "else"):
            if token.text != word:
                message = f"expected `{word}`, found {token.found()}"
                raise token.error("syntax", message, "the form is if P then P else P")
            token.advance()
            parts.append(self._process())
        token.leave()
        return If(*parts)

    def _mixes(self, operator: Operator, part: Process) -> bool:
        return operator.term is Seq and part is self._joined and isinstance(part, Cond)

    def _ungrouped(self, operator: Operator, following: Operator) -> RSError:
        sign, other = operator.sign, following.sign
        do_not = "do not chain" if operator.joining == "once" else "do not mix without parentheses"
        hint = f"write (A {sign} B) {other} C or A {sign} (B {other} C)"
        return self._token.error("syntax", f"`{sign}` and `{other}` {do_not}", hint)

    def _left_over(self) -> RSError:
        token = self._token
        hint = AFTER.get(token.text, "expected an operator, or the next definition")
        return token.error("syntax", f"{token.found()} after the end of a process", hint)
