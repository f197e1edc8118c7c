"""Hostile bytes and adaptations: journals cut, flipped and spliced; frames of another end; adaptations that ask much.
"""

from __future__ import annotations

from random import Random
from typing import Any, get_args
from zlib import crc32

import msgspec

from planner_reactor.link.codec import encode
from planner_reactor.link.messages import Adaptation, Change, Enquiry, Mode, Perception, Standing
from planner_reactor.link.session import Frame, Session
from planner_reactor.reactor.journal import HEADER, framed
from tests.fuzz.texts import ODD, rs, size
from tests.reactor.driving import FIRST, SECOND
from tests.reactor.journals import history, written

JOURNAL = written(history(12))


def damaged(draw: Random, content: bytes) -> bytes:
    """Cut, flipped, doubled, spliced, or with bytes that were never there."""
    found = bytearray(content)
    for _ in range(draw.randint(1, 4)):
        at = draw.randrange(len(found) + 1)
        how = draw.randrange(5)
        if how == 0:
            del found[at:]
        elif how == 1 and at < len(found):
            found[at] ^= 1 << draw.randrange(8)
        elif how == 2:
            found[at:at] = found[draw.randrange(len(found) + 1) :][: size(draw)]
        elif how == 3:
            found[at:at] = draw.randbytes(size(draw, 300))
        else:
            del found[at : at + size(draw, 300)]
    return bytes(found)


PLAIN = (
    None, True, 0, -1, 1, 40, 2**63, -(2**63), 1e308, float("nan"), float("inf"), "applied", "drain", "x", b"\xff" * 9,
    *[odd for odd in ODD if odd != "\ud800"],
)  # fmt: skip


def value(draw: Random, depth: int = 3) -> Any:
    """Any plain value."""
    if depth == 0 or draw.random() < 0.6:
        chosen = draw.choice(PLAIN)
        return "x" * size(draw) if chosen == "x" else draw.randrange(40) if chosen == 40 else chosen
    if draw.random() < 0.5:
        return [value(draw, depth - 1) for _ in range(size(draw, 20))]
    return {draw.choice(("type", "id", "adaptation", "state", "time", "x")): value(draw, depth - 1) for _ in range(4)}


def in_arrays(depth: int) -> bytes:
    """MessagePack of arrays within arrays."""
    return b"\x91" * depth + b"\xc0"


def nesting(draw: Random) -> bytes:
    return in_arrays(size(draw, 50_000))


def journal(draw: Random) -> bytes:
    """A journal with something wrong in it: also with sound check sums, as a faulty writer would leave it."""
    how = draw.randrange(4)
    if how < 2:
        return damaged(draw, JOURNAL)
    if how == 2:
        return HEADER + b"".join(framed_content(_record(draw), n) for n in range(1, size(draw, 8) + 1))
    nested = framed_content(nesting(draw), 1)
    return HEADER + draw.choice((nested, draw.randbytes(size(draw)), b"\xa5" * size(draw, 20_000)))


def _record(draw: Random) -> bytes:
    if draw.random() < 0.5:
        records = history(3)
        return framed(records[draw.randrange(len(records))], 1)[13:]
    kind = draw.choice(("begun", "decided", "assumed", "halted", "left", "started", "snapshot", "other"))
    fields = ("adaptation", "id", "outcome", "assumption", "holds", "halted", "label", "state", "time")
    record = {"type": kind} | {name: value(draw) for name in fields if draw.random() < 0.8}
    return _packed(record)


def framed_content(content: bytes, number: int) -> bytes:
    """A record of a journal with this content, sound or not."""
    head = len(content).to_bytes(4, "big") + number.to_bytes(4, "big")
    return b"\xa5" + head + crc32(head + content).to_bytes(4, "big") + content


def _packed(plain: Any) -> bytes:
    try:
        return msgspec.msgpack.encode(plain)
    except (OverflowError, UnicodeEncodeError):
        return b"\xc1"


def frame(draw: Random) -> bytes:
    """A frame of the link, or what takes itself for one."""
    how = draw.randrange(4)
    if how == 0:
        return damaged(draw, msgspec.msgpack.encode(Frame(1, 1, 1, 1, 0, encode(FIRST))))
    if how == 1:
        return _packed([draw.choice((1, 2, value(draw))), *(value(draw) for _ in range(draw.randint(0, 7)))])
    if how == 2:
        numbers = [draw.choice((0, 1, 2, 5, 63, 64, 65, 2**40, -1)) for _ in range(4)]
        return _packed([1, *numbers, draw.randbytes(size(draw, 100))])
    return nesting(draw)


FIELDS = {kind.__name__.lower(): kind.__struct_fields__ for kind in (Adaptation, Enquiry, Perception, Standing)}
MESSAGES = (
    FIRST, SECOND, Enquiry(enquirer=3), Perception(number=1, kind="assumption_failure", subject="A", time=2.0, count=7),
    Perception(number=2, kind="information", subject="answer", time=3.0, values=(1, "x", 2.5)),
    Standing(enquirer=3, epoch=2, versions={"work": 4}, clauses={0: "P[0] = STOP :; ASSERT[work]"}),
)  # fmt: skip


def message(draw: Random) -> bytes:
    """A message within a frame."""
    how = draw.randrange(5)
    if how <= 1:
        return damaged(draw, encode(draw.choice(MESSAGES)))
    kind = draw.choice((*FIELDS, "other", 3))
    if how == 2:
        return _packed([kind, value(draw)])
    if how == 3:
        fields = FIELDS.get(kind, ("id",))  # type: ignore[call-overload]  # also of what is no kind
        return _packed([kind, {name: value(draw) for name in fields if draw.random() < 0.9}])
    return b"\x92\xaaadaptation" + nesting(draw)


def adaptation(draw: Random, number: int) -> Adaptation:
    """An adaptation of the small reactor of the tests, whose text or lists may say anything."""
    ids = (0, 1, 2, 3, 4, 5, -1, 2**40, draw.randrange(60))
    names = ("work", "part", "other", "", *ODD)
    sound = draw.choice((FIRST, SECOND))
    return Adaptation(
        id=draw.choice((number, draw.choice(ids))),
        epoch=draw.choice((0, 0, 0, 1, -1, 2**40)),
        definitions=draw.choice((sound.definitions, rs(draw), f"P[{draw.choice(ids)}] = SIT[part]<k> :; {rs(draw)}")),
        changes=draw.choice((sound.changes, tuple(
            Change(situation=draw.choice(names), base=draw.choice(ids), assumptions=tuple(draw.choices(names, k=2)),
                   fresh=draw.random() < 0.5)
            for _ in range(size(draw, 20))
        ))),
        removed=draw.choice(((), tuple(draw.choices(names, k=2)))),
        kills=draw.choice((sound.kills, tuple(draw.choices(ids, k=size(draw, 20))))),
        adds=draw.choice((sound.adds, tuple(draw.choices(ids, k=size(draw, 20))))),
        mode=draw.choice((*get_args(Mode), *get_args(Mode), "other")),  # type: ignore[arg-type]
        deadline=draw.choice((None, None, 0.0, -1.0, 1e308, float("nan"), float("inf"), 2.0)),
        purpose=draw.choice(ODD),
        drops=draw.choice(((), tuple(draw.choices(names, k=2)))),
        adopts=draw.choice(((), tuple(draw.choices(names, k=2)))),
    )  # fmt: skip


def session() -> Session:
    """An end that waits for what comes, and has something to say."""
    end = Session(1)
    end.send(b"word")
    return end
