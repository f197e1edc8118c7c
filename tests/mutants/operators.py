"""Small changes to Python code, by its syntax tree: what a careless hand could do to a rule.

Each operator is a function from a node to the nodes that may stand in its place. Annotations, documentation,
assertions for the type checker and the making of types are left alone: they mean nothing at run time.
"""

from __future__ import annotations

import ast
import copy
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

Path = tuple[tuple[str, int | None], ...]
"""From the root of a tree to a node: fields, with an index where the field is a list."""

Change = tuple[str, ast.AST | None]
"""What is done, and what stands in the node's place (nothing: the node is taken out of its list)."""

OUTCOMES = {"ok": "ab", "ab": "ok", "OK": "AB", "AB": "OK", ";": ":", ":": ";", "|": "&", "&": "|"}
FUNCTIONS = {"any": "all", "all": "any", "min": "max", "max": "min"}
WRAPPERS = {"settle": 0, "abort": 1, "reversed": 0, "sorted": 0, "only": 0, "replace": 0, "resting": 0}
"""Calls, and the argument that stands for the call in a mutant."""

MERGES = ("bind",)
"""Calls in the place of which each of their arguments may stand."""

COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Eq: ast.NotEq, ast.NotEq: ast.Eq, ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In,
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt,
}  # fmt: skip
ARITHMETIC: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.BitOr: ast.BitAnd,
}  # fmt: skip
STORE_CHANGES = frozenset({
    "changed", "left_queue", "ended", "abandoned", "entered", "left", "stamped", "without", "inhibit", "uninhibit",
    "drain", "drain_ended", "released", "root_ended", "_fated", "settled",
})  # fmt: skip
"""Methods that give a changed store: a mutant keeps the old one."""


@dataclass(frozen=True, slots=True)
class Mutation:
    """One change: where, what, the texts of the node before and after, and what encloses it."""

    path: Path
    operator: str
    before: str
    after: str
    function: str
    line: int

    def applied(self, tree: ast.Module) -> ast.Module:
        """The tree with this change made."""
        mutant = copy.deepcopy(tree)
        place: ast.AST = mutant
        for field, index in self.path[:-1]:
            found = getattr(place, field)
            place = found if index is None else found[index]
        field, index = self.path[-1]
        new = _parsed(self)
        if index is None:
            setattr(place, field, new)
        elif new is None:
            del getattr(place, field)[index]
        else:
            getattr(place, field)[index] = new
        return ast.fix_missing_locations(mutant)


_NEW: dict[tuple[Path, str, str], ast.AST | None] = {}


def _parsed(mutation: Mutation) -> ast.AST | None:
    return copy.deepcopy(_NEW[mutation.path, mutation.operator, mutation.after])


def mutations(tree: ast.Module) -> Iterator[Mutation]:
    """Every change that an operator makes to a module, each result once."""
    seen = set()
    for path, node, function in _nodes(tree, (), ""):
        for operator, new in _changes(node, path):
            before = _text(node)
            after = "" if new is None else _text(new)
            if (path, after) in seen or before == after:
                continue
            seen.add((path, after))
            _NEW[path, operator, after] = new
            yield Mutation(path, operator, before, after, function, _line(node))


def _text(node: ast.AST) -> str:
    if isinstance(node, ast.match_case):
        guard = f" if {ast.unparse(node.guard)}" if node.guard else ""
        return f"case {ast.unparse(node.pattern)}{guard}: {'; '.join(ast.unparse(s) for s in node.body)}"
    if isinstance(node, ast.comprehension):
        return f"for {ast.unparse(node.target)} in {ast.unparse(node.iter)}" + "".join(
            f" if {ast.unparse(c)}" for c in node.ifs
        )
    return ast.unparse(node)


def _line(node: ast.AST) -> int:
    if isinstance(node, ast.match_case):
        return node.pattern.lineno
    return getattr(node, "lineno", 0) or getattr(getattr(node, "target", None), "lineno", 0)


# ------------------------------------------------------------------------------------------------- where it may change


def _nodes(node: ast.AST, path: Path, function: str) -> Iterator[tuple[Path, ast.AST, str]]:
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        function = f"{function}.{node.name}".strip(".")
    if _meaningless(node):
        return
    yield path, node, function
    for field in node._fields:
        if field in ("annotation", "returns", "decorator_list", "bases", "type_params", "ctx", "msg"):
            continue
        if isinstance(node, ast.ClassDef) and field == "keywords":
            continue
        value = getattr(node, field, None)
        if isinstance(value, ast.AST):
            yield from _nodes(value, (*path, (field, None)), function)
        elif isinstance(value, list):
            for index, item in enumerate(value):
                if isinstance(item, ast.AST):
                    yield from _nodes(item, (*path, (field, index)), function)


