"""Finds the host that a caller names: a module, or a file `*.py`, with an attribute `host`.

That is a `Host`, or something that makes one for each run: it is called with the run's scheduler and, as far as it
has parameters of these names, with `trace`, `target` (finish after so many) and `kit`. Code of a host is trusted;
what goes wrong in it while it is loaded is told with its place, not as a traceback.
"""

from __future__ import annotations

import inspect
import sys
import traceback
from collections.abc import Callable
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any, TypeAlias

import msgspec

from planner_reactor.errors import InputError, nearest
from planner_reactor.runtime.host import Host
from planner_reactor.runtime.scheduler import Scheduler

HostSource: TypeAlias = str | Host | Callable[..., Host]
"""The name of a module or file, a host, or what makes one."""


class HostMaker(msgspec.Struct, frozen=True):
    """Makes the host of one run. `takes`: what it can be told beside the scheduler."""

    name: str
    make: Callable[..., Host]
    takes: frozenset[str]

    def __call__(self, scheduler: Scheduler, **told: Any) -> Host:
        """The host; what it has no parameter for is not told. InputError if it cannot be made."""
        known = {key: value for key, value in told.items() if key in self.takes}
        try:
            made = self.make(scheduler, **known)
        except InputError:
            raise
        except Exception as error:
            raise InputError(f"host {self.name} cannot be made: {_told(error)}") from error
        if not isinstance(made, Host):
            raise InputError(f"host {self.name} made a {type(made).__name__}, expected a Host")
        return made


def find_host(source: HostSource) -> HostMaker:
    """What makes the host; InputError if there is none."""
    if isinstance(source, str):
        return _found(source, _offered(source))
    return _found(getattr(source, "name", getattr(source, "__name__", "given")), source)


def _found(name: str, host: object) -> HostMaker:
    if isinstance(host, Host):
        return HostMaker(name, lambda scheduler: host, frozenset())
    if not callable(host):
        raise InputError(
            f"host {name}: `host` is a {type(host).__name__}, expected a Host or a function of a scheduler"
        )
    return HostMaker(name, host, _keywords(host))


def _keywords(make: Callable[..., Host]) -> frozenset[str]:
    try:
        parameters = inspect.signature(make).parameters.values()
    except (TypeError, ValueError):
        return frozenset()
    if any(p.kind is p.VAR_KEYWORD for p in parameters):
        return frozenset({"trace", "target", "kit"})
    return frozenset(p.name for p in parameters if p.kind in (p.KEYWORD_ONLY, p.POSITIONAL_OR_KEYWORD))


def _offered(name: str) -> object:
    """The attribute `host` of the module."""
    module = _imported(name)
    if hasattr(module, "host"):
        return module.host
    public = [attribute for attribute in vars(module) if not attribute.startswith("_")]
    hint = nearest("host", public) or "expected a Host, or a function that makes one for a scheduler"
    raise InputError(f"host {name} has no attribute `host`, {hint}")


def _imported(name: str) -> ModuleType:
    try:
        if name.endswith(".py"):
            return _from_file(Path(name))
        if not all(part.isidentifier() for part in name.split(".")):
            raise InputError(f"host {name!r} is not the name of a module, expected MODULE or FILE.py")
        return import_module(name)
    except InputError:
        raise
    except ModuleNotFoundError as error:
        if error.name is not None and (name == error.name or name.startswith(error.name + ".")):
            raise InputError(_no_module(name, error.name)) from error
        raise InputError(f"host {name} cannot be imported: {_told(error)}") from error
    except (Exception, SystemExit) as error:
        raise InputError(f"host {name} cannot be imported: {_told(error)}") from error


def _from_file(file: Path) -> ModuleType:
    if not file.is_file():
        raise InputError(f"host {file}: no such file")
    name = f"host of {file}"  # so that it stands in nobody's way
    spec = spec_from_file_location(name, file)
    if spec is None or spec.loader is None:
        raise InputError(f"host {file} is not a module")
    module = sys.modules[name] = module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module


def _no_module(name: str, missing: str) -> str:
    """Which part is missing, and the nearest name beside it."""
    above, _, last = missing.rpartition(".")
    try:
        folders = list(import_module(above).__path__) if above else sys.path
    except Exception:
        folders = []
    beside = [
        entry.name.removesuffix(".py")
        for folder in map(Path, folders)
        if folder.is_dir()
        for entry in folder.iterdir()
        if entry.suffix == ".py" or (entry / "__init__.py").is_file()
    ]
    hint = nearest(last, sorted(beside))
    where = f"no module {missing}" if missing != name else "no such module"
    return f"host {name}: {where}" + (f", {hint}" if hint else "")


def _told(error: BaseException) -> str:
    """An exception in one line, with the place where it was raised."""
    if isinstance(error, SyntaxError):
        return f"{error.filename}:{error.lineno}:{error.offset}: {error.msg}"
    frames = traceback.extract_tb(error.__traceback__)
    where = f" ({frames[-1].filename}:{frames[-1].lineno})" if frames else ""
    return f"{type(error).__name__}: {error}{where}"
