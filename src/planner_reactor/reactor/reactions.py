"""The reactions of a running reactor by label, indexed by what they serve and assert.

What an adaptation asks of the structure (who serves this situation, who asserts it, is it asserted from below itself)
concerns a few reactions of ten thousand: answers cost what they concern.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, MutableMapping

from planner_reactor.rs.reactions import REACTION, Reaction
from planner_reactor.rs.terms import Schema


class Reactions(MutableMapping[int, Reaction]):
    """Label → reaction, in the order in which they came."""

    def __init__(self, reactions: Iterable[Reaction] = ()) -> None:
        self._by_label: dict[int, Reaction] = {}
        self._serving: dict[str, dict[int, None]] = {}
        self._asserting: dict[str, dict[int, None]] = {}
        self._touched: set[int] = set()
        for reaction in reactions:
            self[reaction.label] = reaction

    @classmethod
    def of(cls, reactions: Mapping[int, Reaction]) -> Reactions:
        return reactions if isinstance(reactions, Reactions) else cls(reactions.values())

    def __getitem__(self, label: int) -> Reaction:
        return self._by_label[label]

    def __setitem__(self, label: int, reaction: Reaction) -> None:
        if label in self._by_label:
            del self[label]
        self._by_label[label] = reaction
        self._touched.add(label)
        if reaction.situation is not None:
            self._serving.setdefault(reaction.situation, {})[label] = None
        for name in reaction.asserts:
            self._asserting.setdefault(name, {})[label] = None

    def __delitem__(self, label: int) -> None:
        reaction = self._by_label.pop(label)
        self._touched.add(label)
        if reaction.situation is not None:
            _left(self._serving, reaction.situation, label)
        for name in reaction.asserts:
            _left(self._asserting, name, label)

    def __iter__(self) -> Iterator[int]:
        return iter(self._by_label)

    def __len__(self) -> int:
        return len(self._by_label)

    def __contains__(self, label: object) -> bool:
        return label in self._by_label

    def serving(self, situation: str) -> tuple[Reaction, ...]:
        """The reactions that serve a situation."""
        return tuple([self._by_label[label] for label in self._serving.get(situation, ())])

    def asserting(self, situation: str) -> tuple[Reaction, ...]:
        """The reactions that assert a situation."""
        return tuple([self._by_label[label] for label in self._asserting.get(situation, ())])

    def clauses(self, name: str) -> tuple[Schema, ...]:
        """The definitions of a name: `P` has one for each reaction, no other name has any."""
        return tuple(reaction.schema for reaction in self._by_label.values()) if name == REACTION else ()

    def touched(self) -> set[int]:
        """The labels under which something came or went since this was asked last."""
        if not (touched := self._touched):
            return set()
        self._touched = set()
        return touched


def _left(index: dict[str, dict[int, None]], name: str, label: int) -> None:
    labels = index[name]
    labels.pop(label, None)
    if not labels:
        del index[name]
