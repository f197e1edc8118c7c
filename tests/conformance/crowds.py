"""Random programs in which several processes wait for the same: who is woken, and what if he has no use for it?

Waiters stand in roots of their own or at one place of the text (bodies of a `::`); some give up after a time. What they
wait for comes once, several times, or never. Programs of `texts` seldom have two waiters at one door.
"""

from __future__ import annotations

import random

WAITERS: dict[str, tuple[str, ...]] = {
    "SIT": ("SIT[s]<{y}>", "SIT[s]<{y}> ; Delay[1]", "SIT[s]<{y}> : SUCCEED[s, {y}]", "WAIT[s]"),
    "POST": ("POST[7]", "POST[8]", "POST[7] : KILL[7]", "POST[1]"),
    "KILL": ("KILL[1]", "KILL[1] ; POST[1]", "DRAIN[s] : KILL[1]", "WAIT[s] : KILL[1]"),
    "hold": ("DRAIN[s] : UNINHIBIT[s]", "WAITINHIBIT[s] : UNINHIBIT[s]", "WAIT[s]", "WAITOLD[s]", "INHIBIT[s]"),
    "port": ("IN[p]<{y}>", "OUT[p, 5]", "IN[p]<{y}> ; OUT[p, {y}]"),
    "doubt": ("DISABLED[s]<{y}>", "ENABLED[s]", "DISABLED[s]<{y}> ; ENABLED[s]"),
}
"""Those who wait; {y} is a fresh name."""

SOURCES: dict[str, tuple[str, ...]] = {
    "SIT": ("ASSERT[s]", "INHIBIT[s] ; Delay[1] ; UNINHIBIT[s]", "DISABLE[s, A] ; Delay[1] ; ENABLE[s, A]"),
    "POST": ("ADD<{y}> : (E[{y}] # Never)", "ADD<{y}> :: (E[{y}] # Delay[1])", "E[7] # Delay[1]", "E[8] # Never"),
    "KILL": (
        "E[1] # (SIT[s]<{y}> :; (Delay[1] ; SUCCEED[s, {y}]))", "ASSERT[s]", "ADD<{y}> :: (E[{y}] # Never)",
        "E[1] # (SIT[s] | IN[p] | (SIT[t] # (IN[p] ; IN[p])))", "OUT[p, 1] ; OUT[p, 2]", "STREAM[p, 1] # Delay[1]",
    ),
    "hold": ("SIT[s]<{y}> :; (Slow ; SUCCEED[s, {y}])", "ASSERT[s]", "ASSERT[s] ; RENEW[s] ; ASSERT[s]"),
    "port": ("OUT[p, 1]", "STREAM[p, 2] # Delay[1]", "IN[p]<{y}> : OUT[p, {y}]"),
    "doubt": ("DISABLE[s, A]", "DISABLE[s, B] ; ENABLE[s, A]", "ENABLE[s, A] ; ENABLE[s, B]"),
}  # fmt: skip
"""Where what they wait for comes from."""

PAUSES = ("NIL", "NIL", "Delay[1]", "Delay[2]", "Slow", "Quick")


class _Crowd:
    def __init__(self, seed: int) -> None:
        self.draw = random.Random(seed)
        self.names = 0

    def fill(self, text: str) -> str:
        self.names += 1
        return text.replace("{y}", f"y{self.names}")

    def waiter(self, door: str) -> str:
        waits = self.fill(self.draw.choice(WAITERS[door]))
        if self.draw.random() < 0.3:
            waits = f"({waits}) # {self.draw.choice(['Delay[1]', 'Delay[2]', 'Quick'])}"
        return f"({waits})"

    def part(self) -> str:
        door = self.draw.choice(list(WAITERS))
        before = self.draw.choice(PAUSES)
        if self.draw.random() < 0.5:
            return f"({before} ; {self.waiter(door)})"
        return f"({before} ; ({self.fill(self.draw.choice(SOURCES[door]))}))"

    def roots(self) -> tuple[str, ...]:
        draw = self.draw
        door = draw.choice(list(WAITERS))
        calls = draw.randint(2, 3)
        together = f"IN[q]<x> :: ({draw.choice(PAUSES)} ; {self.waiter(door)})"
        waiting = [together, " ; ".join(["OUT[q, 1]"] * calls)] if draw.random() < 0.6 else []
        waiting += [f"{draw.choice(PAUSES)} ; {self.waiter(door)}" for _ in range(draw.choice([1, 2, 3]))]
        sources = [self.fill(draw.choice(SOURCES[door])) for _ in range(draw.choice([1, 1, 2, 3]))]
        coming = [f"{draw.choice(PAUSES)} ; ({source})" for source in sources]
        if draw.random() < 0.5:
            coming.append(self.part())
        roots = [*waiting, *coming]
        draw.shuffle(roots)
        return (" | ".join(f"({text})" for text in roots[:2]), *roots[2:])


def crowd(seed: int) -> tuple[str, ...]:
    """The roots of a program in which several wait for the same."""
    return _Crowd(seed).roots()
