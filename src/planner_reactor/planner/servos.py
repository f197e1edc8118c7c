"""Actions derived from environment models, in a domain for the planner (X §5: from dynamics to reactions).

`exploiting` adds to the text of a domain the schemas that follow from models of the environment. What a model takes
for granted (a condition of its dynamics, such as p < nu) is an *assumption inside the model*: `assuming` names it, and
with that relaxed, reinstated and monitored as any other (R §6). What follows from several models is there once.

Texts are paced by the interface's own timing, so that a loop through the environment is stable: what is sensed is
handed on for as long as its sensor holds it and no longer, and what moves by increments waits until the agent has
sensed what the last one did (X §4.4.2: a deviation is undone in a single step).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import msgspec
from msgspec.structs import replace

from planner_reactor.analysis.denseness import Failure, Netlist, opened
from planner_reactor.analysis.interface import Connector
from planner_reactor.errors import InputError
from planner_reactor.logic.domain import Domain
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner.dynamics import derive
from planner_reactor.planner.exploiting_text import DerivedAction
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.prelude import QUANTUM
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import STOP, Call, Disable, Loop, Number, Process, calls, cond
from planner_reactor.rs.vocabulary import Signature

SELDOM = 20_000
"""Milliseconds after which what waits for the environment to come to something has failed, unless it is said."""


WATCH = 0.1
"""Seconds between two looks at what a waiting reaction takes for granted."""


class Model(msgspec.Struct, frozen=True, kw_only=True):
    """A model of the environment: its text with the interface, the process, and what its open names are.

    `assuming` maps a condition of its dynamics to the assumption under which it is taken to hold; it may also name an
    action, which then is not selected without the assumption. `watching` says how the reaction itself can tell that an
    assumption holds: a process of RS that stops as long as it does, and aborts when it does not. `interface`: the
    sensory and motor processes that there are, if not all that the text defines.
    """

    text: str
    environment: str
    signatures: Mapping[str, Signature] = {}
    given: Mapping[str, float] = {}
    assuming: Mapping[str, str] = {}
    watching: Mapping[str, str] = {}
    interface: tuple[str, ...] | None = None
    patience_ms: int = SELDOM


class Timing(msgspec.Struct, frozen=True):
    """Of one process of the interface, in seconds: how long it takes, and for how long it then offers a value."""

    delay: float
    holds: float


def exploiting(text: str, models: Iterable[Model], *, definitions: str = "", file: str = "<text>") -> Domain:
    """The domain of this text with the actions that follow from the models. InputError where they do not fit.

    Actions of the text itself may be `definitions` in RS instead of processes of a host.
    """
    actions: dict[str, DerivedAction] = {}
    sentences: dict[str, str] = {}
    processes = {schema.name: show(schema) for schema in parse_program(definitions).schemas}
    for model in models:
        for action, process in derived(model):
            if actions.setdefault(action.name, action) is action:
                sentences[action.name], processes[action.name] = _sentence(action, model), process
    usable = _usable(list(actions.values()), text)
    plain = read_domain("\n\n".join((text, *(sentences[name] for name in usable))), file=file)
    return _with_processes(plain, processes)


def _usable(actions: list[DerivedAction], text: str) -> list[str]:
    """The names of those whose inputs something can provide: another action, or what the domain speaks of."""
    while True:
        given = {effect.atom.predicate for action in actions for effect in action.schema.effects}
        left = [a for a in actions if all(p in given or p == "Holds" or f"{p}(" in text for p in _needs(a))]
        if len(left) == len(actions):
            return [action.name for action in left]
        actions = left


def _needs(action: DerivedAction) -> list[str]:
    return [condition.atom.predicate for condition in action.schema.executability]


def derived(model: Model) -> list[tuple[DerivedAction, str]]:
    """The actions of a model with their texts, paced."""
    program = parse_program(model.text, file=model.environment)
    found = derive(program, model.environment, model.interface, signatures=model.signatures)
    world = opened(program, model.signatures, given=model.given)
    timing = {c.inner: _timing(c, Netlist(c.process, world)) for c in found.interface}
    needed = {name for a in found.actions for name in _open_conditions(a)}
    if unknown := sorted(set(model.assuming) - needed - {a.name for a in found.actions}):
        raise InputError(
            f"{model.environment} has no condition or action {unknown[0]}, but {', '.join(sorted(needed))}"
        )
    return [(action, _paced(action, timing, model)) for action in found.actions
            if set(_open_conditions(action)) <= model.assuming.keys()]  # fmt: skip


def _open_conditions(action: DerivedAction) -> list[str]:
    """Conditions on quantities of the model that no action of the agent can bring about."""
    return [fact.holds for fact in action.needed if fact.predicate == "Holds"]


def _timing(connector: Connector, nets: Netlist) -> Timing:
    port = connector.inner if connector.kind == "sensory" else connector.outer
    own = nets.local(port)
    if isinstance(own, Failure) or not all(isinstance(t, int | float) for t in (own.delay, own.resolution)):
        raise InputError(f"the timing of {connector.process.name} at {port} is not known: {own}")
    return Timing(float(own.delay), float(own.resolution))


# ------------------------------------------------------------------------------------------------- the two texts


def _sentence(action: DerivedAction, model: Model) -> str:
    """The schema in the notation of domains: open conditions are assumptions, what may never end has a limit."""
    lines = action.text.splitlines()
    for condition in _open_conditions(action):
        asked = f"    {condition} @"
        lines = [f"    {model.assuming[condition]}() @{line[len(asked):]}" if line.startswith(asked) else line
                 for line in lines]  # fmt: skip
    if action.name in model.assuming:
        lines.insert(1, f"  applicability: {model.assuming[action.name]}();")
    if action.role == "contact":
        lines.insert(1, f"  duration: 0 .. {model.patience_ms};")
    return "\n".join(lines)


def _paced(action: DerivedAction, timing: Mapping[str, Timing], model: Model) -> str:
    body = action.rs.body
    match action.role, body:
        case "drift", _:
            body = _watched(action, model) or body
        case "report", Loop(condition, Call("OUT", arguments)):
            held = Call("Delay", (Number(timing[action.ports[0]].holds),))
            body = Loop(condition, Disable((Call("OUT", arguments), held)))
        case (("approach" | "retreat"), Loop(condition, move)):
            body = Loop(cond(condition, move), Call("Delay", (Number(_settling(action, condition, timing)),)))
    head = f"[{', '.join((*action.inputs, *action.outputs))}]" if action.inputs or action.outputs else ""
    return f"{action.name}{head} = {show(body)}"


def _watched(action: DerivedAction, model: Model) -> Process | None:
    """While the environment does the work: go on as long as all that the model takes for granted is seen to hold.

    Each is watched by itself, since of one nothing may be seen for a while.
    """
    assumed = [model.assuming[condition] for condition in _open_conditions(action)]
    texts = [model.watching[name] for name in assumed if name in model.watching]
    each = [Loop(cond(Call("Delay", (Number(WATCH),)), parse_process(text)), STOP) for text in texts]
    return Disable(tuple(each)) if len(each) > 1 else each[0] if each else None


def _settling(action: DerivedAction, sensing: Process, timing: Mapping[str, Timing]) -> float:
    """Seconds from a command until everything that the agent then senses of itself is younger than its effect."""
    read = [str(show(call.arguments[0])) for call in calls(sensing) if call.name == "IN"]
    motor = max(timing[port].delay for port in action.ports)
    senses = max((timing[port].delay + timing[port].holds for port in read if port in timing), default=0.0)
    return round(motor + senses + 2 * QUANTUM, 6)


def _with_processes(domain: Domain, processes: Mapping[str, str]) -> Domain:
    return Domain(
        assumptions=domain.assumptions.values(),
        goals=domain.goals.values(),
        rules=domain.rules,
        exclusions=domain.exclusions,
        persistences=[p for some in domain.persistences.values() for p in some],
        facts=[f for some in domain.facts.values() for f in some],
        resources=domain.resources.values(),
        schemas=[replace(s, process=processes.get(s.name, s.process)) for s in domain.schemas.values()],
        file=domain.file,
    )
