"""Random programs in RS, as text: definitions, and processes that are started together.

One seed, one program. All operators, ports, delays, tests, basic processes, results and expressions (some without a
value), situations with nested and repeated ASSERTs, drains and the other controls in scripts of their own roots,
guards with KILL, POST and ADD, monitors, definitions with clauses, results and tail calls. Every name of a result
occurs once, so no two siblings clash; every loop and recursion takes a step in each round.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, field

from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.terms import Process, Program
from tests.conformance.crowds import crowd


@dataclass(frozen=True)
class Example:
    """A program to be run: its definitions and its roots, as text and as terms."""

    definitions: str
    roots: tuple[str, ...]
    program: Program = field(init=False, compare=False)
    processes: tuple[Process, ...] = field(init=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "program", parse_program(self.definitions, file="definitions"))
        found = tuple(parse_process(text, file=f"root{n}") for n, text in enumerate(self.roots, 1))
        object.__setattr__(self, "processes", found)

    def __str__(self) -> str:
        return "\n".join([self.definitions, *(f"root {n}: {text}" for n, text in enumerate(self.roots, 1))])


def example(seed: int) -> Example:
    """The program of a seed: in each tenth several processes wait for the same."""
    return Example("", crowd(seed)) if seed % 10 == 9 else _Texts(seed).example()


CONTROLS = (
    "DRAIN[s]", "DRAIN[t]", "WAIT[s]", "WAIT[t]", "WAITINHIBIT[t]", "WAITINHIBIT[s]", "INHIBIT[s]", "INHIBIT[t]",
    "UNINHIBIT[s]", "UNINHIBIT[t]", "DISABLE[s, A]", "ENABLE[s, A]", "DISABLE[t, A]", "ENABLE[t, A]", "KILL[1]",
    "KILL[2]", "KILL[3]", "KILL[3]", "KILL[7]", "KILL[9]", "POST[7]", "POST[8]", "POST[1]", "ADD<m>", "Delay[1]",
    "Slow", "Term[1]",
    "DRAIN[s] # Delay[1]", "DRAIN[t] # Delay[0.5]", "WAIT[t] # Delay[1]", "WAITINHIBIT[s] # Delay[2]",
    "KILL[2] # Delay[1]", "POST[7] # Delay[1]", "ASSERT[s, 1] # Delay[1]", "ASSERT[t, 2]", "REASSERT[t, 1] # Delay[3]",
    "ASSUMONITOR[A, 500] # Delay[1]", "HOLDMONITOR[A, 0]", "REPORT[done, 1]", "SUCCEED[s, 1]", "FAIL[t, 1]",
    "UPDATE[s, 1, 5]", "SIT[t]<k>", "RENEW[s]", "RENEW[t]", "RETIRE[1]", "RETIRE[7]", "RETIRE[9]", "WAITOLD[s]",
    "WAITOLD[t] # Delay[1]", "DISABLED[s]<k>", "DISABLED[t] # Delay[1]", "ENABLED[s]", "ENABLED[t]", "FREEZE[s]",
    "FREEZE[t]", "FREEZE[s]", "MIGRATE[s, 1]", "MIGRATE[t, twice]",
)  # fmt: skip
"""What scripts are made of."""

HOLDING = (
    "(Delay[0.5]) ; (DRAIN[s]) ; (UNINHIBIT[s])",
    "(Delay[1]) ; (DRAIN[s]) ; (DRAIN[t]) ; (Delay[1]) ; (UNINHIBIT[s])",
    "(DISABLE[t, A]) ; (Delay[1]) ; (DRAIN[s] # Delay[2]) ; (ENABLE[t, A])",
    "(DRAIN[t]) ; (Delay[1]) ; (FAIL[s, 1]) ; (SUCCEED[s, 2]) ; (Delay[1])",
    "(DISABLE[s, A]) ; (Delay[1]) ; (ENABLE[s, A]) ; (DRAIN[s]) ; (DRAIN[t]) ; (UNINHIBIT[t]) ; (UNINHIBIT[s])",
    "(DISABLE[t, A]) ; (DISABLE[s, B]) ; (DISABLE[t, A]) ; (Delay[2]) ; (ENABLE[s, B])",
    "(Delay[1]) ; (FREEZE[t]) ; (Delay[1]) ; (FREEZE[s]) ; (Delay[1]) ; (UNINHIBIT[s]) ; (UNINHIBIT[t])",
    "(DISABLE[s, A]) ; (Delay[1]) ; (MIGRATE[s, twice]) ; (Delay[1]) ; (ENABLE[s, A])",
    "(DRAIN[t]) ; (Delay[1]) ; (MIGRATE[t, 2]) ; (DRAIN[s]) ; (Delay[1]) ; (MIGRATE[s, broken])",
)
"""Scripts that hold ASSERTs back while those who made them come to their ends."""

NESTING = (
    "Delay[1] ; ASSERT[t, {x}]", "Slow ; REASSERT[t, {x}]", "ASSERT[t, 1]<{y}> ; ASSERT[t, {x}]", "ASSERT[t, 2]<{y}>",
    "(ASSERT[t, {x}] # Slow) ; REASSERT[t, {x}]", "ASSERT[t, 1] | (Delay[1] : ASSERT[t, 2])", "REASSERT[t, {x}]<{y}>",
    "Term[2] : ASSERT[s, {x}]", "Delay[1] ; FREEZE[t] ; ASSERT[t, {x}]", "Delay[1] : ~FREEZE[s] : ASSERT[t, {x}]",
)  # fmt: skip
"""What bodies of s assert."""

ADAPTING = (
    "(DRAIN[s]) : (KILL[1]) : (POST[7]) : (UNINHIBIT[s])",
    "(DRAIN[s]) : (DRAIN[t]) : (KILL[2]) : (KILL[1]) : (POST[8]) : (UNINHIBIT[t]) : (UNINHIBIT[s])",
    "(WAITINHIBIT[s]) : (KILL[1]) : (POST[7]) : (UNINHIBIT[s])",
    "(Delay[1]) ; (KILL[1]) ; (Delay[1]) ; (POST[7]) ; (KILL[2]) ; (POST[8]) ; (KILL[7])",
    "(Delay[1]) ; ((KILL[2] # Delay[1]) | (KILL[1] # Delay[3])) ; (POST[1])",
    "(Quick) ; (POST[7]) ; (Delay[0.5]) ; (RENEW[s]) ; (RETIRE[1]) ; (WAITOLD[s]) ; (KILL[1])",
    "(DISABLE[t, A]) : (Delay[1]) : ((KILL[3] # Delay[2]) | (KILL[1] # Delay[1])) ; (ENABLE[t, A])",
    "(DRAIN[s] # Delay[0.5]) ; (DRAIN[t] # Term[1]) ; (KILL[1] # Delay[1])",
    "(Delay[1]) ; (FREEZE[s]) ; (Slow) ; (UNINHIBIT[s])",
    "(Delay[0.5]) ; (FREEZE[s]) ; (KILL[1]) ; (DRAIN[s]) ; (POST[7])",
    "((DISABLED[t]) :; (ASSERT[s, 1] ; ENABLED[t])) | ((Delay[1]) ; (DISABLE[t, A]) ; (Delay[2]) ; (ENABLE[t, A]))",
    "(Delay[0.5]) ; (KILL[3] # Delay[1]) ; (KILL[3] # Delay[2]) ; (KILL[2] # Delay[1])",
    "(DRAIN[s]) : (Delay[0.5]) : (MIGRATE[s, twice]) : (KILL[3]) : (POST[3]) : (Delay[0.5]) : (UNINHIBIT[s])",
    "(DISABLE[s, A]) : (Delay[1]) : (MIGRATE[s, 1]) : (KILL[3]) : (DISABLE[s, B]) : (ENABLE[s, B]) : (ENABLE[s, A])",
    "(DISABLE[t, A]) : (Slow) : (MIGRATE[t, 1]) : ((KILL[3] # Delay[1]) | (FREEZE[s])) ; (ENABLE[t, A])",
    "(RENEW[t]) : (POST[8]) : (RETIRE[2]) : (RETIRE[2]) : (WAITOLD[t]) : (KILL[2]) : (POST[2])",
)
"""Scripts that change reactions, well and badly."""

PLAIN = (
    "STOP", "ABORT", "NIL", "Quick", "Quick", "Slow", "Slow", "Delay[0]", "Delay[1]", "Delay[2]", "Term[2]", "Never",
    "SUSPEND[500]", "OUT[p, {x}]", "OUT[q, {x}]", "OUT[p, {x}]", "IN[p]", "GTR[{x}, 1]", "LST[{x}, 2]",
    "Equal[{x}, 1]", "Equal[{x}, 1.5, 0.5]", "Delay[{x}]", "OUT[p, red]", "Takes[{x}]", "Takes[red]", "GTR[{x}, red]",
    "REPORT[{x}]", "Delay[red]", "Fixed", "OUT[{x}, 1]",
)  # fmt: skip
"""Leaves that may stand anywhere; {x} is an expression."""


class _Texts:
    def __init__(self, seed: int) -> None:
        self.draw = random.Random(seed)
        self.names = 0
        self.calls: tuple[str, ...] = ()
        self.large = seed % 4 == 0  # most are small: what two parts do to each other shows in few of them
        self.depth = self.draw.choice([1, 1, 2, 2, 3]) if self.large else self.draw.choice([0, 0, 1, 1, 2])

    def example(self) -> Example:
        draw = self.draw
        definitions = self.definitions() if draw.random() < (0.4 if self.large else 0.15) else []
        if draw.random() < 0.5:
            roots = [self.process(self.depth + 1, []) for _ in range(draw.choice([1, 1, 1, 2]))]
        else:
            roots = self.reactor(definitions)
        return Example("\n".join(definitions), tuple(roots))

    def fresh(self) -> str:
        self.names += 1
        return f"x{self.names}"

    # -- definitions

    def definitions(self) -> list[str]:
        """Clauses with a result, a tail call, a recursion through `|`; each may call those before it."""
        w, z = self.fresh(), self.fresh()
        texts = [
            f"Pick[0]<{w}> = Quick : ({self.process(1, [])}) : Give<{w}>",
            f"Pick[1]<{w}> = Delay[1] : Ran[0, 2]<{w}>",
            f'Pick["red"]<{w}> = Slow & IN[q]<{w}>',
        ]
        self.calls += ("Pick[{x}]<{y}>", "Pick[red]", "Pick[5]")
        texts.append(f"Count[n] = GTR[n, 0] : ({self.process(1, ['n'])}) ; Slow ; Count[n - 1]")
        self.calls += ("Count[2]", "Count[{x}]")
        texts.append(f"Fan[n] = GTR[n, 0] : (Slow | ({self.process(1, ['n'])}) | Fan[n - 1])")
        self.calls += ("Fan[2]",)
        texts.append(f"Sum[a]<{z}> = ({self.process(1, ['a'])}) ; Give<{z}>")
        self.calls += ("Sum[{x}]<{y}>", "Sum[{x}]")
        return texts

    # -- reactors and the scripts that change them

    def reactor(self, definitions: list[str]) -> list[str]:
        draw = self.draw
        twice = [1, 1, 2] if self.large else [1]
        served = [self.reaction(s) for s in ("s", "t") for _ in range(draw.choice(twice))]
        guarded = [f"(E[{n}] # {text})" if draw.random() < 0.6 else text for n, text in enumerate(served, 1)]
        drivers = [f"({self.process(self.depth, [], True)})" for _ in range(draw.choice(twice))]
        if draw.random() < 0.4:  # a reaction without a SIT, as the root reactions of R Fig. 8
            roots = [drivers[0], drivers[0], "(Delay[1] :; ASSERT[s, 1])", "(ASSERT[s, 1] :; Quick)"]
            drivers[0] = f"(E[3] # {draw.choice(roots)})"
        if draw.random() < 0.4:
            definitions += [f"React[{n}] = {self.reaction(draw.choice('st'))}" for n in (7, 8)]
            guarded.append("(ADD<m> :: (E[m] # React[m]))")
        if draw.random() < 0.15:
            guarded.append("STREAM[p, 1]")
        if draw.random() < 0.3:  # bodies are cut
            guarded[0] = f"({guarded[0]} # {draw.choice(['Delay[1]', 'Slow', 'Term[2]', 'Delay[1.5]'])})"
        scripts = [self.script() for _ in range(draw.choice([0, 1, 1, 2] if self.large else [0, 1]))]
        return [" | ".join([*guarded, *drivers]), *scripts]

    def reaction(self, situation: str) -> str:
        draw = self.draw
        loop = draw.choice([":;", ":;", "::"])
        k, x = self.fresh(), self.fresh()
        sensing = draw.random() < 0.1
        body = self.process(self.depth, [x], situation == "s", (situation, k))
        if situation == "s" and draw.random() < 0.5:
            body = f"({draw.choice(NESTING).format(x=x, y=self.fresh())}) {draw.choice(';;:|&')} ({body})"
        end = draw.choice([f"SUCCEED[{situation}, {k}]", f"SUCCEED[{situation}, {k}]", f"FAIL[{situation}, {k}]"])
        update = f"UPDATE[{situation}, {k}, {x}, 7] ; " if draw.random() < 0.4 else ""
        link = draw.choice([";", ";", ";", ":"])
        reaction = f"(SIT[{situation}]<{k}, {x}> {loop} (({body}) {link} ({update}{end})))"
        if sensing:  # once served, it ends; or what is served is no body
            once = f"(SIT[{situation}]<{k}, {x}> : (({body}) ; {end}))"
            reaction = draw.choice([once, f"(SIT[{situation}] | ({reaction}))"])
        return reaction

    def script(self) -> str:
        if self.draw.random() < 0.3:  # what the bodies of s assert is held back, then what they serve is withdrawn
            return self.draw.choice(HOLDING)
        if self.draw.random() < 0.3:
            return self.draw.choice(ADAPTING)
        parts = [self.draw.choice(CONTROLS) for _ in range(self.draw.randint(1, 5))]
        parts = [p.replace("<m>", f"<{self.fresh()}>").replace("<k>", f"<{self.fresh()}>") for p in parts]
        return self.draw.choice([" ; ", " : "]).join(f"({p})" for p in parts)

    # -- processes

    def process(
        self, depth: int, bound: list[str], situations: bool = False, key: tuple[str, str] | None = None
    ) -> str:
        """`situations`: it may assert; `key`: the situation that it serves, and the name of the instance."""
        if depth <= 0 or self.draw.random() < 0.2:
            return self.leaf(bound, situations, key)
        kind = self.draw.choice([";", ":", ";", ":", "|", "&", "#", "#", "~", "if", ":;", "::"])

        def part(names: list[str]) -> str:
            return f"({self.process(depth - 1, names, situations, key)})"

        match kind:
            case "~":
                return f"~{part(bound)}"
            case "if":
                return f"(if {part(bound)} then {part(bound)} else {part(bound)})"
            case ":;" | "::":
                return self.loop(kind, bound, part)
            case ";" | ":" if self.draw.random() < 0.5:
                x = self.fresh()
                return f"({self.binder(x)} {kind} {part([*bound, x])})"
        parts = [part(bound) for _ in range(self.draw.choice([2, 2, 3]))]
        if kind == "#" and self.draw.random() < 0.15:  # several end at once
            parts += self.draw.choice([("ABORT", "STOP"), ("STOP", "ABORT"), ("(Quick # Quick)", "~STOP")])
        return kind.join(parts)

    def loop(self, kind: str, bound: list[str], part: object) -> str:
        x, most = self.fresh(), self.draw.choice([1, 2])
        port = self.draw.choice("pq")
        condition = self.draw.choice([
            f"(IN[{port}]<{x}> # Delay[{most}]) : GTR[{x}, 0]",
            f"Give<{x}> : GTR[{x}, 0]",
            f"IN[{port}]<{x}>",
            f"(Quick : Delay[1]) ; Give<{x}>",
        ])  # fmt: skip
        return f"(({condition}) {kind} {part([*bound, x])})"  # type: ignore[operator]

    def binder(self, x: str) -> str:
        forms = ("Give{}", "IN[p]{}", "Ran[0, 2]{}", "(Give{} # Delay[1])", "~Give{}", "Ran[red, 2]{}")
        return self.draw.choice(forms).format(f"<{x}>")

    def leaf(self, bound: list[str], situations: bool, key: tuple[str, str] | None) -> str:
        draw = self.draw
        x = self.expression(bound)
        if situations and draw.random() < 0.5:
            kind = draw.choice(["ASSERT", "REASSERT", "ASSERT"])
            s = draw.choice(["t"] * 9 + ["s"]) if key else draw.choice(["s", "t"])
            return f"{kind}[{s}, {x}]" + draw.choice(["", "", f"<{self.fresh()}>", f"<{self.fresh()}, {self.fresh()}>"])
        if key and draw.random() < 0.2:
            s, k = key
            return draw.choice([f"SUCCEED[{s}, {k}]", f"FAIL[{s}, {k}]", f"STUB[{s}]", f"(STUB[{s}] ; FAIL[{s}, {k}])"])
        if self.calls and draw.random() < 0.4:
            return draw.choice(self.calls).format(x=x, y=self.fresh())
        return draw.choice(PLAIN).format(x=x)

    def expression(self, bound: list[str]) -> str:
        x = self.draw.choice([*bound, *bound, "1", "2", "0"])
        if self.draw.random() < 0.85:
            return x
        return self.draw.choice([f"{x} + 1", f"2 * {x}", f"-{x}", f"1 / {x}", f"twice({x})", f"broken({x})"])
