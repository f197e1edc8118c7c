"""Safe adaptations side by side: R0 becomes R1 (R §5.4, §5.5, eq. (6)), in k copies that share nothing.

The model on which our transition systems are held against SPIN. A copy is R0 with its guards, whose situation sa is
composed of sb, and the script that makes R1 of it, in which sa is composed of sx and sy. What the papers print without
SUCCEED, and with `::`, is mended (docs/papers.md). The last step of the script brings the new reactions to life in
place of ADD: one ADD takes the labels of every POST, so that copies with an ADD are never independent.
"""

from __future__ import annotations

from planner_reactor.rs.configurations import Config, Ending, World, spawned_situations
from planner_reactor.rs.evolves import started
from planner_reactor.rs.loading import load, load_process
from planner_reactor.rs.terms import Value
from planner_reactor.rs.vocabulary import Signature

TEXT = """
Copy[a, b, x, y, n, kind] =
    (E[n + 1] # Asks[a]) | (E[n + 2] # Parent[a, b]) | (E[n + 3] # Child[b, kind]) | Surgery[a, x, y, n, kind]
Asks[a] = Want :; ASSERT[a]
Parent[a, b] = SIT[a]<k> :; (~(ASSERT[b] : SUCCEED[a, k]) : FAIL[a, k])
Child[b, kind] = SIT[b]<k> :; (~(Does[kind] : SUCCEED[b, k]) : FAIL[b, k])
Surgery[a, x, y, n, kind] = {protocol}[a] : KILL[n + 2] : KILL[n + 3] : UNINHIBIT[a] : Renewed[a, x, y, n, kind]
Renewed[a, x, y, n, kind] =
    (E[n + 6] # Child[y, kind]) | (E[n + 5] # Child[x, kind]) | (E[n + 4] # NewParent[a, x, y])
NewParent[a, x, y] = SIT[a]<k> :; (~(ASSERT[x] : ASSERT[y] : SUCCEED[a, k]) : FAIL[a, k])
Does["alone"] = Work
"""
"""One copy: a, b, x, y are its situations, n + 1 … n + 6 its labels."""

TOOLS = """
Does["left first"] = OUT[take_left, 1] : OUT[take_right, 1] : (Work ; (OUT[give_right, 1] : OUT[give_left, 1]))
Does["right first"] = OUT[take_right, 1] : OUT[take_left, 1] : (Work ; (OUT[give_left, 1] : OUT[give_right, 1]))
Tool[take, give] = IN[take]<x> :; IN[give]<z>
Tools = Tool[take_left, give_left] | Tool[take_right, give_right]
"""
"""What couples two copies: each needs both tools, and they reach for them in opposite order."""

AT_ANY_TIME = (0.0, float("inf"))
SIGNATURES = {name: Signature(name, window=AT_ANY_TIME) for name in ("Want", "Work")}


def text(k: int, *, protocol: str = "WAITINHIBIT", coupled: bool = False) -> str:
    """A program `Copies` of k copies; `coupled`: the first two share two tools."""
    kinds = {1: "left first", 2: "right first"} if coupled else {}
    calls = [f'Copy[a{i}, b{i}, x{i}, y{i}, {10 * i}, "{kinds.get(i, "alone")}"]' for i in range(1, k + 1)]
    program = TEXT.format(protocol=protocol) + (TOOLS if coupled else "")
    return program + f"Copies = {' | '.join([*calls, 'Tools'] if coupled else calls)}\n"


def begun(k: int, *, protocol: str = "WAITINHIBIT", coupled: bool = False) -> tuple[Config, World]:
    """The copies as they begin, and the world that they evolve under."""
    program = load(text(k, protocol=protocol, coupled=coupled), signatures=SIGNATURES)
    process = load_process("Copies", given=program, signatures=SIGNATURES)
    world = World(program, SIGNATURES, endings=endings, spawned=spawned_situations(program, process))
    return started(process, world), world


def endings(name: str, arguments: tuple[Value, ...]) -> list[Ending]:
    """Work succeeds or fails; who wants something can only go on wanting."""
    return [(True, ()), (False, ())] if name == "Work" else [(True, ())]
