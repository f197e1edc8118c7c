"""Sub-commands that belong to later versions: known by name, so that nobody takes them for slips of the pen."""

from __future__ import annotations

import typer

from planner_reactor.cli.application import command
from planner_reactor.errors import InputError

LATER = {
    "reactor": ("run the reactor as a process of its own.", ""),
    "planner": ("run the planner as a process of its own.", ""),
    "keys": ("make the keys with which both sides know each other.", ""),
    "dashboard": ("look at a run while it goes on.", "run.jsonl"),
}
"""Name: what it will do, and an example of its arguments."""


def _register(name: str, about: str, example: str) -> None:
    def refuse(ctx: typer.Context) -> None:
        raise InputError(f"{name} is not in this version of planner-reactor")

    refuse.__doc__ = f"Not in this version: {about}"
    command(example, name=name, takes_anything=True)(refuse)


for _name, (_about, _example) in LATER.items():
    _register(_name, _about, _example)