def _meaningless(node: ast.AST) -> bool:
    match node:
        case ast.Import() | ast.ImportFrom() | ast.Assert() | ast.JoinedStr() | ast.Raise():
            return True
        case ast.Expr(ast.Constant(str())):
            return True
        case ast.AnnAssign(annotation=ast.Name("TypeAlias")):
            return True
        case ast.Assign(value=ast.Call(ast.Name("TypeVar" | "NewType"))):
            return True
        case ast.keyword("strict" | "maxsize" | "default_factory"):
            return True
        case _:
            return False


# --------------------------------------------------------------------------------------------------- what may change


def _changes(node: ast.AST, path: Path) -> Iterator[Change]:
    for operator in OPERATORS:
        yield from operator(node)
    if path and path[-1][1] is not None:
        yield from _taken_out(node, path[-1][0])


def _taken_out(node: ast.AST, field: str) -> Iterator[Change]:
    """Statements that are not needed for a name to be there, and keywords of calls."""
    match node:
        case ast.Expr():
            yield "drop statement", ast.Pass()
        case ast.AugAssign():
            yield "drop statement", ast.Pass()
        case ast.Assign(targets=[ast.Name(name)], value=value) if _mentions(value, name):
            yield "drop statement", ast.Pass()
        case ast.Assign(targets=[ast.Tuple() as target], value=value) if _mentions(value, "store"):
            if len(target.elts) == 1:
                yield "drop statement", ast.Pass()
        case ast.If(orelse=[]):
            yield "drop if", ast.Pass()
        case ast.keyword(arg=str()) if field == "keywords":
            yield "drop keyword", None


def _mentions(node: ast.AST, name: str) -> bool:
    return any(isinstance(n, ast.Name) and n.id == name for n in ast.walk(node))


def cases(node: ast.AST) -> Iterator[Change]:
    """A match with a case less."""
    if isinstance(node, ast.Match) and len(node.cases) > 1:
        for index, case in enumerate(node.cases):
            if not isinstance(case.pattern, ast.MatchAs) or case.guard or case.pattern.name or index == 0:
                rest = [c for n, c in enumerate(node.cases) if n != index]
                yield f"drop case {_text(case)[5:].split(': ')[0]}", _with(node, cases=rest)


def patterns(node: ast.AST) -> Iterator[Change]:
    """A pattern that fits more, or something else; a guard less, or turned round."""
    match node:
        case ast.MatchSingleton(bool() as value):
            yield "swap constant", ast.MatchSingleton(not value)
            yield "widen pattern", ast.MatchAs()
        case ast.match_case(ast.MatchValue(), guard):
            yield "widen pattern", _with(node, pattern=ast.MatchAs(), guard=guard or ast.Constant(True))
        case ast.MatchOr(alternatives):
            for index in range(len(alternatives)):
                rest = [p for n, p in enumerate(alternatives) if n != index]
                yield "narrow pattern", rest[0] if len(rest) == 1 else ast.MatchOr(rest)
        case ast.MatchClass(patterns=[_, *_] as parts):
            for index, part in enumerate(parts):
                if isinstance(part, ast.MatchValue):
                    yield "widen pattern", _with(node, patterns=[*parts[:index], ast.MatchAs(), *parts[index + 1 :]])
        case ast.match_case(guard=ast.expr() as guard):
            yield "drop guard", _with(node, guard=ast.Constant(True))
            yield "negate guard", _with(node, guard=_not(guard))


def conditions(node: ast.AST) -> Iterator[Change]:
    """A condition turned round, a part of it left out, the branches of a choice."""
    match node:
        case ast.If(test) | ast.While(test) | ast.IfExp(test):
            yield "negate condition", _with(node, test=_not(test))
            if isinstance(node, ast.IfExp):
                yield "take branch", node.body
                yield "take branch", node.orelse
        case ast.comprehension(ifs=[_, *_] as ifs):
            for index, test in enumerate(ifs):
                yield "drop condition", _with(node, ifs=[c for n, c in enumerate(ifs) if n != index])
                yield "negate condition", _with(node, ifs=[*ifs[:index], _not(test), *ifs[index + 1 :]])
        case ast.BoolOp(operator, values):
            yield "swap and/or", ast.BoolOp(ast.Or() if isinstance(operator, ast.And) else ast.And(), values)
            for index in range(len(values)):
                rest = [v for n, v in enumerate(values) if n != index]
                yield "drop operand", rest[0] if len(rest) == 1 else ast.BoolOp(operator, rest)
        case ast.UnaryOp(ast.Not(), operand):
            yield "drop not", operand
        case ast.Return(ast.Compare() | ast.BoolOp() | ast.UnaryOp(ast.Not()) as value):
            yield "negate result", ast.Return(_not(value))
        case ast.Return(ast.Call(ast.Name("any" | "all" | "bool")) as value):
            yield "negate result", ast.Return(_not(value))
        case ast.Compare(left, [operator], [right]) if type(operator) in COMPARISONS:
            yield "swap comparison", ast.Compare(left, [COMPARISONS[type(operator)]()], [right])


