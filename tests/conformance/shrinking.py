"""A smaller program that still fails: roots and definitions left out, processes replaced by less."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from planner_reactor.rs.checks import check
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import (
    STOP,
    All,
    Call,
    Cond,
    Disable,
    If,
    Loop,
    Not,
    Par,
    Process,
    Schema,
    Seq,
    Spawn,
    cond,
    seq,
)
from tests.conformance.running import HOST, SIGNATURES
from tests.conformance.texts import Example


def shrunk(example: Example, fails: Callable[[Example], bool]) -> Example:
    """The smallest that one replacement at a time reaches; `fails` must hold of the example."""
    while (smaller := next((e for e in _smaller(example) if _steps(e) and fails(e)), None)) is not None:
        example = smaller
    return example


def _steps(example: Example) -> bool:
    """Does every loop and recursion still take a step in each round?"""
    roots = [Schema(f"root{n}", (), (), process) for n, process in enumerate(example.processes, 1)]
    found = check(example.program.with_schemas(roots), signatures=SIGNATURES, functions=HOST.functions)
    return not any(finding.code in ("silent-loop", "unguarded-recursion") for finding in found)


def _smaller(example: Example) -> Iterator[Example]:
    if example.definitions:
        yield Example("", example.roots)
    roots = example.roots
    for n in range(len(roots)):
        if len(roots) > 1:
            yield Example(example.definitions, (*roots[:n], *roots[n + 1 :]))
        for process in _less(example.processes[n]):
            yield Example(example.definitions, (*roots[:n], show(process), *roots[n + 1 :]))


def _less(process: Process) -> Iterator[Process]:
    """Processes with one part less, or one part made smaller."""
    if isinstance(process, Call):
        if process != STOP:
            yield STOP
        return
    parts = _parts(process)
    yield from parts
    if isinstance(process, Seq | Cond | Par | All | Disable) and len(parts) > 2:
        for n in range(len(parts)):
            yield _with(process, (*parts[:n], *parts[n + 1 :]))
    for n, part in enumerate(parts):
        for smaller in _less(part):
            yield _with(process, (*parts[:n], smaller, *parts[n + 1 :]))


def _parts(process: Process) -> tuple[Process, ...]:
    match process:
        case Call():
            return ()
        case Not(body):
            return (body,)
        case Loop(condition, body) | Spawn(condition, body):
            return (condition, body)
        case If(test, then, otherwise):
            return (test, then, otherwise)
        case _:
            return process.parts


def _with(process: Process, parts: tuple[Process, ...]) -> Process:
    match process:
        case Seq():
            return seq(*parts)
        case Cond():
            return cond(*parts)
        case Par() | All() | Disable():
            return type(process)(parts)
        case _:
            kind: Any = type(process)
            return kind(*parts)  # type: ignore[no-any-return]
