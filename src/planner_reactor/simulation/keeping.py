"""Cases that failed, as a file keeps them: `[[case]]` tables, with a comment that says what was wrong."""

from __future__ import annotations

import msgspec

from planner_reactor.simulation.cases import Case, Fault


class _Kept(msgspec.Struct):
    case: tuple[Case, ...] = ()


def read_cases(text: str) -> tuple[Case, ...]:
    """The cases of a file, in order."""
    return msgspec.toml.decode(text, type=_Kept).case


def written(case: Case, why: str) -> str:
    """A case as it is kept."""
    lines = [f"# {why}", "[[case]]", f'world = "{case.world}"', f"seed = {case.seed}", f"seconds = {case.seconds}"]
    if case.trusting:
        lines.append("trusting = true")
    if case.faults:
        lines += ["faults = [", *(f"    {_row(fault)}," for fault in case.faults), "]"]
    return "\n".join(lines) + "\n"


def _row(fault: Fault) -> str:
    fields = msgspec.to_builtins(fault)
    return "{ " + ", ".join(f"{key} = {msgspec.json.encode(value).decode()}" for key, value in fields.items()) + " }"
