"""From text to a program that may run: parsed, bound, checked, or refused as a whole.

A text may extend a program that is running already (R §9.1: definitions are passed to the executer as they
are made): it is then checked together with that program, and nothing of it is loaded if there is any error.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

from planner_reactor.errors import Place, RSError
from planner_reactor.rs.checks import check, check_addition
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.source import Source
from planner_reactor.rs.terms import Process, Program, Schema
from planner_reactor.rs.vocabulary import BUILT_IN, Signature

NOTHING = Program()


def load(
    text: str,
    *,
    file: str = "<text>",
    signatures: Mapping[str, Signature] = BUILT_IN,
    functions: Collection[str] = frozenset(),
    given: Program = NOTHING,
    roots: Collection[str] = (),
    ports: Collection[str] = (),
) -> Program:
    """The definitions in `text` (without those of `given`, beside which they are checked); raises `RSError`.

    With `roots` the program is taken to be complete (`checks`).
    """
    program = parse_program(text, file=file)
    if roots:
        together = given.with_schemas(program.schemas)
        found = check(together, signatures=signatures, functions=functions, roots=roots, ports=ports)
    else:
        found = check_addition(given, program, signatures=signatures, functions=functions)
    errors = [f for f in found if f.severity == "error"]
    if errors:
        raise RSError(Source(text, file).shown(errors))
    return program


def load_process(
    text: str,
    *,
    given: Program,
    file: str = "<process>",
    signatures: Mapping[str, Signature] = BUILT_IN,
    functions: Collection[str] = frozenset(),
) -> Process:
    """One process, as it is started beside the definitions `given`: `REACTOR`, `Serve[3]`. Raises `RSError`."""
    process = parse_process(text, file=file)
    alone = Program([Schema(file, (), (), process, Place(1, 1, file))])
    found = check_addition(given, alone, signatures=signatures, functions=functions)
    errors = [f for f in found if f.severity == "error"]
    if errors:
        raise RSError(Source(text, file).shown(errors))
    return process
