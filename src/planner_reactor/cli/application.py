"""The command itself, to which each module beside this one adds its sub-commands."""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import version
from typing import Annotated, TypeVar

import typer

NAME = "planner-reactor"
ORDER = (
    "kit", "loop", "run", "check", "plan", "network", "experiment", "bench",
    "evolve", "limits", "lts", "verify", "dynamics", "reactor", "planner", "keys", "dashboard",
)  # fmt: skip
"""The sub-commands as the help lists them."""

Command = TypeVar("Command", bound=Callable[..., object])

app = typer.Typer(
    name=NAME,
    help="Robot programs that start acting at once, keep improving while they run, and know what they assume.",
    epilog="\b\nExample:\n  planner-reactor kit --trays 5 --seed 1",
    add_completion=False,
    no_args_is_help=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def command(*examples: str, name: str | None = None, takes_anything: bool = False) -> Callable[[Command], Command]:
    """Makes a function a sub-command, whose help ends with these examples (arguments only)."""

    def register(function: Command) -> Command:
        own = name or function.__name__
        shown = "\n".join(f"  {NAME} {own} {example}".rstrip() for example in examples)
        settings = {"ignore_unknown_options": True, "allow_extra_args": True} if takes_anything else None
        heading = "Example" if len(examples) == 1 else "Examples"
        app.command(own, epilog=f"\b\n{heading}:\n{shown}", context_settings=settings)(function)
        return function

    return register


def _print_version(asked: bool) -> None:
    if asked:
        print(f"{NAME} {version(NAME)}")
        raise typer.Exit


@app.callback()
def everything(
    _version: Annotated[
        bool, typer.Option("--version", help="Print the version.", callback=_print_version, is_eager=True)
    ] = False,
) -> None:
    """What comes before the sub-command."""
