"""The processes of R Tables 1 and 2 that act on situations, as controls of the executer.

Each is a thin layer over `situations`: what it does to the store is there, what it means is in docs/reactor.md and,
case by case, in `rs.leaves`. SIT opens a body: what follows it serves the instance that it delivered.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from planner_reactor.reactor.instances import Instance, Reaction
from planner_reactor.reactor.situations import Situations
from planner_reactor.rs.migration import migrated
from planner_reactor.rs.terms import Value
from planner_reactor.rs.vocabulary import BUILT_IN, Signature
from planner_reactor.runtime import Body, Outcome, Strand

STOPPED = Outcome(True)
ERROR = Outcome(False, cause="error")

Begin = Callable[[Strand, tuple[Value, ...]], Outcome | None]


@dataclass(slots=True)
class BuiltIn:
    """A control made of functions: how it begins, and what an abort while it waits takes back."""

    name: str
    begin: Begin
    withdraw: Callable[[Strand], None] = lambda strand: None
    resting: bool | Callable[[Strand], bool] = False
    announces: bool = False
    opens_body: bool = False
    guards: bool = False

    @property
    def signature(self) -> Signature:
        return BUILT_IN[self.name]

    def start(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome | None:
        return self.begin(strand, arguments)

    def cancel(self, strand: Strand) -> None:
        self.withdraw(strand)


def served(body: Body) -> tuple[Instance, Reaction]:
    """Whom a body serves, and by which reaction: what `Sit` gave as its context."""
    context: tuple[Instance, Reaction] = body.context  # type: ignore[assignment]  # only SIT opens bodies
    return context


def owner_of(strand: Strand) -> Instance | None:
    """The instance whose body this strand runs in: it owns what is asserted there."""
    return None if strand.body is None else served(strand.body)[0]


class Sit:
    """SIT[s]<k, x…>: wait for an instance that this reaction may serve; what follows is its body."""

    name = "SIT"
    signature = BUILT_IN["SIT"]
    opens_body = True
    guards = False
    resting = True
    announces = False

    def __init__(self, situations: Situations) -> None:
        self._situations = situations
        self._serving = situations.serving
        self._waiting: dict[Strand, tuple[str, Reaction]] = {}
        self.bodies: dict[Body, None] = {}  # in service, in the order of their beginning

    def start(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome | None:
        situation, reaction = str(arguments[0]), (strand.guard, strand.site)
        instance = self._serving.deliver(self._situations.named(situation), reaction, opens=strand.pc.opens)  # type: ignore[attr-defined]
        if instance is None:
            self._waiting[strand] = (situation, reaction)
            self._serving.waits(self._situations.named(situation), reaction, strand)
            return None
        self._waiting.pop(strand, None)
        return Outcome(True, (instance.number, *instance.arguments), context=(instance, reaction))

    def cancel(self, strand: Strand) -> None:
        situation, reaction = self._waiting.pop(strand)
        self._serving.left_waiting(self._situations.named(situation), reaction, strand)

    def opened(self, strand: Strand, body: Body) -> None:
        instance, reaction = served(body)
        self.bodies[body] = None
        self._situations.enter(instance, reaction)

    def closed(self, body: Body) -> None:
        instance, reaction = served(body)
        del self.bodies[body]
        self._situations.leave(instance, reaction, cut=body.outcome == "killed")


class Controls:
    """The controls that act on one store of situations."""

    def __init__(self, situations: Situations) -> None:
        self._situations = situations
        self._waits: dict[Strand, str] = {}
        self.functions: Mapping[str, Callable[..., Value]] = {}  # of the host
        self.sit = Sit(situations)

    def __iter__(self) -> Iterator[BuiltIn | Sit]:
        store = self._situations
        yield self.sit
        for name in ("ASSERT", "REASSERT"):
            again = name == "REASSERT"
            yield BuiltIn(name, self._assert(again), store.cancel, resting=store.is_queued, announces=True)
        yield BuiltIn("SUCCEED", self._finish(ok=True))
        yield BuiltIn("FAIL", self._finish(ok=False))
        yield BuiltIn("UPDATE", self._update)
        for name in ("WAIT", "WAITINHIBIT", "DRAIN"):
            yield BuiltIn(name, self._wait(name), self._left_wait, announces=True)
        yield BuiltIn("WAITOLD", self._wait_old, self._left_wait, announces=True)
        yield BuiltIn("RENEW", self._renew)
        yield BuiltIn("MIGRATE", self._migrate)
        yield BuiltIn("INHIBIT", self._inhibit)
        yield BuiltIn("UNINHIBIT", self._uninhibit)
        yield BuiltIn("DISABLE", self._disable)
        yield BuiltIn("ENABLE", self._enable)

    def _assert(self, again: bool) -> Begin:
        def begin(strand: Strand, arguments: tuple[Value, ...]) -> Outcome | None:
            situation, *values = arguments
            if not isinstance(situation, str):
                return ERROR
            cause = self._situations.begin(situation, tuple(values), owner_of(strand), strand, again=again)
            return Outcome(False, cause=cause) if cause else None

        return begin

    def _finish(self, *, ok: bool) -> Begin:
        def begin(strand: Strand, arguments: tuple[Value, ...]) -> Outcome:
            self._situations.finish(str(arguments[0]), arguments[1], ok=ok)
            return STOPPED

        return begin

    def _update(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome:
        situation, number, *values = arguments
        instance = self._situations.get(str(situation), number)
        if instance is not None and instance.status == "on":
            instance.values = tuple(values)
        return STOPPED

    def _wait(self, name: str) -> Begin:
        def begin(strand: Strand, arguments: tuple[Value, ...]) -> None:
            self._waits[strand] = str(arguments[0])
            self._situations.wait(name, str(arguments[0]), strand, strand.root)

        return begin

    def _wait_old(self, strand: Strand, arguments: tuple[Value, ...]) -> None:
        self._waits[strand] = str(arguments[0])
        self._situations.wait_old(str(arguments[0]), strand)

    def _renew(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome:
        self._situations.renew(str(arguments[0]))
        return STOPPED

    def granted(self, strand: Strand) -> None:
        """A WAIT, WAITINHIBIT, DRAIN or WAITOLD of this strand has ended."""
        self._waits.pop(strand, None)

    def _left_wait(self, strand: Strand) -> None:
        self._situations.left_wait(self._waits.pop(strand), strand, strand.root)

    def _migrate(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome:
        situation, *how = arguments
        self._situations.migrate(str(situation), lambda old: migrated(old, how, self.functions))
        return STOPPED

    def _inhibit(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome:
        self._situations.inhibit(str(arguments[0]), strand.root)
        return STOPPED

    def _uninhibit(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome:
        self._situations.uninhibit(str(arguments[0]), strand.root)
        return STOPPED

    def _disable(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome:
        self._situations.disable(str(arguments[0]), str(arguments[1]))
        return STOPPED

    def _enable(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome:
        self._situations.enable(str(arguments[0]), str(arguments[1]))
        return STOPPED


def commits(commit: Callable[[int], bool]) -> BuiltIn:
    """COMMIT[n]: asks for an adaptation to be made durable; aborts if that cannot be done (cause error)."""

    def begin(strand: Strand, arguments: tuple[Value, ...]) -> Outcome:
        number = arguments[0]
        return STOPPED if isinstance(number, int) and commit(number) else ERROR

    return BuiltIn("COMMIT", begin)
