"""What a caller gives: texts, numbers, choices, places to write to, all checked before anything begins.

A text that cannot be read is refused like one that is wrong, with its place; a place to write to is tried without
leaving a trace in it, so that a long run does not end in front of a locked door.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Collection, Iterable
from math import isfinite
from pathlib import Path

from planner_reactor.errors import Diagnostic, InputError, Place, SourceError, nearest

LARGEST_TEXT = 64_000_000
"""Bytes: what is longer is no text that anybody wrote."""


def read_text(path: str | Path) -> str:
    """The text of a file, lines ended by `\\n`; SourceError if there is none, or it is not UTF-8."""
    file = Path(path)
    try:
        with file.open("rb") as source:
            raw = source.read(LARGEST_TEXT + 1)
    except (OSError, ValueError) as error:
        raise SourceError([_unreadable(file, error)]) from error
    if len(raw) > LARGEST_TEXT:
        raise SourceError([_finding(file, "too-long", "the file is too large", f"at most {LARGEST_TEXT} bytes")])
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise SourceError([_not_text(file, raw, error)]) from error
    return text.replace("\r\n", "\n").replace("\r", "\n")


def seconds(name: str, value: float | None) -> float | None:
    """A number of seconds, 0 or more, or None for no limit."""
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int | float) or not (isfinite(value) and value >= 0):
        raise InputError(f"{name} is {value}, expected a finite number of seconds, 0 or more")
    return float(value)


def whole(name: str, value: int, least: int) -> int:
    """A whole number that is not too small."""
    if isinstance(value, bool) or not isinstance(value, int) or value < least:
        raise InputError(f"{name} is {value}, expected a whole number, {least} or more")
    return value


def one_of(name: str, value: str, available: Collection[str], later: Collection[str] = ()) -> str:
    """One of the choices; what only a later version will have is told apart from what nobody knows."""
    if value in available:
        return value
    there_is = f"there is: {', '.join(available)}"
    if value in later:
        raise InputError(f"{name} {value} is not in this version, {there_is}")
    raise unknown(name, value, [*available, *later])


def names_in(value: str | Iterable[str]) -> tuple[str, ...]:
    """The names in `AQ,AM` or `ACT(cap),AM`; a list of them is taken as it is."""
    if not isinstance(value, str):
        return tuple(value)
    found, depth = [""], 0
    for character in value:
        depth += {"(": 1, ")": -1}.get(character, 0)
        if character == "," and depth <= 0:
            found.append("")
        else:
            found[-1] += character
    return tuple(name.strip() for name in found)


def unknown(what: str, name: str, known: Iterable[str]) -> InputError:
    """The error for a name that is none of those known."""
    listed = list(known)
    hint = nearest(name, listed) or (f"expected one of: {', '.join(listed)}" if listed else "there is none")
    return InputError(f"unknown {what} {name or chr(39) * 2}, {hint}")


def writable_file(path: str | Path, *, called: str) -> Path:
    """A file that could be written; nothing of it is touched yet."""
    file = Path(path)
    if file.is_dir():
        raise InputError(f"{called}: {file} is a directory, expected a file")
    try:
        if file.exists():
            with file.open("ab"):
                return file
        _try_folder(file.parent)
    except (OSError, ValueError) as error:
        raise InputError(f"{called}: {file} cannot be written: {_why(error)}") from error
    return file


def writable_folder(path: str | Path, *, called: str) -> Path:
    """A directory into which files could be written, or that could be made; nothing is made yet."""
    folder = Path(path)
    try:
        there = folder.absolute()
        while not there.exists() and there != there.parent:
            there = there.parent
        if not there.is_dir():
            raise InputError(f"{called}: {there} is a file, expected a directory")
        _try_folder(there)
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{called}: {folder} cannot be written to: {_why(error)}") from error
    return folder


def _try_folder(folder: Path) -> None:
    with tempfile.TemporaryFile(dir=folder):
        """It goes as it came."""


def _unreadable(file: Path, error: OSError | ValueError) -> Diagnostic:
    match error:
        case FileNotFoundError():
            return _finding(file, "unreadable", "no such file", _neighbour(file))
        case IsADirectoryError():
            return _finding(file, "unreadable", "this is a directory", "expected a file")
        case _:
            return _finding(file, "unreadable", f"cannot be read: {_why(error)}")


def _neighbour(file: Path) -> str:
    """The file beside it whose name is nearest."""
    try:
        beside = sorted(os.listdir(file.parent))
    except OSError:
        return f"there is no directory {file.parent}"
    return nearest(file.name, beside)


def _not_text(file: Path, raw: bytes, error: UnicodeDecodeError) -> Diagnostic:
    before = raw[: error.start].decode("utf-8-sig", errors="replace").splitlines(keepends=True)
    last = before[-1] if before and not before[-1].endswith(("\n", "\r")) else ""
    line = len(before) + (0 if last else 1)
    message = f"byte 0x{raw[error.start]:02x} does not belong to a text"
    return Diagnostic(Place(line, len(last) + 1, str(file)), "error", "not-utf-8", message, "expected UTF-8")


def _finding(file: Path, code: str, message: str, hint: str = "") -> Diagnostic:
    return Diagnostic(Place(1, 1, str(file)), "error", code, message, hint)


def _why(error: OSError | ValueError) -> str:
    return (error.strerror or str(error)) if isinstance(error, OSError) else str(error)
