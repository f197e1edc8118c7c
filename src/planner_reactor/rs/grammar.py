"""The grammar of RS: the tables from which the parser reads and the printer writes.

    definition ::= Name [head, …] <result, …> = P
    head       ::= name (a parameter) | number | "string" (a constant)
    P          ::= Name [expression, …] <result, …>
                 | P | P   P & P   P :; P   P :: P   P ; P   P : P   P # P   ~P
                 | ( P )   if P then P else P
    expression ::= number | "string" | name | name ( expression, … ) | ( expression ) | - expression
                 | expression operator expression
    comment    ::= // to the end of the line

An operator of greater strength binds tighter. `~` above `:`, `#` above `|` and the loops above `|` are forced
by the papers' equations; loops looser than `:` and `;` is our choice, so that `SIT[s]<k> :; A : B` reads as a
loop over `A : B` (`semantics`). The parts of `if` reach as far as they can; an `if` within a larger
expression stands in parentheses. Tokens are as long as they can be: `:;` `::` `==` `/=` `<=` `>=` are one
token each.
"""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import Literal, TypeAlias

import msgspec

from planner_reactor.rs.terms import All, Cond, Disable, If, Loop, Not, Par, Process, Seq, Spawn

Joining: TypeAlias = Literal["flat", "right", "left", "once", "prefix"]
"""How an operator meets itself: "flat" is n-ary, "once" may not be chained."""


class Operator(msgspec.Struct, frozen=True):
    """One operator on processes. `bare` are the terms that the printer leaves without parentheses below it:
    fewer than the strengths allow, since mixtures of `:` and `;`, loops and `#` are easily misread
    (`semantics`)."""

    sign: str
    strength: int
    joining: Joining
    term: type[Process]
    bare: tuple[type[Process], ...]


PROCESS_OPERATORS = (
    Operator("|", 1, "flat", Par, (Loop, Spawn, Seq, Cond, Not)),
    Operator("&", 1, "flat", All, (Loop, Spawn, Seq, Cond, Not)),
    Operator(":;", 2, "once", Loop, (Not,)),
    Operator("::", 2, "once", Spawn, (Not,)),
    Operator(";", 3, "right", Seq, (Not,)),
    Operator(":", 4, "right", Cond, (Not,)),
    Operator("#", 5, "flat", Disable, ()),
    Operator("~", 6, "prefix", Not, (Not,)),
)


class Arithmetic(msgspec.Struct, frozen=True):
    """One operator on expressions. `-` before an expression is as strong as `PREFIX_MINUS`."""

    sign: str
    strength: int
    joining: Joining


EXPRESSION_OPERATORS = (
    *(Arithmetic(sign, 1, "once") for sign in ("==", "/=", "<", "<=", ">", ">=")),
    *(Arithmetic(sign, 2, "left") for sign in ("+", "-")),
    *(Arithmetic(sign, 3, "left") for sign in ("*", "/")),
)
PREFIX_MINUS = 4

INFIX = MappingProxyType({o.sign: o for o in PROCESS_OPERATORS if o.joining != "prefix"})
ARITHMETIC = MappingProxyType({o.sign: o for o in EXPRESSION_OPERATORS})
OPERATOR_OF = MappingProxyType({o.term: o for o in PROCESS_OPERATORS})
"""The operator that builds a term; calls and `if` have none."""

TOKEN = re.compile(
    r"""
    (?: \s++ | //[^\n]*+ )*+
    (?: (?P<word>    (?: if | then | else ) \b )
      | (?P<name>    [^\W\d] \w* )
      | (?P<number>  [0-9]+ (?: \.[0-9]+ )? (?: [eE][+-]?[0-9]+ )? (?! [\w.] ) )
      | (?P<text>    " (?: [^"\\\n] | \\. )* " )
      | (?P<sign>    :; | :: | == | /= | <= | >= | [][()<>,=|&;:\#~+*/-] )
      | (?P<end>     \Z )
      | (?P<wrong>   . )
    )
    """,
    re.VERBOSE,
)
"""One token, after blanks and comments; a word is reserved. Strings are written as in JSON."""

DEFINITION = re.compile(
    r"""
    ^ (?! (?: if | then | else ) \b ) [^\W\d]\w*+ [ ]*+
    (?: \[ [^]\n]{0,200} \] [ ]*+ )? (?: < [^>\n]{0,200} > [ ]*+ )? = (?! = )
    """,
    re.VERBOSE | re.MULTILINE,
)
"""A line that begins a definition in its first column: where reading goes on after an error."""


def stands_bare(operand: Process, below: Process) -> bool:
    """Does the printer write `operand` without parentheses as a direct operand of the term `below`?"""
    if isinstance(operand, If) or isinstance(below, If):
        return isinstance(below, If)
    operator = OPERATOR_OF.get(type(operand))
    return operator is None or type(operand) in OPERATOR_OF[type(below)].bare
