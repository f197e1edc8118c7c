"""Messages as bytes: strict MessagePack, one message a frame.

What does not decode is refused with a typed error; nothing is evaluated, nothing is guessed.
"""

from __future__ import annotations

from typing import TypeAlias

import msgspec

from planner_reactor.errors import InputError
from planner_reactor.link.messages import Adaptation, Enquiry, Perception, Standing

Message: TypeAlias = Adaptation | Enquiry | Perception | Standing

LARGEST = 1_000_000
"""Bytes of the largest message that is decoded by who does not expect a larger one."""

LARGEST_STANDING = 16_000_000
"""The same of who may be told how a whole reactor stands."""

_KINDS: dict[str, type[Message]] = {
    "adaptation": Adaptation, "enquiry": Enquiry, "perception": Perception, "standing": Standing,
}  # fmt: skip
MALFORMED = (msgspec.MsgspecError, RecursionError, UnicodeDecodeError)
"""What decoding raises for bytes that are no message: also for a thousand arrays within each other, and for no text."""

_encode = msgspec.msgpack.Encoder(enc_hook=str).encode


def encode(message: Message) -> bytes:
    """One message as MessagePack: `[kind, fields]`."""
    return _encode([type(message).__name__.lower(), message])


def decode(frame: bytes, *, largest: int = LARGEST) -> Message:
    """The message in a frame; `InputError` if it is too large, malformed or of an unknown kind."""
    if len(frame) > largest:
        raise InputError(f"a message of {len(frame)} bytes, expected at most {largest}")
    try:
        kind, body = msgspec.msgpack.decode(frame, type=tuple[str, msgspec.Raw])
        if kind not in _KINDS:
            raise InputError(f"a message of unknown kind {kind!r}, expected one of {', '.join(sorted(_KINDS))}")
        return msgspec.msgpack.decode(body, type=_KINDS[kind])
    except MALFORMED as problem:
        raise InputError(f"a malformed message: {problem}") from None
