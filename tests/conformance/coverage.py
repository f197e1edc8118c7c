"""What random programs pass through: every statement of the semantics, and every operator with every outcome.

A `Coverage` puts a counter before each statement of `rs.evolves`, `leaves`, `serving` and `store`, in the functions as
they stand in the running process, and notes each composition that is decided, with its outcome. What there is to be
covered is read off the sources: a rule added to them is a row at once. Rows that no run can pass are in `ELSEWHERE`.
"""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

from planner_reactor.rs import evolves, leaves, serving, store
from planner_reactor.rs.states import Chain, Deciding, Ended, Export, Group, Inverted, Round, Serve, Spawning, Testing

SEMANTICS = (evolves, leaves, serving, store)
IDS = re.compile(r"\b(N\d+'?|SEQ|PAR|COM|TIME)(?![\w'])")

Row = tuple[str, str, str]
"""(module.function, rule, statement) or ("operator", operator, outcome)."""

ELSEWHERE = {
    "evolves._unfold": ("raise BudgetError", "unguarded recursion is refused when a program is loaded"),
    "evolves._granted": ("return term, store", "only what is granted is looked at by then"),
    "leaves.steps": ("yield Step", "explorers ask for all steps at once"),
    "leaves._seconds": ("return value", "of unknowns only"),
    "leaves._reached": ("", "of unknowns only"),
}
"""Statements, by function and beginning, that no concrete run passes, and why."""

OUTCOMES = ("stop", "abort")
OPERATORS = (";", ":", "|", "&", "#", "~", "if", ":;", "body of :;", "::", "call", "body")


class Coverage:
    """Counts from its making until `close`."""

    def __init__(self) -> None:
        self.rows: list[Row] = []
        self.hits: list[int] = []
        self.ends: Counter[tuple[str, str]] = Counter()
        self._replaced: list[tuple[FunctionType, CodeType]] = []
        for module in SEMANTICS:
            self._watch(module)

    def close(self) -> None:
        """Everything runs as it did."""
        for function, code in self._replaced:
            function.__code__ = code

    def table(self) -> dict[Row, int]:
        """Every row, and how often it was passed."""
        found = dict.fromkeys(self.rows, 0)
        for row, hits in zip(self.rows, self.hits, strict=True):
            found[row] += hits
        return found | {("operator", o, e): self.ends[o, e] for o in OPERATORS for e in OUTCOMES}

    def missing(self) -> list[Row]:
        """The rows that a run could have passed, and none has."""
        return [row for row, hits in self.table().items() if not hits and not _elsewhere(row)]

    def decided(self, term: Any, result: Any) -> Any:
        """`terminate` and `decide` return through here."""
        after = result[0]
        if after is not term and (found := _outcome(term, after)) is not None:
            self.ends[found[0], OUTCOMES[not found[1]]] += 1
        return result

    def _watch(self, module: ModuleType) -> None:
        file = str(module.__file__)
        lines = Path(file).read_text(encoding="utf-8").splitlines()
        counting = _Counting(module.__name__.rpartition(".")[2], lines, self.rows)
        tree = ast.fix_missing_locations(counting.visit(ast.parse("\n".join(lines))))
        self.hits += [0] * (len(self.rows) - len(self.hits))
        module.__dict__["_hits"], module.__dict__["_decided"] = self.hits, self.decided
        codes = {(code.co_name, code.co_firstlineno): code for code in _codes(compile(tree, file, "exec"))}
        for function in _functions(module):
            self._replaced.append((function, function.__code__))
            function.__code__ = codes[function.__name__, function.__code__.co_firstlineno]


class _Counting(ast.NodeTransformer):
    """Puts `_hits[n] += 1` before each simple statement of a function, n being the number of its row."""

    SIMPLE = (ast.Return, ast.Assign, ast.AnnAssign, ast.AugAssign, ast.Raise, ast.Expr, ast.Continue)

    def __init__(self, module: str, lines: list[str], rows: list[Row]) -> None:
        self._module = module
        self._lines = lines
        self._rows = rows
        self._function: ast.FunctionDef | None = None

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        outer, self._function = self._function, node
        self.generic_visit(node)
        self._function = outer
        return node

    def generic_visit(self, node: ast.AST) -> ast.AST:
        super().generic_visit(node)
        for name in ("body", "orelse", "finalbody"):
            if self._function is not None and isinstance(block := getattr(node, name, None), list):
                setattr(node, name, [new for statement in block for new in self._counted(statement)])
        return node

    def _counted(self, node: ast.stmt) -> Iterator[ast.stmt]:
        function = self._function
        assert function is not None
        documents = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        if isinstance(node, self.SIMPLE) and not documents:
            rule, text = _rule(function, node.lineno, self._lines), self._lines[node.lineno - 1].strip()
            number = len(self._rows)
            self._rows.append((f"{self._module}.{function.name}", rule, text))
            yield ast.copy_location(ast.parse(f"_hits[{number}] += 1").body[0], node)
        if isinstance(node, ast.Return) and function.name in ("terminate", "decide") and node.value is not None:
            node.value = ast.Call(ast.Name("_decided", ast.Load()), [ast.Name("term", ast.Load()), node.value], [])
        yield node


def _rule(function: ast.FunctionDef, line: int, lines: list[str]) -> str:
    """The id in the nearest comment above, else in the documentation of the function."""
    for number in range(line, function.lineno, -1):
        text = lines[number - 1].strip()
        if text.startswith("#") and (ids := IDS.findall(text)):
            return str(ids[0])
    ids = IDS.findall(ast.get_docstring(function) or "")
    return str(ids[0]) if ids else ""


def _codes(code: CodeType) -> Iterator[CodeType]:
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield constant
            yield from _codes(constant)


def _functions(module: ModuleType) -> Iterator[FunctionType]:
    """The functions and methods that are defined in a module."""
    for value in module.__dict__.values():
        if getattr(value, "__module__", "") != module.__name__:
            continue
        members = vars(value).values() if isinstance(value, type) else [value]
        for member in members:
            member = member.fget if isinstance(member, property) else member
            if isinstance(member, FunctionType) and member.__code__.co_filename == module.__file__:
                yield member


def _elsewhere(row: Row) -> bool:
    place, _, text = row
    return place in ELSEWHERE and text.startswith(ELSEWHERE[place][0])


def _outcome(term: Any, after: Any) -> tuple[str, bool] | None:
    """Which operator this is, and how it, or the part that decides how it goes on, has ended."""
    match term:
        case Chain(operator, Ended(ok)):
            return operator, ok
        case Deciding(Ended(ok)):
            return "if", ok
        case Testing(Ended(ok)):
            return ":;", ok
        case Round(Ended(ok)):
            return "body of :;", ok
    if isinstance(after, Ended):
        match term:
            case Group(operator):
                return operator, after.ok
            case Inverted():
                return "~", after.ok
            case Spawning():
                return "::", after.ok
            case Export():
                return "call", after.ok
            case Serve():
                return "body", after.ok
    return None
