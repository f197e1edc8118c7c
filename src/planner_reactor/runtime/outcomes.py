"""What a leaf may do: the outcome of a process, and the face of a built-in process (`Control`).

A `Control` is a process that the executer offers to programs but does not know: the reactor's processes of R Tables 1
and 2 are controls, and so is each basic process of a host. An abort carries a cause for traces and perceptions
(failed, withdrawn, assumption, stub, budget, cancelled, error); the algebra sees only stop or abort.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol, TypeAlias

import msgspec

from planner_reactor.rs.terms import Value
from planner_reactor.rs.vocabulary import Signature
from planner_reactor.runtime.strands import Body, Strand

Label: TypeAlias = tuple[str, tuple[Value, ...], str, tuple[Value, ...]]
"""(name, arguments, "ok" | "ab" | "wait", values): what an observer sees of a step."""

Observer: TypeAlias = Callable[[Label], object]


class Outcome(msgspec.Struct, frozen=True):
    """How a process ended: stop (`ok`) or abort, with the values of its results.

    `context` is what a control that opens a body wants to find again in `Body.context`.
    """

    ok: bool
    values: tuple[Value, ...] = ()
    cause: str = ""
    context: object = None


STOPPED = Outcome(True)


class Control(Protocol):
    """A process that the executer runs without knowing what it means.

    `opens_body`: what follows it by `;` `:` `:;` `::` is the body of what it delivered (SIT). `guards`: as a direct
    part of a `#` it labels the other parts (E). `resting`: a process that waits here is not in service; may be a
    function of the strand. `announces`: to begin to wait is a step that observers see, with status "wait".
    """

    @property
    def name(self) -> str: ...

    @property
    def signature(self) -> Signature: ...

    @property
    def opens_body(self) -> bool: ...

    @property
    def guards(self) -> bool: ...

    @property
    def resting(self) -> bool | Callable[[Strand], bool]: ...

    @property
    def announces(self) -> bool: ...

    def start(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome | None:
        """Begin, or try again after `Executer.wake`. None: it waits, until `Executer.end` (which it may call here)."""

    def cancel(self, strand: Strand) -> None:
        """The strand was aborted while it waited here (N9). Called exactly once, and never after it has ended."""


class OpensBody(Control, Protocol):
    """A control with `opens_body`."""

    def opened(self, strand: Strand, body: Body) -> None:
        """The body of what was delivered has begun; `body.context` is the outcome's context."""

    def closed(self, body: Body) -> None:
        """The body has ended or was aborted, after its content."""


class Guards(Control, Protocol):
    """A control with `guards`."""

    def guard_set(self, label: Value, strand: Strand, siblings: tuple[Strand, ...]) -> None:
        """A `#` with this guard came to life: `strand` will wait in the guard, `siblings` are the other parts."""
