"""The command `planner-reactor`: a thin layer over `planner_reactor.calls`.

Each sub-command reads its options, makes the call of the same name, and prints what it returns: with `--json` one
object on standard output, else text. Exit status: 0 done, 1 what was checked does not hold, 2 bad input (one message,
with place, cause and nearest name; never a traceback), 130 interrupted. A reader that went away ends it quietly.
"""

from __future__ import annotations

import os
import re
import signal
import sys
import traceback
from collections.abc import Sequence
from contextlib import suppress

import typer
from typer.main import get_command

from planner_reactor.cli import (
    derivations,
    evolutions,
    later,
    loops,
    measures,
    plans,
    programs,
    systems,
    verification,
)
from planner_reactor.cli.application import NAME, ORDER, app
from planner_reactor.cli.printing import print_json
from planner_reactor.errors import PlannerReactorError, nearest

__all__ = [
    "app", "derivations", "evolutions", "later", "loops", "main", "measures", "plans", "programs", "systems",
    "verification",
]  # fmt: skip

INTERRUPTED, PIPE_BROKEN = 128 + signal.SIGINT, 128 + 13
"""What a shell makes of SIGINT, and of SIGPIPE where there is one."""
TRACEBACK = "PLANNER_REACTOR_TRACEBACK"
"""Set in the environment: errors come with the traceback of Python."""

ClickException: type[Exception] = typer.BadParameter.__mro__[2]
"""What is wrong with a command line, wherever this version of typer keeps its base."""

app.registered_commands.sort(key=lambda registered: ORDER.index(str(registered.name)))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command with these arguments (default: those of the process); the exit status."""
    given = list(sys.argv[1:] if arguments is None else arguments) or ["--help"]
    _prepare_streams()
    if "" not in sys.path:
        sys.path.append("")  # a host may stand in the current directory; it hides nothing that is installed
    try:
        status = _invoke(given)
        sys.stdout.flush()
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:
        _abandon_output()
        return PIPE_BROKEN
    except OSError as error:
        _abandon_output()
        print(f"standard output: {error.strerror}", file=sys.stderr)
        return 2
    return status


def _prepare_streams() -> None:
    """What a stream cannot encode is shown in another way; a closed one takes everything and keeps nothing."""
    sys.stdout = sys.stdout or open(os.devnull, "w")  # noqa: SIM115  # as long as the process lives
    sys.stderr = sys.stderr or open(os.devnull, "w")  # noqa: SIM115
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")


def _invoke(given: list[str]) -> int:
    command = get_command(app)
    try:
        with command.make_context(NAME, given) as context:
            status = command.invoke(context)
    except typer.Exit as ending:
        return ending.exit_code
    except BrokenPipeError:
        raise
    except ClickException as error:
        return _refuse(_of_usage(error), given)
    except SystemExit as error:
        return _refuse(f"code of a host ended the run: SystemExit: {error.code}", given)
    except PlannerReactorError as error:
        return _refuse(str(error), given)
    except OSError as error:
        return _refuse(f"{error.filename or NAME}: {error.strerror or error}", given)
    except Exception as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        where = f"{last.filename}:{last.lineno}"
        said = f"{type(error).__name__}: {error}".splitlines()[0]
        return _refuse(f"{NAME} itself failed: {said} ({where}); {TRACEBACK}=1 shows more", given)
    return status if isinstance(status, int) else 0


def _refuse(message: str, given: list[str]) -> int:
    """Say what cannot be used; whoever asked for an object gets one."""
    if TRACEBACK in os.environ:
        traceback.print_exc()
    print(message, file=sys.stderr)
    if "--json" in given:
        print_json({"error": message})
        sys.stdout.flush()
    return 2


def _of_usage(error: BaseException) -> str:
    """What is wrong with the command line, the nearest name, and where to read how it should be."""
    said = error.format_message() if hasattr(error, "format_message") else str(error)
    context = getattr(error, "ctx", None)
    path = context.command_path if context is not None else NAME
    message, hint = said.split(".", 1)[0], ""
    if (option := getattr(error, "option_name", None)) is not None and context is not None:
        message = f"no such option {option}"
        hint = nearest(option, [name for parameter in context.command.params for name in parameter.opts])
    elif (slip := re.fullmatch(r"No such command '(.*)'", message)) is not None:
        message, hint = f"no such sub-command {slip[1]}", nearest(slip[1], ORDER)
    else:
        message = said.removesuffix(".")
    told = f"{message[:1].lower()}{message[1:]}" + (f", {hint}" if hint else "")
    return f"{path}: {told} ({path} --help tells more)"


def _abandon_output() -> None:
    """Nobody reads any more: what is still buffered must not complain when Python ends."""
    void = os.open(os.devnull, os.O_WRONLY)
    with suppress(OSError, ValueError):
        os.dup2(void, sys.stdout.fileno())
