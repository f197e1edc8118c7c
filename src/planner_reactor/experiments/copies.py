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
Copy[a, b, x, y, l1, l2, l3, l4, l5, l6, kind] =
    (E[l1] # Asks[a]) | (E[l2] # Parent[a, b]) | (E[l3] # Child[b, kind])
    | Surgery[a, x, y, l2, l3, l4, l5, l6, kind]
Asks[a] = Want :; ASSERT[a]
Parent[a, b] = SIT[a]<k> :; (~(ASSERT[b] : SUCCEED[a, k]) : FAIL[a, k])
Child[b, kind] = SIT[b]<k> :; (~(Does[kind] : SUCCEED[b, k]) : FAIL[b, k])
Surgery[a, x, y, l2, l3, l4, l5, l6, kind] =
    {protocol}[a] : KILL[l2] : KILL[l3] : UNINHIBIT[a] : Renewed[a, x, y, l4, l5, l6, kind]
Renewed[a, x, y, l4, l5, l6, kind] = (E[l6] # Child[y, kind]) | (E[l5] # Child[x, kind]) | (E[l4] # NewParent[a, x, y])
NewParent[a, x, y] = SIT[a]<k> :; (~(ASSERT[x] : ASSERT[y] : SUCCEED[a, k]) : FAIL[a, k])
Does["alone"] = Work
"""
"""One copy: a, b, x, y are its situations (sa, sb, sx, sy), l1 to l6 the labels of P1 to P6."""

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
    calls = []
    for i in range(1, k + 1):
        situations = ", ".join(f"{name}{i}" for name in "abxy")
        labels = ", ".join(str(10 * i + label) for label in range(1, 7))
        calls.append(f'Copy[{situations}, {labels}, "{kinds.get(i, "alone")}"]')
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
