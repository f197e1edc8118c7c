"""A conversation over a link that loses, repeats, reorders, delays and cuts: sans I/O, both ends alike (law 10).

What is sent arrives at the other end once and in order, as soon as the link lets it, for as long as both ends live. A
frame says who sends it to whom: ends are told apart by their *incarnation*, and between two incarnations messages count
from 1. When the other end begins anew, what it has not acknowledged is sent to its new incarnation; whether it has seen
a message in an earlier life is for the messages themselves to say (an adaptation has an id).

Nothing here knows sockets or clocks: whoever drives a session gives it the frames that came and the time, in seconds,
and takes the frames that are due. A silent end is *absent* once its lease has run out; its commands expire with it.
"""

from __future__ import annotations

from collections.abc import Iterable

import msgspec

from planner_reactor.errors import InputError

VERSION = 1
"""Of the frames. Ends of different versions do not talk: both versions are named."""

WINDOW = 64
"""Messages under way at most; the others wait for acknowledgements."""


class Frame(msgspec.Struct, frozen=True, array_like=True):
    """What goes over the link: `body` is a message, or empty in a frame that only acknowledges."""

    version: int
    sender: int
    receiver: int  # 0: not known yet
    number: int  # of the message, from 1; 0 without one
    acknowledged: int  # all of the receiver's messages up to this number have come
    body: bytes = b""


_encode = msgspec.msgpack.Encoder().encode
_decode = msgspec.msgpack.Decoder(Frame).decode


class Timing(msgspec.Struct, frozen=True):
    """Seconds: after which a message is sent again, a word is said in silence, and a silent end is absent."""

    resend: float = 0.2
    beat: float = 0.5
    lease: float = 2.0


class Session:
    """One end. `incarnation` (from 1) is higher each time the end begins anew."""

    def __init__(self, incarnation: int, *, timing: Timing | None = None) -> None:
        self.incarnation = incarnation
        self.timing = timing or Timing()
        self.peer = 0  # its incarnation
        self.counts = {"sent": 0, "resent": 0, "repeated": 0, "stale": 0, "malformed": 0}
        self._heard = -1e9
        self._spoke = -1e9
        self._owes = False  # is there something to acknowledge?
        self._waiting: list[bytes] = []  # not acknowledged; the first has number `_first`
        self._first = 1
        self._sent_at: dict[int, float] = {}
        self._expected = 1
        self._early: dict[int, bytes] = {}

    # -- sending

    def send(self, message: bytes) -> None:
        """This has to arrive."""
        self._waiting.append(message)

    @property
    def unacknowledged(self) -> int:
        return len(self._waiting)

    def due(self, now: float) -> list[bytes]:
        """The frames that have to go out now."""
        frames = []
        if self.peer:
            for offset, message in enumerate(self._waiting[:WINDOW]):
                number = self._first + offset
                last = self._sent_at.get(number)
                if last is None or now - last >= self.timing.resend:
                    self.counts["sent" if last is None else "resent"] += 1
                    self._sent_at[number] = now
                    frames.append(self._frame(number, message))
        if not frames and (self._owes or now - self._spoke >= self.timing.beat):
            frames.append(self._frame(0, b""))
        if frames:
            self._spoke, self._owes = now, False
        return frames

    def next_due(self) -> float:
        """The earliest time at which `due` has something, if nothing comes meanwhile."""
        if self._owes:
            return self._spoke
        sendable = range(self._first, self._first + min(WINDOW, len(self._waiting))) if self.peer else ()
        if any(number not in self._sent_at for number in sendable):
            return self._spoke
        again = (self._sent_at[number] + self.timing.resend for number in sendable)
        return min(again, default=self._spoke + self.timing.beat)

    def _frame(self, number: int, body: bytes) -> bytes:
        return _encode(Frame(VERSION, self.incarnation, self.peer, number, self._expected - 1, body))

    # -- receiving

    def receive(self, content: bytes, now: float) -> list[bytes]:
        """Take a frame; the messages that are complete with it, in order. `InputError` for another version."""
        try:
            frame = _decode(content)
        except (msgspec.MsgspecError, RecursionError, UnicodeDecodeError):
            self.counts["malformed"] += 1
            return []
        if frame.version != VERSION:
            raise InputError(f"the other end speaks version {frame.version} of the link, this one {VERSION}")
        if frame.sender < self.peer or frame.receiver not in (0, self.incarnation):
            self.counts["stale"] += 1
            return []
        self._heard = now
        if frame.sender > self.peer:
            self._met(frame.sender)
        if frame.receiver == self.incarnation:
            self._acknowledge(frame.acknowledged)
            return self._take(frame.number, frame.body)
        return []

    def _met(self, peer: int) -> None:
        """Another incarnation of the other end: messages count from 1 again, on both sides."""
        self.peer, self._first, self._expected, self._owes = peer, 1, 1, True
        self._sent_at.clear()
        self._early.clear()

    def _acknowledge(self, number: int) -> None:
        done = max(0, min(number - self._first + 1, len(self._waiting)))
        for gone in range(self._first, self._first + done):
            self._sent_at.pop(gone, None)
        del self._waiting[:done]
        self._first += done

    def _take(self, number: int, body: bytes) -> list[bytes]:
        if number == 0:
            return []
        self._owes = True
        if number < self._expected or number in self._early:
            self.counts["repeated"] += 1
        elif number < self._expected + WINDOW:
            self._early[number] = body
        messages = []
        while (message := self._early.pop(self._expected, None)) is not None:
            messages.append(message)
            self._expected += 1
        return messages

    # -- the other end

    def present(self, now: float) -> bool:
        """Was anything heard of the other end within its lease?"""
        return now - self._heard <= self.timing.lease


def total(sessions: Iterable[Session], what: str) -> int:
    """One count over several sessions."""
    return sum(session.counts[what] for session in sessions)
