"""Reading TOML with errors a person can act on: file, line, what was expected, the nearest name.

`tomllib` gives the place of a syntax error only; the place of a wrong key or value is found again in the text
(the n-th table of that name, then the key in it), which is right unless the file hides keys in inline tables
or strings.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from planner_reactor.errors import InputError, caret, nearest


class TomlText(msgspec.Struct, frozen=True):
    """A parsed TOML file that still knows its text."""

    file: str
    text: str
    values: Mapping[str, Any]

    def error(self, message: str, *, table: str = "", index: int = 0, key: str = "", hint: str = "") -> InputError:
        """An `InputError` at the key (or head) of the `index`-th table of that name."""
        line, column = self._place(table, index, key)
        shown = self.text.splitlines()[line - 1] if self.text else ""
        head = f"{self.file}:{line}:{column}: {message}" + (f", {hint}" if hint else "")
        return InputError(f"{head}\n    {shown}\n    {caret(shown, column)}" if shown else head)

    def _place(self, table: str, index: int, key: str) -> tuple[int, int]:
        lines = self.text.splitlines()
        start = self._head(lines, table, index)
        if not key:
            return start + 1, 1
        for number in range(start + bool(table), len(lines)):
            if table and re.match(r"\s*\[", lines[number]):
                break
            found = re.match(rf"""\s*["']?({re.escape(key)})["']?\s*=""", lines[number])
            if found:
                return number + 1, found.start(1) + 1
        return start + 1, 1

    def _head(self, lines: list[str], table: str, index: int) -> int:
        if not table:
            return 0
        head = re.compile(rf"\s*\[\[?\s*{re.escape(table)}\s*\]\]?")
        heads = [number for number, line in enumerate(lines) if head.match(line)]
        return heads[index] if index < len(heads) else 0


def read_toml(path: Path) -> TomlText:
    """The file, parsed; raises InputError with the place of a syntax error, or why it cannot be read."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read: {error}") from error
    return parse_toml(text, file=str(path))


def parse_toml(text: str, *, file: str = "<text>") -> TomlText:
    """As `read_toml`, from text."""
    try:
        return TomlText(file, text, tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise InputError(_syntax_error(str(error), text, file)) from error


def _syntax_error(message: str, text: str, file: str) -> str:
    lines = text.split("\n")
    found = re.search(r"^(.*) \(at line (\d+), column (\d+)\)$", message)
    if found is not None:
        message, line, column = found[1], int(found[2]), int(found[3])
    else:
        while len(lines) > 1 and not lines[-1].strip():
            lines.pop()
        line, column = len(lines), len(lines[-1]) + 1
        message = message.replace("(at end of document)", "at the end of the file")
    shown = lines[line - 1] if line <= len(lines) else ""
    return f"{file}:{line}:{column}: {message}\n    {shown}\n    {caret(shown, column)}"


@dataclass(slots=True)
class Fields:
    """The fields of one table, taken one by one; `done` refuses what nobody took."""

    source: TomlText
    table: str
    index: int
    values: Mapping[str, Any]
    known: tuple[str, ...]

    def refuse_unknown(self) -> None:
        """Raises InputError for the first key that is not in `known`."""
        for key in self.values:
            if key not in self.known:
                hint = nearest(key, self.known) or f"expected one of: {', '.join(self.known)}"
                raise self.error(f"unknown key '{key}'" + (f" in [{self.table}]" if self.table else ""), key, hint)

    def take(self, key: str, default: Any, *, low: float | None = None, high: float | None = None) -> Any:
        """The value of `key`, of the default's type (an int serves as float), or the default; checked for
        range.
        """
        if key not in self.values:
            return default
        value = typed(self.values[key], default)
        if value is None:
            expected = kind_name(default)
            raise self.error(f"'{key}' is {self.values[key]!r}", key, f"expected {expected}")
        if (low is not None and value < low) or (high is not None and value > high):
            bounds = f"at least {low:g}" if high is None else f"from {low if low is not None else 0:g} to {high:g}"
            raise self.error(f"'{key}' is {value!r}", key, f"expected {bounds}")
        return value

    def one_of(self, key: str, default: str, names: Iterable[str]) -> str:
        """A string that must be one of the names."""
        value: str = self.take(key, default)
        choices = tuple(names)
        if key in self.values and value not in choices:
            hint = nearest(value, choices) or f"expected one of: {', '.join(choices)}"
            raise self.error(f"unknown {key} '{value}'", key, hint)
        return value

    def names(self, key: str, default: tuple[str, ...]) -> tuple[str, ...]:
        """A list of distinct, usable names."""
        if key not in self.values:
            return default
        value = self.values[key]
        if not isinstance(value, list) or not all(isinstance(v, str) and v.isidentifier() for v in value):
            raise self.error(f"'{key}' is {value!r}", key, "expected a list of names (letters, digits, _)")
        if len(set(value)) < len(value):
            raise self.error(f"'{key}' names something twice", key)
        return tuple(value)

    def error(self, message: str, key: str = "", hint: str = "") -> InputError:
        """An `InputError` at this key of this table."""
        return self.source.error(message, table=self.table, index=self.index, key=key, hint=hint)


def typed(value: Any, like: Any) -> Any:
    """The value as the type of `like` (int → float is allowed, bool is no number), or None if it is another
    type.
    """
    if isinstance(like, bool) or isinstance(value, bool):
        return value if isinstance(like, bool) and isinstance(value, bool) else None
    if isinstance(like, float) and isinstance(value, int | float):
        return float(value)
    return value if isinstance(value, type(like)) else None


def kind_name(like: Any) -> str:
    """How a person calls the type of a value."""
    return {bool: "true or false", int: "a whole number", float: "a number", str: "a string"}.get(type(like), "a table")
