"""A planner that improvises: random adaptations, valid ones and wrong ones, in all three modes, as fast as is wanted.

It thinks nothing and knows exactly what it did: its `Book` says what the reactor must be like, and every answer is held
against it. The book is what a planner keeps on disk: it survives the planner's crash, and an adaptation is in it before
it is sent, so that it can be sent again under the same id (the intent is durable).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from random import Random

from msgspec.structs import replace

from planner_reactor.link.messages import Adaptation, Change, Mode
from planner_reactor.simulation.books import Book, Node
from planner_reactor.simulation.sensors import ASSUMPTIONS, NOTICED, PERIOD
from planner_reactor.simulation.workshop import BEAT

NAMES = tuple(f"s{n}" for n in range(8))
CROWD = "crowd"
MODES: tuple[Mode, ...] = ("drain", "drain", "versions", "wait")
DEADLINE = 60.0
"""Seconds that an adaptation is given, so that a run can come to rest."""

PENDING = 3
"""Adaptations under way at most."""


@dataclass(slots=True)
class Draft:
    """An adaptation while it is put together."""

    clauses: dict[int, str] = field(default_factory=dict)
    changes: list[Change] = field(default_factory=list)
    kills: list[int] = field(default_factory=list)
    removed: list[str] = field(default_factory=list)
    nodes: dict[str, Node | None] = field(default_factory=dict)  # what each situation is afterwards


class Improviser:
    """Draws adaptations for a book."""

    def __init__(self, book: Book, draw: Random, rests: Random) -> None:
        self.book = book
        self.draw = draw
        self._rests = rests  # what rests on an assumption that nobody reads

    def first(self) -> Adaptation:
        """A reaction that beats, monitors, and something to do."""
        draft = Draft()
        self._label(draft, f"Delay[{BEAT:g}] :; Beat")
        for name in ASSUMPTIONS:
            self._label(draft, f"ASSUMONITOR[{name}, {1000 * PERIOD:g}]")
            self._label(draft, f"HOLDMONITOR[{name}, {1000 * PERIOD:g}]")
        self._found(draft, NAMES[0])
        return self._issued(draft, "drain", "the beginning")

    def improvise(self) -> Adaptation | None:
        """Something to change, or something wrong to ask for; None if nothing can be done now."""
        if not self.book.settled() or len(self.book.pending) >= PENDING:
            return None
        free = [n for n in NAMES if n not in self.book.touched]
        if not free:
            return None
        name = self.draw.choice(free)
        draft, mode = Draft(), self.draw.choice(MODES)
        node = self.book.nodes.get(name)
        if node is None:
            self._found(draft, name)
            purpose = f"found {name}"
        elif self.draw.random() < 0.15 and self.book.removable(name):
            self._remove(draft, node)
            purpose, mode = f"remove {name}", "drain"
        else:
            self._rewrite(draft, node)
            purpose = f"rewrite {name}"
            others = [n for n in free if n in self.book.nodes and n not in draft.nodes]
            if others and self.draw.random() < 0.25:
                self._rewrite(draft, self.book.nodes[self.draw.choice(others)])
                purpose += " and another"
        if self.draw.random() < 0.12:
            return self._wrong(draft, mode)
        return self._issued(draft, mode, purpose)

    def crowd(self) -> Adaptation | None:
        """A reaction that asserts a situation over and over, each instance served at once (row 29)."""
        if not self.book.settled() or CROWD in self.book.touched or CROWD in self.book.nodes:
            return None
        draft = Draft()
        label = self._label(draft, self._body(CROWD, ["Do[{s}, k, {n}, 40]"], spawns=True))
        root = self._label(draft, f"Pause[0.0035] :: ASSERT[{CROWD}]")
        self._change(draft, CROWD, label, (), (), root, fresh=True)
        return self._issued(draft, "drain", "a crowd")

    def disperse(self) -> Adaptation | None:
        """The crowd goes."""
        node = self.book.nodes.get(CROWD)
        if node is None or CROWD in self.book.touched or not self.book.settled():
            return None
        draft = Draft()
        self._remove(draft, node)
        return self._issued(draft, "drain", "disperse")

    # -- what a change consists of

    def _label(self, draft: Draft, text: str) -> int:
        label = self.book.next_label
        self.book.next_label += 1
        draft.clauses[label] = text.replace("{n}", str(label))
        return label

    def _found(self, draft: Draft, name: str) -> None:
        label, children, rests = self._reaction(draft, name)
        pause = round(self.draw.uniform(0.5, 20.0), 2)
        root = self._label(draft, f"Pause[{pause}] {self.draw.choice((':;', ':;', '::'))} ASSERT[{name}]")
        self._change(draft, name, label, children, rests, root, fresh=True)

    def _rewrite(self, draft: Draft, node: Node) -> None:
        label, children, rests = self._reaction(draft, node.name)
        draft.kills.append(node.label)
        self._change(draft, node.name, label, children, rests, node.root, fresh=False)

    def _remove(self, draft: Draft, node: Node) -> None:
        draft.kills += [node.root, node.label]
        draft.removed.append(node.name)
        draft.nodes[node.name] = None

    def _change(
        self, draft: Draft, name: str, label: int, children: tuple[str, ...], rests: tuple[str, ...], root: int, *,
        fresh: bool,
    ) -> None:  # fmt: skip
        version = self.book.versions.get(name, 0)
        draft.changes.append(Change(situation=name, base=version, assumptions=rests, fresh=fresh))
        draft.nodes[name] = Node(name, label, root, children)

    def _reaction(self, draft: Draft, name: str) -> tuple[int, tuple[str, ...], tuple[str, ...]]:
        draw = self.draw
        below = [n for n in self.book.nodes if n > name and n not in self.book.touched and n not in draft.nodes]
        children = tuple(draw.sample(below, min(len(below), draw.choice((0, 0, 1, 2)))))
        steps = [f"REASSERT[{child}]" for child in children]
        for _ in range(draw.choice((1, 1, 2, 3))):
            seconds = round(draw.expovariate(1 / 6.0) % 30.0 + 0.1, 2)
            steps.insert(draw.randint(0, len(steps)), f"Do[{{s}}, k, {{n}}, {seconds}]")
        if (chance := draw.random()) < 0.12:
            steps.insert(0, f"Travel[{draw.uniform(0.0, 2.0):.2f}]")
        elif chance < 0.14:
            steps = ["Linger[{s}, k, {n}]"]
        elif chance < 0.145:
            steps.append("(Spin :; STOP)")
        rests = tuple(a for a in ASSUMPTIONS if draw.random() < 0.25) + (NOTICED,) * (self._rests.random() < 0.2)
        return self._label(draft, self._body(name, steps, draw.random() < 0.3)), children, rests

    def _body(self, name: str, steps: list[str], spawns: bool) -> str:
        work = " : ".join([*steps, "SUCCEED[{s}, k]"]).replace("{s}", name)
        return f"SIT[{name}]<k> {'::' if spawns else ':;'} (~({work}) : FAIL[{name}, k])"

    # -- what goes out

    def _issued(self, draft: Draft, mode: Mode, purpose: str) -> Adaptation:
        adaptation = self._adaptation(draft, mode, purpose)
        self.book.issue(adaptation, draft.nodes)
        return adaptation

    def _adaptation(self, draft: Draft, mode: Mode, purpose: str) -> Adaptation:
        return Adaptation(
            id=self.book.new_id(),
            epoch=self.book.epoch,
            definitions="".join(f"P[{n}] = {text}\n" for n, text in draft.clauses.items()),
            changes=tuple(draft.changes),
            removed=tuple(draft.removed),
            kills=tuple(draft.kills),
            adds=tuple(draft.clauses),
            mode=mode,
            deadline=DEADLINE if self.draw.random() < 0.8 else round(self.draw.uniform(0.5, 10.0), 2),
            purpose=purpose,
        )

    def _wrong(self, draft: Draft, mode: Mode) -> Adaptation:
        """The same with something wrong: nothing of it may be applied."""
        wrong, chosen = self.draw.choice(list(self._spoilt(self._adaptation(draft, mode, "wrong")).items()))
        self.book.next_label += 1
        self.book.issue(chosen, {}, wrong)
        return chosen

    def _spoilt(self, sound: Adaptation) -> dict[str, Adaptation]:
        """What can be wrong with an adaptation."""
        definitions, adds, new = sound.definitions, sound.adds, self.book.next_label
        unknown = f"P[{new}] = Delay[5] :; Nobody\n"
        used = [n for (epoch, n), o in self.book.outcomes.items() if epoch == self.book.epoch and o == "applied"]
        bare = replace(sound, changes=(), removed=(), kills=(), adds=(), definitions="")
        return {
            "versions": replace(
                sound, changes=tuple(replace(c, base=c.base + 1) for c in sound.changes),
                kills=sound.kills if sound.changes else (*sound.kills, -1),
            ),
            "absent label": replace(sound, kills=(*sound.kills, new + 7)),
            "absent situation": replace(sound, adds=adds[:-1], removed=("nowhere",)),
            "no text": replace(sound, definitions=definitions + "P[ = "),
            "no reaction": replace(sound, definitions=definitions + "Q[1] = STOP\n"),
            "unknown process": replace(bare, definitions=unknown, adds=(new,)),
            "one of a group": replace(sound, definitions=definitions + unknown, adds=(*adds, new)),
            "recursion": replace(bare, definitions=f"P[{new}] = P[{new}] | P[{new}]\n", adds=(new,)),
            "parser bomb": replace(bare, definitions=f"P[{new}] = {'(' * 3000}STOP\n", adds=(new,)),
            "served by nobody": replace(bare, definitions=f"P[{new}] = STOP :; ASSERT[elsewhere]\n", adds=(new,)),
            "used id": replace(sound, id=used[-1]) if used else replace(bare, id=1, kills=(new + 7,)),
        }  # fmt: skip
