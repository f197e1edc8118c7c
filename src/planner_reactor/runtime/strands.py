"""What is alive while a program runs: strands, the forks that join them, bodies in service, roots.

A *strand* is one sequential thread of a process: where it stands (`pc`), its bindings (`frame`), the calls to return
to (`stack`, linked tuples). A *fork* is one `|`, `&`, `#` or `::` that came to life; the strand that met it waits
until it is decided. Links are cleared as soon as a strand ends, so that no cyclic garbage arises. Instructions are
known here only by what a strand needs of them.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from typing import Any, Final, Protocol, TypeAlias

import msgspec

from planner_reactor.rs.terms import Value

RUNNING: Final = 0  # has the turn, or is being advanced
READY: Final = 1  # stands at a leaf and will have a turn
SILENT: Final = 2  # will be advanced to its next leaf within the present step
WAITING: Final = 3  # waits in a leaf
WOKEN: Final = 4  # waits in a leaf, and will have a turn to try again
FORKED: Final = 5  # waits for a fork
OVER: Final = 6  # ended or aborted

OUTSIDE: Final = 0  # where an instruction stands in its definition: in no loop,
SENSING: Final = 1  # in the condition of an outermost loop,
SERVING: Final = 2  # in the body of one


class _Unbound:
    __slots__ = ()

    def __repr__(self) -> str:
        return "unbound"


UNBOUND: Final = _Unbound()
"""What stands in a frame for a name that no process has bound."""

Frame: TypeAlias = list[Value]
Stack: TypeAlias = tuple[Any, Frame, "Caller", int]
"""(the rest of the stack, the caller's frame, the call, how many calls lie below)."""


class Where(msgspec.Struct, frozen=True):
    """Where an instruction stands: in which definition, in which zone of it, and (leaves) where in the text."""

    within: str = ""
    zone: int = OUTSIDE
    site: Hashable = None


NOWHERE: Final = Where()


class Instruction(Protocol):
    """One linked instruction. `silent`: it belongs to the step before it; the others are leaves."""

    @property
    def silent(self) -> bool: ...

    @property
    def where(self) -> Where: ...

    def run(self, strand: Strand) -> Instruction | None:
        """The instruction to go on with at once, nothing else being due first; None if there is none."""


class Caller(Instruction, Protocol):
    """A call that is no tail call: where to go on when it returns, and where its results go."""

    @property
    def ok(self) -> Instruction: ...

    @property
    def ab(self) -> Instruction: ...

    @property
    def targets(self) -> tuple[int, ...]: ...


class Strand:
    """One sequential thread. `body`, `root`, `guard`, `site` are for controls, the rest for the kernel."""

    __slots__ = ("after", "before", "body", "cause", "fork", "frame", "guard", "index", "link", "meter", "pc",
                 "root", "stack", "state", "value")  # fmt: skip

    def __init__(self, pc: Instruction, frame: Frame, root: Root) -> None:
        self.pc = pc
        self.frame = frame
        self.root = root
        self.state = SILENT
        self.stack: Stack | None = None
        self.fork: Fork | None = None
        self.index = 0
        self.body: Body | None = None
        self.guard: Value | None = None
        self.meter: Body | Root = root
        self.cause = ""
        self.link: Any = None  # what it waits for: a fork, a port, an entry of the scheduler, a control's own
        self.value: Value = None  # what a writer offers; what a control delivered to the body that follows
        self.before: Strand | None = None  # neighbours in the queue of a port
        self.after: Strand | None = None

    @property
    def site(self) -> Hashable:
        """The identity of the leaf's place in the text."""
        return self.pc.where.site

    @property
    def alive(self) -> bool:
        return self.state != OVER

    def child(self, pc: Instruction, frame: Frame, fork: Fork, index: int) -> Strand:
        """A strand of a fork that this one has met."""
        strand = Strand(pc, frame, self.root)
        strand.fork = fork
        strand.index = index
        strand.body = self.body
        strand.meter = self.meter
        strand.guard = self.guard
        return strand

    def release(self) -> None:
        """Clear every link: the strand is over."""
        self.state = OVER
        self.frame = _NOTHING
        self.stack = self.fork = self.body = self.link = self.value = None


class Fork:
    """A `|`, `&`, `#` or `::` that came to life.

    `parts` by index, None where one is over; for `::` that is its head, and `bodies` holds what it has spawned.
    """

    __slots__ = (
        "bodies",
        "cause",
        "depth",
        "due",
        "ended",
        "exits",
        "head",
        "live",
        "ok",
        "parent",
        "parts",
        "spawned",
    )

    def __init__(self, exits: Exits, parent: Strand, depth: int, *, ok: bool) -> None:
        self.exits = exits
        self.parent = parent
        self.parts: list[Strand | None] = []
        self.bodies: dict[int, Strand] = {}
        self.spawned = 0
        self.live = 0
        self.depth = depth  # how many `#` enclose what is below it
        self.ok = ok
        self.cause: tuple[int, str] | None = None  # of the leftmost part that aborted
        self.ended: list[tuple[int, bool, str]] = []  # parts of a `#` that have ended: index, outcome, cause
        self.due = False  # does it wait for its verdict?
        self.head: Any = None  # of `::`: where its head begins again

    def strands(self) -> list[Strand]:
        """Its live strands, left to right."""
        return [part for part in self.parts if part is not None] + list(self.bodies.values())

    def path(self) -> tuple[int, ...]:
        """Where it stands among all forks, left to right."""
        places: list[int] = []
        fork: Fork | None = self
        while fork is not None:
            strand = fork.parent
            places.append(strand.index)
            root = strand.root
            fork = strand.fork
        return (root.number, *reversed(places))


class Exits(Protocol):
    """Where the strand that met a fork goes on."""

    @property
    def ok(self) -> Instruction: ...

    @property
    def ab(self) -> Instruction: ...


class Body:
    """What follows a control that opens bodies, while it runs: a served instance, in the reactor.

    `context` is the control's own; `parent` the body around it; `outcome` is None while it runs, then "stop", "abort",
    or "killed" if it was aborted from outside.
    """

    __slots__ = (
        "close",
        "context",
        "frame",
        "instant",
        "opener",
        "outcome",
        "parent",
        "stack",
        "strand",
        "turns",
    )

    def __init__(self, context: object, parent: Body | None, strand: Strand, opener: Any, close: Instruction) -> None:
        self.context = context
        self.parent = parent
        self.strand = strand
        self.opener = opener
        self.close = close
        self.frame = strand.frame
        self.stack = strand.stack
        self.outcome: str | None = None
        self.turns = 0
        self.instant = -1.0

    def release(self) -> None:
        """Clear the links that would make cyclic garbage."""
        self.frame = _NOTHING
        self.stack = None

    def enclosing(self) -> Iterator[Body]:
        """This body and those around it, innermost first."""
        body: Body | None = self
        while body is not None:
            yield body
            body = body.parent


class Root:
    """A process that was started: `outcome` is None, "stop" or "abort"; `results` by name, once it has ended."""

    __slots__ = ("cause", "instant", "name", "number", "outcome", "results", "strand", "turns")

    def __init__(self, name: str, number: int) -> None:
        self.name = name
        self.number = number
        self.outcome: str | None = None
        self.cause = ""
        self.results: dict[str, Value] = {}
        self.strand: Strand | None = None
        self.turns = 0
        self.instant = -1.0

    def __repr__(self) -> str:
        return f"Root({self.name}, {self.outcome or 'running'})"


_NOTHING: Frame = []
