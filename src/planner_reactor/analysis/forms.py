"""Reactions read by their form: one that differs from another in names alone is not parsed again.

A planner that writes the same text for a hundred situations sends a hundred texts of one *form*: the text with its
names numbered in the order in which they come. Reading does not depend on what names are called, as long as different
ones stay different, so a form is parsed once, and what a further text means follows from its names. Only names in plain
lists are numbered (`[a, b + 1]`, `<x>`); a clause with anything else in brackets, or a string, is parsed by itself.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from planner_reactor.analysis.looking import Looking, finish
from planner_reactor.analysis.slicing import is_monitor, unknown_names
from planner_reactor.errors import RSError
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.reactions import REACTION, Reaction, reaction_of
from planner_reactor.rs.terms import Symbol, Text, calls

CLAUSE = re.compile(rf"\s*{REACTION}\[([0-9]+)\] = (.*\S)\s*", re.ASCII)
LIST = re.compile(r"\[[\0\w ,.+*-]*\]|<[\0\w ,]*>", re.ASCII)
"""A list of the plain kind, in which NUL stands for a name."""
NAME = re.compile(r"(?<![\w.])[^\W\d]\w*", re.ASCII)
RESERVED = frozenset({"if", "then", "else"})
SPEAKS = frozenset({"SIT", "ASSERT", "REASSERT", "SUCCEED", "FAIL"})
"""The leaves whose first argument is the name of a situation that a slice may keep."""


PAUSE = 500
"""To read so many characters is work enough at a time: a third of a millisecond."""


class Form:
    """What is common to the reactions of one form. `situations` says which of the names are those of situations."""

    def __init__(self, number: int, reaction: Reaction, names: Sequence[str]) -> None:
        at = {name: n for n, name in enumerate(names)}
        spoken = dict.fromkeys(_situations(reaction))
        self.number = number
        self.situations = tuple(at[name] for name in spoken)
        self.serves = None if reaction.situation is None else at[reaction.situation]
        self.asserts = tuple(at[name] for name in reaction.asserts)
        self.spawns = reaction.spawns
        self.monitors = is_monitor(reaction)
        self.unknown = next(unknown_names(reaction.schema.body), None)


class Known:
    """A reaction known by its form and its names; its text is parsed when its terms are asked for."""

    __slots__ = ("_reaction", "_text", "asserts", "form", "label", "names", "situation")

    def __init__(self, label: int, form: Form, names: Sequence[str], text: str, reaction: Reaction | None) -> None:
        self.label = label
        self.form = form
        self.names = tuple([names[n] for n in form.situations])
        self.situation = None if form.serves is None else names[form.serves]
        self.asserts = tuple([names[n] for n in form.asserts])
        self._text = text
        self._reaction = reaction

    @property
    def reaction(self) -> Reaction:
        """The reaction itself."""
        if self._reaction is None:
            self._reaction = _parsed(self._text)
        return self._reaction


class Forms:
    """The forms that came up."""

    def __init__(self) -> None:
        self._forms: dict[object, tuple[Form, bool]] = {}
        self._layouts: dict[tuple[str, ...], tuple[bool, ...] | None] = {}
        self._others = 0

    def read(self, definitions: str, *, file: str = "<text>") -> list[Known]:
        """The reactions among the definitions. Raises `RSError` if they cannot be read."""
        return finish(self.reading(definitions, file=file))

    def reading(self, definitions: str, *, file: str = "<text>") -> Looking[list[Known]]:
        """The same, with a pause after every `PAUSE` characters, or one longer clause."""
        found: list[Known] = []
        since = 0
        for line in definitions.splitlines():
            since += len(line)
            if since > PAUSE:
                since = len(line)
                yield
            clause = CLAUSE.fullmatch(line)
            known = None if clause is None else self._plain(int(clause[1]), clause[2], line)
            if known is None and line.strip():
                schemas = parse_program(definitions, file=file).schemas
                return [self.known(r) for r in map(reaction_of, schemas) if r is not None]
            if known is not None:
                found.append(known)
        return found

    def known(self, reaction: Reaction) -> Known:
        """A reaction that is a form of its own."""
        self._others -= 1
        names = tuple(dict.fromkeys(_situations(reaction)))
        return Known(reaction.label, Form(self._others, reaction, names), names, "", reaction)

    def _plain(self, label: int, body: str, text: str) -> Known | None:
        """The reaction of one line, if it is a definition of its own in which every list is plain."""
        if '"' in body or "//" in body or "\0" in body or "\1" in body:
            return None
        between = tuple(NAME.split(body))
        if between not in self._layouts:
            self._layouts[between] = _listed(between)
        listed = self._layouts[between]
        if listed is None:
            return None
        numbers: dict[str, int] = {}
        words = [
            numbers.setdefault(word, len(numbers)) if is_listed else word
            for word, is_listed in zip(NAME.findall(body), listed, strict=True)
        ]
        if not RESERVED.isdisjoint(numbers):
            return None
        key = between, tuple(words)
        form = self._forms.get(key)
        if form is None:
            form = self._forms[key] = self._new(_lettered(between, words), tuple([f"n{n}" for n in numbers.values()]))
        return Known(label, form[0], tuple(numbers), text, None) if form[1] else None

    def _new(self, lettered: str, names: tuple[str, ...]) -> tuple[Form, bool]:
        """A new form, and whether it can be read as one."""
        try:
            return Form(len(self._forms), _parsed(f"{REACTION}[0] = {lettered}"), names), True
        except RSError:  # the whole text is parsed instead, which says what is wrong in its own words
            return Form(len(self._forms), _parsed(f"{REACTION}[0] = STOP"), ()), False


def _listed(between: Sequence[str]) -> tuple[bool, ...] | None:
    """Which of the names with this `between` them stand in lists; None if not every list is plain."""
    marked, lists = LIST.subn(lambda found: found[0].replace("\0", "\1"), "\0".join(between))
    if lists != marked.count("[") + marked.count("<"):
        return None
    return tuple([sign == "\1" for sign in marked if sign in "\0\1"])


def _lettered(between: Sequence[str], words: Sequence[str | int]) -> str:
    """The text with the names of lists as `n0`, `n1`, …"""
    texts = [word if isinstance(word, str) else f"n{word}" for word in words]
    return "".join([part for pair in zip(between, [*texts, ""], strict=True) for part in pair])


def _situations(reaction: Reaction) -> Iterator[str]:
    for call in calls(reaction.schema.body):
        match call.arguments:
            case (Symbol(name) | Text(name), *_) if call.name in SPEAKS:
                yield name


def _parsed(text: str) -> Reaction:
    (schema,) = parse_program(text).schemas
    found = reaction_of(schema)
    assert found is not None
    return found
