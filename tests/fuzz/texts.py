"""Hostile RS: deep, long, recursive, huge, foreign, and sound programs with something wrong in them.

Each maker takes a random generator and gives a text. Blind bytes find little; what breaks a reader is structure: a
thousand `(` in one line, a name that means itself, a number with ten thousand digits.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from random import Random

ROOT = Path(__file__).parents[2]
SOUND = tuple(path.read_text(encoding="utf-8") for path in sorted((ROOT / "examples").glob("*.rsl")))
TOKENS = re.compile(r"\s+|\w+|::|:;|.", re.DOTALL)
CUT = [TOKENS.findall(text) for text in SOUND]
ODD = (
    "", "\x00", "\ud800", "é", "̈", "\u202e", "\u2028", "\ufeff", "𝟙", "Ⅷ", "'", '"', '"x', "\\", "/*", "--", "#",
    "1e999", "-1e-999", "nan", "inf", "0x1f", "1_000", "..", "=", "==", "[", "]", "<", ">", ",", "(", ")", "~", "|",
    "&", ":", ";", ":;", "::", "if", "then", "else", "P[0]", "P[-1]", "P[1.5]", "E[0] # P[0]", "ADD<m>", "STREAM",
)  # fmt: skip
LEAVES = (
    "STOP", "ABORT", "NIL", "Delay[1]", "Delay[x]", "IN[p]<x>", "OUT[p, 1]", "ASSERT[s]", "REASSERT[s, 1]", "SIT[s]<k>",
    "SUCCEED[s, k]", "FAIL[s, k]", "DRAIN[s]", "KILL[1]", "POST[2]", "COMMIT[1]", "GTR[1, 2]", "T", "U[1]", "Nobody",
)  # fmt: skip
OPERATORS = (" ; ", " : ", " | ", " & ", " # ", " :; ", " :: ", "\n", " ")

Maker = Callable[[Random], str]


def size(draw: Random, most: int = 3_000) -> int:
    """Mostly small, now and then large: evenly among the orders of magnitude."""
    return round(most ** draw.random())


def process(draw: Random, depth: int) -> str:
    """A random process, not always a sound one."""
    if depth <= 0 or draw.random() < 0.2:
        return draw.choice(LEAVES)
    kind = draw.random()
    if kind < 0.15:
        return f"~{process(draw, depth - 1)}"
    if kind < 0.3:
        return "if " + " then ".join(process(draw, depth - 1) for _ in range(2)) + f" else {process(draw, depth - 1)}"
    parts = [process(draw, depth - 1) for _ in range(draw.randint(2, 4))]
    return f"({draw.choice(OPERATORS).join(parts)})"


def expression(draw: Random, depth: int) -> str:
    if depth <= 0:
        return draw.choice(("1", "0", "x", "n", "red", '"t"', "-1", "1e308", "9" * size(draw)))
    return f"({expression(draw, depth - 1)} {draw.choice('+-*/^%<')} {expression(draw, depth - 2)})"


def deep(draw: Random) -> str:
    n = size(draw, 20_000)
    opening, middle, closing = draw.choice((
        ("(", "STOP", ")"), ("~", "STOP", ""), ("(", "STOP", ""), ("if STOP then ", "STOP", " else STOP"),
        ("STOP : (", "STOP", ")"), ("STOP :; ", "STOP", ""), ("STOP :: (", "STOP", ")"), ("F[", "1", "]"),
        ("Delay[(", "1", ")]"), ("Delay[-", "1", "]"), ("", "STOP", ")"), ("<", "x", ">"), ("(STOP | ", "STOP", ")"),
        ("if ", "STOP", " then STOP else STOP"), ("(~", "T", ")"), ("Delay[1 + (", "1", ")]"),
    ))  # fmt: skip
    return f"T = {opening * n}{middle}{closing * n}"


def long(draw: Random) -> str:
    n = size(draw, 300)
    part = draw.choice(LEAVES)
    return draw.choice((
        f"T = {draw.choice(OPERATORS).join([part] * n)}",
        "\n".join(f"T{i} = {part}" for i in range(n)),
        "\n".join(f"P[{i}] = {part}" for i in range(n)),
        f"T = F[{', '.join(['1'] * n)}]",
        f"T<{', '.join(f'x{i}' for i in range(n))}> = {part}",
        f"T[{', '.join(f'x{i}' for i in range(n))}] = {part}",
        "T = STOP " + "x" * n, "# " + "c" * n, " " * n + "T = STOP", "\n" * n, f'T = OUT["{"t" * n}", 1]',
    ))  # fmt: skip


def recursive(draw: Random) -> str:
    n = size(draw, 300)
    ring = "\n".join(f"R{i} = {draw.choice(('R', '~R', 'STOP | R', 'STOP ; R', 'STOP :; R'))}{(i + 1) % n}"
                     for i in range(n))  # fmt: skip
    doubled = "\n".join(f"D{i} = D{i + 1} | D{i + 1}" for i in range(n)) + f"\nD{n} = STOP"
    return draw.choice((
        "T = T | T", "T = ~T", "T = T", "T = T ; T", "T = T : T", "T = T :; T", "T = T :: T", "T = T # T",
        "T = if T then T else T", "T[n] = T[n + 1]", "T[n] = T[n - 1] | T[n * 2]", "T = STOP :; STOP",
        "T = (T & T)", "T = STOP :: STOP",
        "T = U\nU = T", "P[1] = P[1]", "P[n] = P[n]", "T = Delay[1] : T | T", ring, doubled,
    ))  # fmt: skip


def numbers(draw: Random) -> str:
    number = draw.choice((
        "9" * size(draw, 20_000), "1e" + "9" * size(draw, 50), "0." + "0" * size(draw, 5_000) + "1",
        "-" * size(draw, 500) + "1", f"1/{draw.randrange(3)}", "1e308 * 1e308", "2 ^ 2 ^ 9999",
        expression(draw, draw.randint(1, 12)),
    ))  # fmt: skip
    return draw.choice(("T = Delay[N]", "P[N] = STOP", "T = GTR[N, N]", "T[N] = T")).replace("N", number)


def edited(draw: Random) -> str:
    """A sound program with some tokens lost, doubled, exchanged or replaced."""
    tokens = list(draw.choice(CUT))
    for _ in range(draw.randint(1, 6)):
        at, other = draw.randrange(len(tokens)), draw.randrange(len(tokens))
        how = draw.randrange(5)
        if how == 0:
            tokens[at] = ""
        elif how == 1:
            tokens[at] *= size(draw, 400)
        elif how == 2:
            tokens[at], tokens[other] = tokens[other], tokens[at]
        elif how == 3:
            tokens[at] = draw.choice(ODD)
        else:
            tokens[at] = f" {process(draw, 3)} "
    return "".join(tokens)


def grown(draw: Random) -> str:
    heads = ("T", "U[n]", "P[1]", "P[2]", "V<x>", "W[1, n]<x>")
    return "\n".join(f"{draw.choice(heads)} = {process(draw, draw.randint(1, 6))}" for _ in range(draw.randint(1, 6)))


def foreign(draw: Random) -> str:
    return "".join(draw.choice((*ODD, *LEAVES, " ", "\n", "T = ")) for _ in range(size(draw, 400)))


RS: tuple[Maker, ...] = (deep, long, recursive, numbers, edited, edited, grown, grown, foreign)


def rs(draw: Random) -> str:
    """One hostile text."""
    return draw.choice(RS)(draw)
