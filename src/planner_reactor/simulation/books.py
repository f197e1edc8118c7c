"""The planner's book: what it asked for, what was answered, and what the reactor must therefore be like.

Kept as a planner keeps it on disk. It is the other side of the reactor's journal: once all is answered, both must say
the same (the ledger of adaptations).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Container, Mapping

import msgspec

from planner_reactor.link.messages import Adaptation
from planner_reactor.reactor.committed import Committed, clauses_of


class Node(msgspec.Struct, frozen=True):
    """A situation: the label of its reaction, of the root that asserts it, and what it needs."""

    name: str
    label: int
    root: int
    children: tuple[str, ...] = ()


class Pending(msgspec.Struct, frozen=True):
    """An adaptation that was issued and not answered."""

    adaptation: Adaptation
    nodes: Mapping[str, Node | None]
    wrong: str = ""  # what is wrong with it: then it must be refused


Key = tuple[int, int]
"""Epoch and id."""


class Book:
    """Counts: issued = applied + refused + timed out + pending."""

    def __init__(self) -> None:
        self.epoch = 1
        self.next_label = 0
        self.nodes: dict[str, Node] = {}
        self.versions: dict[str, int] = {}
        self.clauses: dict[int, str] = {}
        self.pending: dict[Key, Pending] = {}
        self.issued: dict[Key, Adaptation] = {}
        self.counts: Counter[str] = Counter()
        self.wrong: list[str] = []  # answers that cannot be
        self.outcomes: dict[Key, str] = {}  # what became of those that are not pending
        self._next_id = 1
        self._succeeds = False

    def new_id(self) -> int:
        self._next_id += 1
        return self._next_id - 1

    def take_over(self) -> None:
        """Another planner goes on with the book: once all is settled that was asked before, in an epoch of its own."""
        self._succeeds = True

    def settled(self) -> bool:
        """May something new be asked for?"""
        if self._succeeds and not self.pending:
            self.epoch, self._next_id, self._succeeds = self.epoch + 1, 1, False
        return not self._succeeds

    @property
    def touched(self) -> set[str]:
        """Situations that something pending changes, or counts on."""
        found: set[str] = set()
        for p in self.pending.values():
            found.update(p.nodes)
            for node in p.nodes.values():
                found.update(node.children if node else ())
        return found

    def removable(self, name: str) -> bool:
        """Does nothing else assert it, or will?"""
        coming = [n for p in self.pending.values() for n in p.nodes.values() if n]
        return not any(name in node.children for node in (*self.nodes.values(), *coming))

    def issue(self, adaptation: Adaptation, nodes: Mapping[str, Node | None], wrong: str = "") -> None:
        """It is in the book before it is sent."""
        self.counts["issued"] += 1
        key = (adaptation.epoch, adaptation.id)
        if key in self.issued:  # an id that was used before: it must be refused, and nobody counts on more
            self.counts["repeats"] += 1
            self.counts["issued"] -= 1
            return
        self.issued[key] = adaptation
        self.pending[key] = Pending(adaptation, nodes, wrong)

    def answered(self, key: Key, outcome: str) -> bool:
        """What became of it: applied, refused or timed out. False if nothing was asked, or it was answered before."""
        if (found := self.pending.pop(key, None)) is None:
            if outcome == "applied" != (before := self.outcomes.get(key, outcome)):
                self.wrong.append(f"adaptation {key} is applied, and was {before} before")
            return False
        self.counts[outcome] += 1
        self.outcomes[key] = outcome
        if outcome == "applied":
            if found.wrong:
                self.wrong.append(f"adaptation {key} is wrong ({found.wrong}) and was applied: {found.adaptation}")
            self._apply(found)
        return True

    def _apply(self, pending: Pending) -> None:
        adaptation = pending.adaptation
        for name, node in pending.nodes.items():
            self.versions[name] = self.versions.get(name, 0) + 1
            if node is None:
                self.nodes.pop(name, None)
            else:
                self.nodes[name] = node
        for label in adaptation.kills:
            self.clauses.pop(label, None)
        self.clauses |= clauses_of(adaptation)

    def settle(
        self, standing: Mapping[str, int], lost: Callable[[Key], bool], labels: Container[int] | None = None
    ) -> None:
        """Somebody says which versions stand: what is in them was applied, what was `lost` was not.

        What changes no situation (a monitor comes or goes) is told by the `labels` that stand.
        """
        for key, found in list(self.pending.items()):
            after = {c.situation: c.base + 1 for c in found.adaptation.changes}
            after |= {s: self.versions.get(s, 0) + 1 for s in found.adaptation.removed}
            stands = all(standing.get(s, 0) == v for s, v in after.items())
            if not after:
                stands = labels is not None and _stands(found.adaptation, labels)
            if stands and not found.wrong:
                self.answered(key, "applied")
            elif lost(key):
                self.answered(key, "lost")

    def difference(self, committed: Committed) -> str:
        """What the reactor's journal says otherwise than this book; "" if nothing."""
        if dict(committed.versions) != self.versions:
            return f"versions: the planner's {self.versions}, the reactor's {dict(committed.versions)}"
        if dict(committed.clauses) != self.clauses:
            odd = sorted({*committed.clauses} ^ {*self.clauses})
            return f"reactions {odd} are in one book only"
        return ""


def _stands(adaptation: Adaptation, labels: Container[int]) -> bool:
    return all(n in labels for n in adaptation.adds) and not any(n in labels for n in adaptation.kills)
