"""Over a link that loses, repeats, reorders, delays and cuts, everything arrives once and in order."""

from __future__ import annotations

from heapq import heappop, heappush
from itertools import count
from random import Random

import pytest

from planner_reactor.errors import InputError
from planner_reactor.link import session as sessions
from planner_reactor.link.session import Frame, Session, Timing


class Wire:
    """Two ends and what is under way between them, on a clock of its own."""

    def __init__(self, seed: int, *, loss: float = 0.3, repeat: float = 0.2, delay: float = 0.3) -> None:
        self.draw = Random(seed)
        self.loss, self.repeat, self.delay = loss, repeat, delay
        self.now = 0.0
        self.ends = {"a": Session(1), "b": Session(1)}
        self.got: dict[str, list[bytes]] = {"a": [], "b": []}
        self.cut_until = 0.0
        self._order = count()
        self._frames: list[tuple[float, int, str, bytes]] = []

    def run(self, until: float) -> None:
        while self.now < until:
            for name, end in self.ends.items():
                for frame in end.due(self.now):
                    self._carry("b" if name == "a" else "a", frame)
            self.now = round(self.now + 0.05, 3)
            while self._frames and self._frames[0][0] <= self.now:
                _, _, to, frame = heappop(self._frames)
                self.got[to] += self.ends[to].receive(frame, self.now)

    def _carry(self, to: str, frame: bytes) -> None:
        for _ in range(2 if self.draw.random() < self.repeat else 1):
            if self.draw.random() >= self.loss and self.now >= self.cut_until:
                heappush(self._frames, (self.now + self.draw.uniform(0.0, self.delay), next(self._order), to, frame))


def texts(n: int) -> list[bytes]:
    return [f"message {i}".encode() for i in range(n)]


@pytest.mark.parametrize("seed", range(20))
def test_everything_arrives_once_and_in_order(seed: int) -> None:
    wire = Wire(seed)
    for n, message in enumerate(texts(150)):
        wire.ends["a" if n % 3 else "b"].send(message)
        if n % 10 == 0:
            wire.run(wire.now + 0.2)
    wire.run(wire.now + 60.0)
    assert wire.got["b"] == [m for n, m in enumerate(texts(150)) if n % 3]
    assert wire.got["a"] == [m for n, m in enumerate(texts(150)) if not n % 3]
    assert all(end.unacknowledged == 0 for end in wire.ends.values())
    assert sessions.total(wire.ends.values(), "resent") > 0
    assert sessions.total(wire.ends.values(), "repeated") > 0


def test_a_clean_link_carries_each_message_once() -> None:
    wire = Wire(1, loss=0.0, repeat=0.0, delay=0.05)
    for message in texts(50):
        wire.ends["a"].send(message)
    wire.run(5.0)
    assert wire.got["b"] == texts(50)
    assert wire.ends["a"].counts["resent"] == 0


def test_a_cut_is_bridged_and_the_other_end_is_absent_meanwhile() -> None:
    wire = Wire(2)
    wire.run(3.0)
    assert wire.ends["a"].present(wire.now)
    wire.cut_until = 33.0
    wire.ends["a"].send(b"late")
    wire.run(30.0)
    assert not wire.ends["a"].present(wire.now)
    assert wire.got["b"] == []
    wire.run(45.0)
    assert wire.got["b"] == [b"late"]
    assert wire.ends["a"].present(wire.now)


def test_what_an_end_did_not_acknowledge_goes_to_its_next_incarnation() -> None:
    wire = Wire(3, loss=0.0, repeat=0.0)
    wire.ends["a"].send(b"first")
    wire.run(3.0)
    wire.cut_until = 5.0
    wire.ends["a"].send(b"second")
    wire.run(4.5)
    wire.ends["b"] = Session(2)
    wire.run(10.0)
    assert wire.got["b"] == [b"first", b"second"]


def test_frames_of_an_earlier_incarnation_are_not_taken() -> None:
    old, new = Session(1), Session(2)
    receiver = Session(1)
    receiver.receive(new.due(0.0)[0], 0.0)
    assert receiver.peer == 2
    for frame in old.due(0.1):
        assert receiver.receive(frame, 0.1) == []
    assert receiver.counts["stale"] == 1


def test_only_a_window_of_messages_is_under_way() -> None:
    wire = Wire(4, loss=0.0, repeat=0.0)
    wire.run(1.0)
    for message in texts(500):
        wire.ends["a"].send(message)
    assert len(wire.ends["a"].due(wire.now)) == sessions.WINDOW
    wire.run(30.0)
    assert wire.got["b"] == texts(500)


def test_what_is_no_frame_is_counted_and_changes_nothing() -> None:
    end = Session(1)
    draw = Random(5)
    for _ in range(500):
        assert end.receive(draw.randbytes(draw.randrange(40)), 0.0) == []
    assert end.counts["malformed"] == 500
    assert end.peer == 0


def test_another_version_names_both() -> None:
    foreign = sessions._encode(Frame(7, 1, 0, 0, 0))
    with pytest.raises(InputError, match=r"version 7 .* this one 1"):
        Session(1).receive(foreign, 0.0)


def test_an_end_says_when_it_has_something_to_send() -> None:
    a, b = Session(1, timing=Timing(resend=0.2, beat=0.5)), Session(1)
    a.due(0.0)
    assert a.next_due() == 0.5
    a.receive(b.due(0.0)[0], 0.1)
    assert a.next_due() <= 0.1
    a.send(b"x")
    a.due(0.1)
    assert a.next_due() == pytest.approx(0.3)
