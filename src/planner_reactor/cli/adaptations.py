"""`verify --adapt`: what holds of an adaptation, for people."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from planner_reactor.cli.printing import print_json, reserved_output

LAWS = ("safe", "consistent", "atomic", "local", "bounded")


def verify_adaptation(
    file: Path, process: str, adapt: str, *, mode: str, host: str | None, limit: int, as_json: bool
) -> int:
    """Verify, print, and give the exit status: 1 if something does not hold."""
    from planner_reactor.calls import adapting

    with reserved_output():
        result = adapting.verify_adaptation(file, process, adapt, mode=mode, host=host, limit=limit)
    if as_json:
        print_json(result)
    else:
        _show(result)
    return int(not all(result[law] for law in LAWS))


def _show(result: dict[str, Any]) -> None:
    print(result["script"])
    for law in LAWS:
        print(f"{law}: {'holds' if result[law] else 'does not hold'}")
    if result["bound_s"] is not None:
        print(f"applied within {result['bound_s']:g} s")
    if result["broken"] is not None:
        print(f"not {result['broken']}: {result['why']}")
    for number, step in enumerate(result["counterexample"], 1):
        if result["cycle"] and number == len(result["counterexample"]) - result["cycle"] + 1:
            print("  and then for ever:")
        print(f"  {number:3}  {step}")
    print(f"{result['states']} states")
