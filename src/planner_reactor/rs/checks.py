"""All static checks of a program, and the list of what they and the parser may find.

Errors stop a program from loading, warnings do not. The rules are those of `semantics`; each module says
which.

    from the text (`parser`, `tokens`, `scope`)
      syntax                 error    the text does not follow the grammar
      too-long, too-deep, too-many-tokens, too-many-calls
                             error    a budget is exceeded
      rebound, clash         error    a name is bound twice in one scope, or by two parts side by side
      mixed-operators        warning  `:` and `;` without parentheses
    on heads (`clauses`)
      redefined              error    the name of a basic or built-in process is defined
      clause-form            error    clauses of one name differ in the number of arguments or results
      overlapping-clauses    error    two clauses can both apply
    on calls (`calls`, `bindings`)
      unknown-process, unknown-function, no-clause
                             error    nothing of that name, or with these arguments
      argument-count, result-count, argument-kind
                             error    not what the process expects
      unbound                error    a result is used where it does not reach, or is never bound
      may-be-unbound         warning  its binder may abort, or lose a `#`
    on behaviour (`guardedness`, `situations`, `ports`, `unused`)
      unguarded-recursion, silent-loop
                             error    it would go on for ever without a step
      sit-position, self-call, asserted-below-itself
                             error    a reaction would lose its tail, or an ASSERT would never return
      unserved-port          error    in a complete program, a port that is only read or only written
      unserved-situation     warning  no reaction serves it
      unreachable, unused-parameter
                             warning  never called, never read
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

from planner_reactor.errors import Diagnostic, RSError
from planner_reactor.rs.bindings import check_bindings
from planner_reactor.rs.calls import check_calls
from planner_reactor.rs.clauses import check_clauses
from planner_reactor.rs.guardedness import check_guardedness
from planner_reactor.rs.linking import Linked
from planner_reactor.rs.parser import read_program
from planner_reactor.rs.ports import check_ports
from planner_reactor.rs.situations import check_service, check_situations
from planner_reactor.rs.source import Source
from planner_reactor.rs.terms import Program
from planner_reactor.rs.unused import check_unused, reached_from
from planner_reactor.rs.uses import uses
from planner_reactor.rs.vocabulary import BUILT_IN, Signature


def check(
    program: Program,
    *,
    signatures: Mapping[str, Signature] = BUILT_IN,
    functions: Collection[str] = frozenset(),
    roots: Collection[str] = (),
    complete: bool = False,
    ports: Collection[str] = (),
) -> tuple[Diagnostic, ...]:
    """Everything that is wrong or doubtful about a program, in the order of the text.

    `signatures` are the host's processes (the built-in ones are always there), `functions` its functions,
    `roots` the definitions that will be started. A program with roots, or one said to be `complete`, must
    serve all its ports but those that the host serves, `ports`.
    """
    linked = Linked(program, {**signatures, **BUILT_IN}, functions)
    return _in_order(_check_all(linked, roots, ports, complete=complete or bool(roots)))


def check_addition(
    program: Program,
    added: Program,
    *,
    signatures: Mapping[str, Signature] = BUILT_IN,
    functions: Collection[str] = frozenset(),
) -> tuple[Diagnostic, ...]:
    """What is wrong with the definitions `added` beside those of `program`, which have been checked before.

    What one definition alone does not show, an unserved port or situation, an unused definition, is not
    looked for.
    """
    together = program.with_schemas(added.schemas)
    linked = Linked(together, {**signatures, **BUILT_IN}, functions, given=len(program))
    return _in_order(_check_definitions(linked))


def _check_all(
    linked: Linked, roots: Collection[str], ports: Collection[str], *, complete: bool
) -> Iterator[Diagnostic]:
    yield from _check_definitions(linked)
    used = uses(linked, among=reached_from(linked, roots))
    yield from check_service(linked, used)
    yield from check_unused(linked, roots)
    if complete:
        yield from check_ports(linked, used, ports)


def _check_definitions(linked: Linked) -> Iterator[Diagnostic]:
    yield from check_clauses(linked)
    yield from check_calls(linked)
    yield from check_bindings(linked)
    yield from check_guardedness(linked)
    yield from check_situations(linked)


def _in_order(found: Iterator[Diagnostic]) -> tuple[Diagnostic, ...]:
    """All findings, each once, as they stand in the text."""
    try:
        once = dict.fromkeys(found)
    except RSError as error:  # the program is too large to be checked
        return error.diagnostics
    return tuple(sorted(once, key=lambda f: (f.place.file, f.place.line, f.place.column)))


def check_text(
    text: str,
    file: str = "<text>",
    *,
    signatures: Mapping[str, Signature] = BUILT_IN,
    functions: Collection[str] = frozenset(),
    roots: Collection[str] = (),
    ports: Collection[str] = (),
) -> tuple[Diagnostic, ...]:
    """Everything that is wrong or doubtful about a text, which is taken for a complete program; each finding
    comes with its line. While the text cannot be read, only what was found in reading it is reported."""
    program, found = read_program(text, file=file)
    if any(f.severity == "error" for f in found):
        return found
    static = check(program, signatures=signatures, functions=functions, roots=roots, ports=ports, complete=True)
    return Source(text, file).shown([*found, *static])