def values(node: ast.AST) -> Iterator[Change]:
    """Another constant; an arithmetic operator swapped."""
    match node:
        case ast.Constant(bool() as value):
            yield "swap constant", ast.Constant(not value)
        case ast.Constant(int() | float() as value):
            yield "off by one", ast.Constant(value + 1)
            if value == 1:
                yield "off by one", ast.Constant(0)
        case ast.Constant(str() as text):
            yield "swap constant", ast.Constant(OUTCOMES.get(text, f"not {text}"))
        case ast.Name("OK" | "AB" as name, ast.Load()):
            yield "swap outcome", _name(OUTCOMES[name])
        case ast.BinOp(left, operator, right) if type(operator) in ARITHMETIC:
            yield "swap operator", ast.BinOp(left, ARITHMETIC[type(operator)](), right)
        case ast.UnaryOp(ast.USub(), operand):
            yield "drop minus", operand
        case ast.Slice(lower, upper, None):
            if lower is not None:
                yield "widen slice", ast.Slice(None, upper, None)
            if upper is not None:
                yield "widen slice", ast.Slice(lower, None, None)


def called(node: ast.AST) -> Iterator[Change]:
    """A call replaced by its mirror, or left out: its argument, or the old store, stands in its place."""
    match node:
        case ast.Call(ast.Name(name), arguments, keywords):
            if name in FUNCTIONS:
                yield f"swap {name}/{FUNCTIONS[name]}", ast.Call(_name(FUNCTIONS[name]), arguments, keywords)
            if name in WRAPPERS and len(arguments) > WRAPPERS[name]:
                yield f"drop {name}", arguments[WRAPPERS[name]]
            if name in MERGES:
                yield from ((f"drop {name}", a) for a in arguments if not isinstance(a, ast.Starred))
        case ast.Call(ast.Attribute(receiver, name)) if name in STORE_CHANGES:
            yield f"old store for {name}", receiver


def collections(node: ast.AST) -> Iterator[Change]:
    """An item less in a set, a table or a tuple that is put together; the parts of one in another order."""
    match node:
        case ast.Call(ast.Name("frozenset"), [ast.Set(items)]) if len(items) > 1:
            for index in range(len(items)):
                rest: list[ast.expr] = [item for n, item in enumerate(items) if n != index]
                yield f"drop item {_text(items[index])}", ast.Call(_name("frozenset"), [ast.Set(rest)], [])
        case ast.Dict(keys, items) if keys:
            for index, key in enumerate(keys):
                new = ast.Dict([*keys[:index], *keys[index + 1 :]], [*items[:index], *items[index + 1 :]])
                yield f"drop entry {_text(key) if key else ''}", new
        case ast.Tuple(items, ast.Load()) if any(isinstance(item, ast.Starred) for item in items):
            if len(items) > 1:
                yield "swap order", ast.Tuple(list(reversed(items)), ast.Load())
            for index in range(len(items)):
                yield "drop item", ast.Tuple([i for n, i in enumerate(items) if n != index], ast.Load())
        case ast.Compare(left, [ast.In() | ast.NotIn() as operator], [ast.Tuple(items)]) if len(items) > 1:
            for index in range(len(items)):
                rest = [item for n, item in enumerate(items) if n != index]
                yield f"drop item {_text(items[index])}", ast.Compare(left, [operator], [ast.Tuple(rest, ast.Load())])


OPERATORS: tuple[Callable[[ast.AST], Iterable[Change]], ...] = (
    cases, patterns, conditions, values, called, collections,
)  # fmt: skip


def _not(test: ast.expr) -> ast.expr:
    match test:
        case ast.UnaryOp(ast.Not(), operand):
            return operand
        case ast.Compare(left, [operator], [right]) if type(operator) in (ast.Eq, ast.Is, ast.In, ast.NotEq, ast.NotIn,
                                                                         ast.IsNot):  # fmt: skip
            return ast.Compare(left, [COMPARISONS[type(operator)]()], [right])
        case _:
            return ast.UnaryOp(ast.Not(), test)


def _name(name: str) -> ast.Name:
    return ast.Name(name, ast.Load())


def _with(node: ast.AST, **fields: object) -> ast.AST:
    new = copy.copy(node)
    for name, value in fields.items():
        setattr(new, name, value)
    return new
