"""Work that can be paused after every state that it has looked at, so that nobody has to wait for all of it."""

from __future__ import annotations

from collections.abc import Generator
from typing import TypeAlias, TypeVar

T = TypeVar("T")
Looking: TypeAlias = Generator[None, None, T]


def finish(looking: Looking[T]) -> T:
    """All of it at once."""
    while True:
        try:
            next(looking)
        except StopIteration as done:
            found: T = done.value
            return found
