"""What a journal asks of a disk, and the disk that is a file.

Narrow, so that a simulated disk can tear, fill and lose (docs/reactor.md, "The journal"): what was appended is durable
only after `sync`; `replace` is durable when it returns, and wholly or not at all.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Protocol

from planner_reactor.errors import DiskError


class Disk(Protocol):
    """Where one journal is kept. Each method raises `DiskError` if it cannot do what it says."""

    def read(self) -> bytes:
        """All that is there; empty if there is nothing yet."""

    def append(self, content: bytes) -> None:
        """Add to what is there. Not durable before `sync`; a failure may leave a part of it."""

    def sync(self) -> None:
        """What was appended survives a crash from here on."""

    def replace(self, content: bytes) -> None:
        """Put this in the place of all that is there."""

    def set_aside(self, content: bytes) -> None:
        """Keep what was found damaged, for people to look at."""


class NoDisk:
    """Nothing is kept: a reactor that begins anew each time it is started."""

    def read(self) -> bytes:
        return b""

    def append(self, content: bytes) -> None:
        """Forgotten."""

    def sync(self) -> None:
        """Nothing to do."""

    def replace(self, content: bytes) -> None:
        """Forgotten."""

    def set_aside(self, content: bytes) -> None:
        """Forgotten."""


class FileDisk:
    """A journal in a file, with its directory entry made durable as well."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file: int | None = None

    def read(self) -> bytes:
        try:
            return self.path.read_bytes()
        except FileNotFoundError:
            return b""
        except OSError as problem:
            raise DiskError(f"{self.path}: {problem.strerror}") from problem

    def append(self, content: bytes) -> None:
        with self._said():
            if self._file is None:
                self._file = os.open(self.path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o644)
            _write(self._file, content)

    def sync(self) -> None:
        if self._file is not None:
            with self._said():
                _sync(self._file)

    def replace(self, content: bytes) -> None:
        with self._said():
            self._put(self.path, content)
        self.close()

    def set_aside(self, content: bytes) -> None:
        number = 1
        while (path := self.path.with_name(f"{self.path.name}.damaged-{number}")).exists():
            number += 1
        with self._said():
            self._put(path, content)

    def close(self) -> None:
        """Let go of the file; the next append opens it again."""
        if self._file is not None:
            os.close(self._file)
            self._file = None

    def _put(self, path: Path, content: bytes) -> None:
        """Beside it first, then renamed: whoever reads sees the old content or the new one."""
        beside = path.with_name(f"{path.name}.new")
        file = os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
        try:
            _write(file, content)
            _sync(file)
        finally:
            os.close(file)
        os.replace(beside, path)
        directory = os.open(path.parent, os.O_RDONLY)
        try:
            os.fsync(directory)
        finally:
            os.close(directory)

    @contextmanager
    def _said(self) -> Iterator[None]:
        try:
            yield
        except OSError as problem:
            raise DiskError(f"{self.path}: {problem.strerror}") from problem


def _write(file: int, content: bytes) -> None:
    rest = memoryview(content)
    while rest:
        rest = rest[os.write(file, rest) :]


def _sync(file: int) -> None:
    getattr(os, "fdatasync", os.fsync)(file)
