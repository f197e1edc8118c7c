"""Run tests on a mutant: the changed module is imported, in a process of its own, in the place of the real one.

The working tree is not touched. A child is forked from a parent that knows the code of all modules but has imported
none of them; it loads the mutant, calls the test functions one after the other, and stops at the first that fails.
What it may use of the processor and of memory is limited: a mutant that goes round for ever counts as found.
"""

from __future__ import annotations

import ast
import contextlib
import importlib.abc
import importlib.machinery
import importlib.util
import inspect
import itertools
import os
import resource
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from importlib.readers import FileReader
from pathlib import Path
from types import CodeType, ModuleType, SimpleNamespace

ROOT = Path(__file__).parents[2]
PLACES = {"planner_reactor": ROOT / "src", "tests": ROOT}

CPU = 1.5
"""Seconds of processor time that a mutant may spend in one test (the longest needs half of one)."""

MEMORY = 2_000_000_000
"""Bytes that a mutant may use."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """What became of a mutant: `killed` by a test, `survived`, or `stillborn` (it cannot be loaded)."""

    fate: str
    by: str = ""
    problem: str = ""


class Code(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Finds the modules of this repository; compiles each once, so that children share the work."""

    def __init__(self) -> None:
        self._compiled: dict[str, CodeType] = {}
        self.changed: dict[str, CodeType] = {}

    def shared(self) -> Code:
        """Another that knows what this one has compiled, with changes of its own."""
        other = Code()
        other._compiled = self._compiled
        return other

    def file(self, name: str) -> Path | None:
        """Where a module stands, if it is one of ours."""
        top = PLACES.get(name.partition(".")[0])
        if top is None:
            return None
        plain = top.joinpath(*name.split("."))
        return next((f for f in (plain / "__init__.py", plain.with_suffix(".py")) if f.is_file()), None)

    def code(self, name: str) -> CodeType:
        """The code of a module: the mutant's, if it is the one."""
        if name in self.changed:
            return self.changed[name]
        if name not in self._compiled:
            file = self.file(name)
            assert file is not None
            self._compiled[name] = compile(file.read_text(encoding="utf-8"), str(file), "exec")
        return self._compiled[name]

    def find_spec(self, name: str, path: object = None, target: object = None) -> importlib.machinery.ModuleSpec | None:
        file = self.file(name)
        if file is None:
            return None
        within = [str(file.parent)] if file.name == "__init__.py" else None
        return importlib.util.spec_from_file_location(name, file, loader=self, submodule_search_locations=within)

    def exec_module(self, module: ModuleType) -> None:
        exec(self.code(module.__name__), module.__dict__)

    def get_resource_reader(self, name: str) -> FileReader:
        """The files beside a package's modules."""
        return FileReader(SimpleNamespace(path=str(self.file(name))))

    def warm(self, tests: Sequence[str]) -> None:
        """Compile, once for all children, what these test modules import; import what is not ours."""
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            os.close(reading)
            sys.meta_path.insert(0, self)
            forget()
            with contextlib.suppress(BaseException):
                for name in tests:
                    importlib.import_module(name)
            with os.fdopen(writing, "w") as said:
                said.write("\n".join(sys.modules))
            os._exit(0)
        os.close(writing)
        with os.fdopen(reading) as said:
            names = said.read().split()
        os.waitpid(child, 0)
        for name in names:
            if self.file(name) is not None:
                self.code(name)
            elif name not in sys.modules and not name.startswith(("__", "_virtualenv")):
                with contextlib.suppress(Exception):
                    importlib.import_module(name)


def forget() -> None:
    """No module of ours has been imported in this process."""
    for name in [n for n in sys.modules if n.partition(".")[0] in PLACES and not n.startswith("tests.mutants")]:
        if name != "tests":
            del sys.modules[name]


def judged(code: Code, name: str, mutant: ast.Module, tests: Sequence[str], *, first: str = "") -> Verdict:
    """Import a mutant under the name of its module, and call the tests on it; `first` the test of this name."""
    try:
        compiled = compile(mutant, f"<mutant of {name}>", "exec")
    except (SyntaxError, ValueError, TypeError) as problem:
        return Verdict("stillborn", problem=str(problem))
    code.changed = {name: compiled}
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        with os.fdopen(writing, "w") as said:
            _live(code, name, tests, first, said.write)
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as said:
        heard = said.read()
    _, status = os.waitpid(child, 0)
    code.changed = {}
    return _verdict(heard, status)


def _verdict(heard: str, status: int) -> Verdict:
    *begun, last = heard.split("\n")
    current = next((line.removeprefix("at ") for line in reversed(begun) if line.startswith("at ")), "")
    if last.startswith("failed "):
        return Verdict("killed", current, last.removeprefix("failed "))
    if last == "survived":
        return Verdict("survived")
    if last.startswith("stillborn "):
        return Verdict("stillborn", problem=last.removeprefix("stillborn "))
    signalled = signal.Signals(status & 127).name if status & 127 else "ended"
    return Verdict("killed", current or "import", f"no end: {signalled}")


def _live(code: Code, name: str, tests: Sequence[str], first: str, say: Callable[[str], object]) -> None:
    """In the child: load, test, tell."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    sys.meta_path.insert(0, code)
    forget()
    told = sys.stdout
    sys.stdout = sys.stderr = open(os.devnull, "w")  # noqa: SIM115
    try:
        importlib.import_module(name)
    except BaseException as problem:
        say(f"stillborn {type(problem).__name__}: {problem}".replace("\n", " "))
        return
    try:
        for label, test in _ordered(tests, first):
            _flushed(say, f"at {label}\n")
            signal.setitimer(signal.ITIMER_VIRTUAL, CPU)
            test()
        say("survived")
    except BaseException as problem:
        say(f"failed {type(problem).__name__}: {str(problem)[:200]}".replace("\n", " "))
    finally:
        sys.stdout = told


def _flushed(say: Callable[[str], object], text: str) -> None:
    say(text)
    getattr(say, "__self__").flush()  # noqa: B009


def _ordered(tests: Sequence[str], first: str) -> Iterator[tuple[str, Callable[[], object]]]:
    module = first.partition(":")[0]
    if module:
        yield from ((label, test) for label, test in _calls(module) if label == first)
    for name in tests:
        yield from _calls(name)


def _calls(name: str) -> Iterator[tuple[str, Callable[[], object]]]:
    """The tests of a module, in order, for each of their parameters, but those that ask for a fixture."""
    module = importlib.import_module(name)
    for test in list(vars(module).values()):
        if callable(test) and getattr(test, "__name__", "").startswith("test_") and test.__module__ == name:
            label = f"{name}:{test.__name__}"
            for keywords in _parameters(test):
                if set(inspect.signature(test).parameters) - set(keywords):
                    continue
                yield label, lambda test=test, keywords=keywords: test(**keywords)


def _parameters(test: Callable[..., object]) -> Iterator[dict[str, object]]:
    """The calls that a test function is parametrised for."""
    choices = []
    for mark in getattr(test, "pytestmark", []):
        if mark.name == "parametrize":
            names, rows = mark.args[0], list(mark.args[1])
            single = isinstance(names, str) and "," not in names
            split = [names] if single else ([n.strip() for n in names.split(",")] if isinstance(names, str) else names)
            choices.append([dict(zip(split, (row,) if single else row, strict=True)) for row in rows])
    for chosen in itertools.product(*choices):
        yield {name: value for part in chosen for name, value in part.items()}
