"""The coarsest partition of states that nobody can tell apart: strong, and branching with divergence.

Signature refinement: the signature of a state is what it offers, seen through the present classes; states that share a
class and a signature stay together, until nothing is split any more.

    strong     S. Blom, S. Orzan, Distributed branching bisimulation reduction of state spaces, 2003, section 3:
               sig(s) = {(a, [t]) | s -a-> t}
    branching  the same, section 4: sig(s) = {(a, [t]) | s =hidden, inside [s]=> s' -a-> t, and a is not hidden or
               [t] is not [s]}, with a mark for a state that can stay inside its class for ever (divergence)

How a state has ended counts as an offer of its own. For strong bisimilarity only states with a successor that changed
its class are looked at again.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from typing import TypeAlias, TypeVar

Labelled = TypeVar("Labelled", bound=Hashable)
Moves: TypeAlias = Sequence[Sequence[tuple[Labelled, int]]]
"""`moves[i]` are the (label, next state) pairs of state i."""

Signature: TypeAlias = frozenset[tuple[Hashable, int]]

_ENDS = "ends"
_DIVERGES = ("diverges", -1)


def strong(moves: Moves[Labelled], ends: Sequence[Hashable]) -> list[int]:
    """The class of each state under strong bisimilarity; classes are numbered in order of their first state."""
    before: list[list[int]] = [[] for _ in moves]
    for here, m in enumerate(moves):
        for _, after in m:
            before[after].append(here)
    partition = _Partition(_numbered(ends))
    dirty = set(range(len(moves)))
    while dirty:
        classes = partition.classes
        changed = partition.split({i: frozenset((label, classes[s]) for label, s in moves[i]) for i in sorted(dirty)})
        dirty = {p for i in changed for p in before[i]}
    return _numbered(partition.classes)


def branching(
    moves: Moves[Labelled], ends: Sequence[Hashable], hidden: Callable[[Labelled], bool]
) -> list[int]:
    """The class of each state under divergence-preserving branching bisimilarity."""
    silent = [[s for label, s in m if hidden(label)] for m in moves]
    loud = [[(label, s) for label, s in m if not hidden(label)] for m in moves]
    classes = [0] * len(moves)
    while True:
        signatures = _branching_signatures(silent, loud, ends, classes)
        finer = _numbered([(c, signature) for c, signature in zip(classes, signatures, strict=True)])
        if max(finer, default=0) == max(classes, default=0):
            return finer
        classes = finer


def quotient(
    moves: Moves[Labelled], classes: Sequence[int], hidden: Callable[[Labelled], bool] | None = None
) -> list[list[tuple[Labelled, int]]]:
    """The moves between classes, each once; a hidden move inside a class stays only where the class diverges."""
    found: list[dict[tuple[Labelled, int], None]] = [{} for _ in range(max(classes, default=-1) + 1)]
    inside: list[list[int]] = [[] for _ in moves]
    for here, m in enumerate(moves):
        for label, after in m:
            if hidden is not None and hidden(label) and classes[here] == classes[after]:
                inside[here].append(after)
            else:
                found[classes[here]][label, classes[after]] = None
    for component, loops in components(inside):
        if loops:
            c = classes[component[0]]
            label = next(label for label, s in moves[component[0]] if hidden is not None and hidden(label))
            found[c][label, c] = None
    return [list(each) for each in found]


def _branching_signatures(
    silent: list[list[int]], loud: list[list[tuple[Labelled, int]]], ends: Sequence[Hashable], classes: list[int]
) -> list[frozenset[tuple[Hashable, object]]]:
    inert = [[s for s in after if classes[s] == classes[i]] for i, after in enumerate(silent)]
    signatures: list[frozenset[tuple[Hashable, object]]] = [frozenset()] * len(silent)
    for component, loops in components(inert):  # successors first
        offers: set[tuple[Hashable, object]] = {_DIVERGES} if loops else set()
        for i in component:
            offers.update((label, classes[s]) for label, s in loud[i])
            offers.update((None, classes[s]) for s in silent[i] if classes[s] != classes[i])
            if ends[i] is not None:
                offers.add((_ENDS, ends[i]))
            for s in inert[i]:
                offers |= signatures[s]
        shared = frozenset(offers)
        for i in component:
            signatures[i] = shared
    return signatures


def components(after: Sequence[Sequence[int]]) -> list[tuple[list[int], bool]]:
    """Strongly connected components, successors first (R. Tarjan 1972), and whether a cycle runs through each."""
    found: list[tuple[list[int], bool]] = []
    order: dict[int, int] = {}
    low: list[int] = [0] * len(after)
    stack: list[int] = []
    done: list[bool] = [False] * len(after)
    for start in range(len(after)):
        if start in order:
            continue
        order[start] = low[start] = len(order)
        stack.append(start)
        calls = [(start, iter(after[start]))]
        while calls:
            here, rest = calls[-1]
            following = next(rest, None)
            if following is None:
                calls.pop()
                if calls:
                    low[calls[-1][0]] = min(low[calls[-1][0]], low[here])
                if low[here] == order[here]:
                    found.append(_component(here, stack, done, after))
            elif following not in order:
                order[following] = low[following] = len(order)
                stack.append(following)
                calls.append((following, iter(after[following])))
            elif not done[following]:
                low[here] = min(low[here], order[following])
    return found


def _component(root: int, stack: list[int], done: list[bool], after: Sequence[Sequence[int]]) -> tuple[list[int], bool]:
    members: list[int] = []
    while not members or members[-1] != root:
        members.append(stack.pop())
        done[members[-1]] = True
    return members, len(members) > 1 or root in after[root]


class _Partition:
    """Classes that are only ever split. Members that were not looked at still have the signature of their class."""

    def __init__(self, classes: list[int]) -> None:
        self.classes = classes
        self._sizes = [0] * (max(classes, default=-1) + 1)
        for c in classes:
            self._sizes[c] += 1
        self._signature: list[Signature | None] = [None] * len(self._sizes)

    def split(self, signatures: Mapping[int, Signature]) -> list[int]:
        """Set apart what these signatures set apart; the states that have a new class."""
        groups: dict[int, dict[Signature, list[int]]] = {}
        for i, signature in signatures.items():
            groups.setdefault(self.classes[i], {}).setdefault(signature, []).append(i)
        changed = []
        for c, by_signature in groups.items():
            kept = self._kept(c, by_signature)
            for signature, members in by_signature.items():
                if signature != kept:
                    self._renumber(c, members, signature)
                    changed += members
        return changed

    def _kept(self, c: int, by_signature: Mapping[Signature, list[int]]) -> Signature | None:
        """The signature that keeps the number: that of those not looked at, else the most frequent."""
        if sum(map(len, by_signature.values())) == self._sizes[c]:
            self._signature[c] = max(by_signature, key=lambda signature: len(by_signature[signature]))
        return self._signature[c]

    def _renumber(self, old: int, members: list[int], signature: Signature) -> None:
        self._sizes[old] -= len(members)
        for i in members:
            self.classes[i] = len(self._sizes)
        self._sizes.append(len(members))
        self._signature.append(signature)


def _numbered(keys: Sequence[Hashable]) -> list[int]:
    numbers: dict[Hashable, int] = {}
    return [numbers.setdefault(key, len(numbers)) for key in keys]
