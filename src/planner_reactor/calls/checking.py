"""`check`: everything that is wrong or doubtful about programs and domains, without running anything.

With a host, programs may use its processes and functions, and a domain must fit it: each basic action is one of its
processes, with as many arguments and results, and each assumption is sensed.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from msgspec.structs import replace

from planner_reactor.calls.hosts import HostSource, find_host
from planner_reactor.calls.inputs import read_text
from planner_reactor.errors import Diagnostic, DomainError, InputError, Place, SourceError, nearest
from planner_reactor.logic.domain import ActionSchema, Domain
from planner_reactor.logic.reader import check_domain, read_domain
from planner_reactor.rs.checks import check_text
from planner_reactor.rs.source import Source
from planner_reactor.rs.vocabulary import BUILT_IN
from planner_reactor.runtime import Host, Scheduler, VirtualClock

KINDS = (".rsl", ".itl")


def check(*files: str | Path, host: HostSource | None = None) -> dict[str, Any]:
    """Check programs `*.rsl` and domains `*.itl`; a file that cannot be read is a finding too.

    Returns `ok` (no errors) and `diagnostics`, each with `file`, `line`, `column`, `severity`, `code`, `message` and
    `hint`. Raises InputError for a file of another kind, or a host that cannot be made.
    """
    found = findings(*files, host=host)
    return {"ok": not any(f.severity == "error" for f in found), "diagnostics": [as_json(f) for f in found]}


def findings(*files: str | Path, host: HostSource | None = None) -> tuple[Diagnostic, ...]:
    """What `check` finds, file by file in the order given."""
    for file in files:
        if Path(file).suffix not in KINDS:
            raise InputError(f"{file}: expected a program (*.rsl) or a domain (*.itl)")
    made = find_host(host)(Scheduler(VirtualClock())) if host is not None else None
    return tuple(finding for file in files for finding in _of_file(file, made))


def as_json(finding: Diagnostic) -> dict[str, Any]:
    """One finding as plain data."""
    place = finding.place
    return {
        "file": place.file, "line": place.line, "column": place.column, "severity": finding.severity,
        "code": finding.code, "message": finding.message, "hint": finding.hint,
    }  # fmt: skip


def _of_file(file: str | Path, host: Host | None) -> tuple[Diagnostic, ...]:
    try:
        text = read_text(file)
    except SourceError as error:
        return error.diagnostics
    if Path(file).suffix == ".rsl":
        signatures = host.signatures if host is not None else BUILT_IN
        functions = host.functions if host is not None else ()
        return check_text(text, str(file), signatures=signatures, functions=functions)
    found = check_domain(text, file=str(file))
    if host is None or any(f.severity == "error" for f in found):
        return found
    return (*found, *misfits(read_domain(text, file=str(file)), text, host))


def must_fit(text: str, file: str, host: Host) -> tuple[Diagnostic, ...]:
    """Refuses, with DomainError, a domain that the host cannot carry out; returns the warnings."""
    found = misfits(read_domain(text, file=file), text, host)
    errors = [f for f in found if f.severity == "error"]
    if errors:
        raise DomainError(errors)
    return found


def misfits(domain: Domain, text: str, host: Host) -> tuple[Diagnostic, ...]:
    """Where a domain asks for what its host does not have."""
    found = [*_actions(domain, host), *_assumptions(domain, host)]
    placed = [replace(f, place=replace(f.place, file=domain.file)) for f in found]
    return Source(text, domain.file).shown(placed)


def _actions(domain: Domain, host: Host) -> Iterator[Diagnostic]:
    known = {**BUILT_IN, **host.signatures}
    for schema in domain.schemas.values():
        if schema.abstract:
            continue
        signature = known.get(schema.name)
        if signature is None:
            hint = nearest(schema.name, host.signatures) or f"host {host.name} has no process of that name"
            yield _finding(schema, "unknown-process", f"unknown process {schema.name}", hint)
        elif not (signature.takes(len(schema.inputs)) and signature.returns(len(schema.outputs))):
            asked = f"{len(schema.inputs)} arguments and {len(schema.outputs)} results"
            yield _finding(schema, "argument-count", f"{schema.name} with {asked}", f"expected {signature.usage()}")


def _assumptions(domain: Domain, host: Host) -> Iterator[Diagnostic]:
    sensed = {name.partition("(")[0] for name in host.assumptions}  # `A(x)` tells of A
    for assumption in domain.assumptions.values():
        if assumption.name not in sensed:
            hint = nearest(assumption.name, host.assumptions) or f"host {host.name} does not sense it"
            place = assumption.place or Place(1, 1)
            message = f"nobody can tell whether {assumption.name} holds"
            yield Diagnostic(place, "warning", "unsensed-assumption", message, hint)


def _finding(schema: ActionSchema, code: str, message: str, hint: str) -> Diagnostic:
    return Diagnostic(schema.place or Place(1, 1), "error", code, message, hint)
