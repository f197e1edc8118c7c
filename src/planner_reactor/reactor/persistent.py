"""A mapping that is a value, and cheap to change: the newest version owns a dict, older ones say what was otherwise.

A reactor of ten thousand reactions is changed by adaptations of a few; whoever holds the structure as it was (a
transaction, an undo) keeps it as it was. Reading the newest costs what a dict costs; reading an older one walks through
the changes since; changing an older one copies. (Baker, "Shallow binding makes functional arrays fast", 1991.)
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, TypeVar

K = TypeVar("K")
V = TypeVar("V")

_ABSENT: Any = object()


class Persistent(Mapping[K, V]):
    """A mapping that never changes: `changed` gives another."""

    __slots__ = ("_held", "_newer", "_was")

    def __init__(self, content: Mapping[K, V]) -> None:
        self._held: dict[K, V] | None = dict(content)
        self._newer: Persistent[K, V] | None = None
        self._was: dict[K, V] = {}  # what was otherwise than in the newer one

    @classmethod
    def of(cls, content: Mapping[K, V]) -> Persistent[K, V]:
        return content if isinstance(content, Persistent) else cls(content)

    def changed(self, puts: Mapping[K, V], without: Iterable[K] = ()) -> Persistent[K, V]:
        """The same without some keys, and then with these."""
        if self._held is None:
            return Persistent(self).changed(puts, without)
        held, gone = self._held, [key for key in without if key in self._held]
        was = {key: held.get(key, _ABSENT) for key in (*gone, *puts)}
        for key in gone:
            del held[key]
        held.update(puts)
        newer: Persistent[K, V] = Persistent({})
        newer._held = held
        self._held, self._newer, self._was = None, newer, was
        return newer

    def keys_changed_until(self, other: Mapping[K, V]) -> set[K] | None:
        """The keys under which `other`, made of this one by changes, may differ; None if it was not made so."""
        keys: set[K] = set()
        version: Persistent[K, V] | None = self
        while version is not None:
            if version is other:
                return keys
            keys.update(version._was)
            version = version._newer
        return None

    def __getitem__(self, key: K) -> V:
        version: Persistent[K, V] = self
        while version._held is None:
            if key in version._was:
                if (value := version._was[key]) is _ABSENT:
                    raise KeyError(key)
                return value
            version = version._newer  # type: ignore[assignment]  # it holds nothing, so there is a newer one
        return version._held[key]

    def get(self, key: K, default: V | None = None) -> V | None:  # type: ignore[override]  # of a type of its own too
        if self._held is not None:
            return self._held.get(key, default)
        return super().get(key, default)

    def __contains__(self, key: object) -> bool:
        return key in self._held if self._held is not None else super().__contains__(key)

    def __iter__(self) -> Iterator[K]:
        return iter(self._whole())

    def __len__(self) -> int:
        return len(self._whole())

    def __repr__(self) -> str:
        return repr(self._whole())

    def _whole(self) -> dict[K, V]:
        """All of it; a new dict if this is not the newest."""
        older: list[dict[K, V]] = []
        version: Persistent[K, V] = self
        while version._held is None:
            older.append(version._was)
            version = version._newer  # type: ignore[assignment]
        if not older:
            return version._held
        whole = dict(version._held)
        for was in reversed(older):
            for key, value in was.items():
                if value is _ABSENT:
                    del whole[key]
                else:
                    whole[key] = value
        return whole
