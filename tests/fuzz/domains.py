"""Hostile planning domains: those that are shipped, cut, edited, repeated and nested; and texts of the same tokens."""

from __future__ import annotations

import re
from random import Random

from tests.fuzz.texts import ODD, ROOT, size

SOUND = tuple(
    path.read_text(encoding="utf-8")
    for path in sorted([*(ROOT / "examples").glob("*.itl"), *(ROOT / "src").rglob("*.itl")])
)
TOKENS = re.compile(r"\s+|\w+|.", re.DOTALL)
CUT = [TOKENS.findall(text) for text in SOUND]
WORDS = sorted({token for tokens in CUT for token in tokens if not token.isspace()})


def domain(draw: Random) -> str:
    """One hostile text."""
    return draw.choice((edited, edited, sentences, nested, repeated, salad))(draw) + "\n"


def edited(draw: Random) -> str:
    tokens = list(draw.choice(CUT))
    for _ in range(draw.randint(1, 6)):
        at = draw.randrange(len(tokens))
        others = (draw.choice(ODD), draw.choice(WORDS), draw.choice(tokens))
        tokens[at] = draw.choice(("", tokens[at] * size(draw, 300), *others))
    return "".join(tokens[: draw.choice((len(tokens), draw.randrange(len(tokens))))])


def sentences(draw: Random) -> str:
    """Sentences of sound domains in another order, some twice, some missing."""
    found = re.split(r"(?<=\.)\s+|\n\n", draw.choice(SOUND))
    return "\n\n".join(draw.choice(found) for _ in range(size(draw, 60)))


def nested(draw: Random) -> str:
    n = size(draw, 20_000)
    brackets = (("(", ")"), ("f(", ")"), ("[", "]"), ("not ", ""), ("{", "}"), ("-", ""), ("(", ""))
    opening, closing = draw.choice(brackets)
    lines = draw.choice(SOUND).split("\n")
    lines[draw.randrange(len(lines))] += f" {opening * n}a{closing * n}"
    return "\n".join(lines)


def repeated(draw: Random) -> str:
    lines = draw.choice(SOUND).split("\n")
    at = draw.randrange(len(lines))
    lines[at] = "\n".join([lines[at]] * size(draw, 200))
    return "\n".join(lines)


def salad(draw: Random) -> str:
    return " ".join(draw.choice((*WORDS, *ODD)) for _ in range(size(draw, 300)))
