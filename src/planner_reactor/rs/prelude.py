"""Schemas that every program may use, written in RS terms of the built-in processes.

STREAM is printed in X §4.1.2 without a quantum, and is then Zeno: thousands of rendezvous at one instant.
Ours waits a quantum after each (docs/language.md, Transitions).
"""

from __future__ import annotations

from planner_reactor.rs.terms import STOP, Call, Loop, Number, Parameter, Program, Schema, Variable, seq

QUANTUM = 0.01
"""Seconds between two writes of a STREAM."""

STREAM = Schema(
    "STREAM",
    (Parameter("y"), Parameter("v")),
    (),
    Loop(seq(Call("OUT", (Variable("y"), Variable("v"))), Call("Delay", (Number(QUANTUM),))), STOP),
)

PRELUDE = Program((STREAM,))
