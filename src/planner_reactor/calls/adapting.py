"""`verify --adapt`: may this adaptation of a reactor be applied? (R §5.5)

The reactor is a process of a file, as it is written: guarded reactions `E[n] # …` beside `ADD<m> :: (E[m] # P[m])`. The
adaptation is a process too. One that only says what goes and what comes (`KILL[2] : POST[4]`) is put into the words of
the mode, top-down and bottom-up, as the reactor would; any other is taken as it stands, so that wrong protocols can be
tried. Every way in which both can go on is looked at; processes of the host may end at any age.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace as renewed
from math import inf, isinf
from pathlib import Path
from typing import Any

from msgspec.structs import replace

from planner_reactor.analysis.labels import show_label
from planner_reactor.analysis.protocols import LAWS, LIMIT, Checked, Counterexample, Protocol, check
from planner_reactor.calls.hosts import HostSource, find_host
from planner_reactor.calls.inputs import one_of, read_text, whole
from planner_reactor.calls.processes import Subject, subject
from planner_reactor.calls.replaying import replay
from planner_reactor.errors import InputError, nearest
from planner_reactor.rs.bounds import Bounds
from planner_reactor.rs.configurations import World
from planner_reactor.rs.loading import load_process
from planner_reactor.rs.printer import show
from planner_reactor.rs.reactions import (
    REACTION,
    Reaction,
    Surgery,
    children,
    drain_script,
    reaction_of,
    removal_script,
    versions_script,
    wait_script,
)
from planner_reactor.rs.terms import (
    Call,
    Disable,
    Number,
    Process,
    Program,
    Schema,
    Symbol,
    Text,
    calls,
    cond,
    operands,
)
from planner_reactor.runtime import Host, Scheduler, VirtualClock

LONG = 1e6
"""Seconds that a process may take where any age will do."""

MODES = ("drain", "wait", "versions")
HOLDING = ("DRAIN", "WAIT", "WAITINHIBIT", "INHIBIT", "UNINHIBIT", "RENEW", "RETIRE", "WAITOLD")


def verify_adaptation(
    file: str | Path,
    process: str,
    adapt: str,
    *,
    mode: str = "drain",
    host: HostSource | None = None,
    limit: int = LIMIT,
) -> dict[str, Any]:
    """Verify `adapt`, a script or a file with one, for the reactor `process` of a file `*.rsl`.

    Returns `consistent`, `safe`, `atomic`, `local`, `bounded` (does each hold?), `bound_s` (seconds; None if it depends
    on more than windows), `broken` (the law with the shortest counterexample, or None), `why`, `counterexample` (its
    steps), `cycle` (how many of them, at the end, go round for ever), `replayed` (does the executer
    take these steps?), `script` and `states`. Raises SourceError for a
    wrong text, InputError for a wrong argument, BudgetError above `limit` states.
    """
    limit = whole("limit", limit, 1)
    one_of("mode", mode, MODES)
    asked = subject(file, process, host=host)
    script = load_process(_text(adapt), given=asked.program, signatures=asked.world.signatures)
    present = _reactions(asked.program, asked.call)
    surgery = _surgery(script, present, asked.program)
    if not _named(script, HOLDING):
        script = _worded(mode, surgery, present)
    found = _looked_at(asked, script, surgery, limit)
    told = _told(found, script, _bound(script, present, asked, host))
    return {**told, "replayed": None if found.first is None else _replayed(asked, script, found.first)}


def _replayed(asked: Subject, script: Process, found: Counterexample) -> bool:
    """Does the executer take the same steps? What goes round does so three times."""
    around = found.path[len(found.path) - found.cycle :]
    return replay([asked.call, script], _opened(asked.world, LONG), (*found.path, *around, *around)).done


def _opened(world: World, longest: float) -> World:
    """The same with processes of the host that may end at any age."""
    own = {name: renewed(s, window=(0.0, longest)) for name, s in world.signatures.items() if s.window}
    return replace(world, signatures={**world.signatures, **own})


def _text(adapt: str) -> str:
    return read_text(adapt) if adapt.endswith(".rsl") or Path(adapt).is_file() else adapt


# ------------------------------------------------------------------------------------- the reactor, read off its text


def _reactions(program: Program, call: Call) -> list[Reaction]:
    """The guarded reactions that the process consists of: `E[n] # P[…]`."""
    found: dict[int, Reaction] = {}
    waiting: list[Process] = [s.body for s in program.clauses(call.name)]
    while waiting:
        term = waiting.pop()
        match term:
            case Disable((Call(name="E", arguments=(Number(int() as label),)), reaction)):
                found[label] = _reaction(label, reaction, program)
            case _:
                waiting += operands(term)
    if not found:
        raise InputError(f"{call.name} has no guarded reactions, expected parts such as E[1] # P[1]")
    return [found[label] for label in sorted(found)]


def _reaction(label: int, process: Process, program: Program) -> Reaction:
    """The reaction as a clause `P[label]`, whatever it is called in the text."""
    while isinstance(process, Call) and (clauses := program.clauses(process.name)):
        values = tuple(a.value if isinstance(a, Number | Text) else None for a in process.arguments)
        process = next((s.body for s in clauses if s.accepts(values)), clauses[0].body)
    made = reaction_of(Schema(REACTION, (Number(label),), (), process))
    assert made is not None
    return made


def _surgery(script: Process, present: list[Reaction], program: Program) -> Surgery:
    """What a script removes and adds, and the situations that it holds or that these serve."""
    kills, adds = tuple(_labels(script, "KILL", "RETIRE")), tuple(_labels(script, "POST"))
    labels = {r.label for r in present}
    for label in kills:
        if label not in labels:
            raise InputError(f"no reaction {label} to kill, there is: {', '.join(map(str, sorted(labels)))}")
    new = [_added(label, program) for label in adds]
    moved = [r for r in (*present, *new) if r.label in (*kills, *adds)]
    served = {r.situation for r in moved if r.situation is not None}
    named = _top_down(served | set(_situations(script)), [*present, *new])
    now, after = ({r.situation for r in group} for group in (present, [*present, *new]))
    left = {r.situation for r in (*present, *new) if r.label not in kills}
    return Surgery(
        held=tuple(s for s in named if s in now),
        kills=_in_order(kills, named, present),
        adds=tuple(reversed(_in_order(adds, named, new))),
        named=tuple(named),
        removed=tuple(s for s in named if s in after and s not in left),
    )


def _added(label: int, program: Program) -> Reaction:
    clause = program.select(REACTION, (label,))
    if clause is None:
        known = [str(s.head[0].value) for s in program.clauses(REACTION) if s.head and isinstance(s.head[0], Number)]
        hint = nearest(str(label), known)
        raise InputError(f"no clause {REACTION}[{label}] to add" + (f", {hint}" if hint else ""))
    return _reaction(label, Call(REACTION, (Number(label),)), program)


def _top_down(situations: Iterable[str], reactions: list[Reaction]) -> list[str]:
    """A parent before its children."""
    below = children(reactions)
    found: list[str] = []

    def visit(name: str, trail: tuple[str, ...]) -> None:
        if name not in found and name not in trail:
            for child in below.get(name, ()):
                visit(child, (*trail, name))
            found.append(name)

    for situation in sorted(situations):
        visit(situation, ())
    return [name for name in reversed(found) if name in set(situations)]


def _in_order(labels: tuple[int, ...], named: list[str], reactions: list[Reaction]) -> tuple[int, ...]:
    """Reactions in the order of their situations; those without one first."""
    serves = {r.label: r.situation for r in reactions}
    place = {situation: n for n, situation in enumerate(named)}
    return tuple(sorted(labels, key=lambda n: place.get(serves[n] or "", -1)))


def _labels(script: Process, *names: str) -> Iterator[int]:
    for call in calls(script):
        if call.name in names and call.arguments:
            first = call.arguments[0]
            if not isinstance(first, Number):
                raise InputError(f"{show(call)} in the adaptation, expected a label such as {call.name}[4]")
            yield int(first.value)


def _situations(script: Process) -> Iterator[str]:
    for call in calls(script):
        if call.name in HOLDING and call.arguments and isinstance(call.arguments[0], Symbol | Text):
            first = call.arguments[0]
            yield first.name if isinstance(first, Symbol) else first.value


def _named(script: Process, names: Iterable[str]) -> bool:
    return any(call.name in names for call in calls(script))


# ---------------------------------------------------------------------------------------------------- what is asked


def _worded(mode: str, surgery: Surgery, present: list[Reaction]) -> Process:
    """The surgery as the mode has it; versions with what removes the old ones later."""
    match mode:
        case "wait":
            return wait_script(surgery)
        case "versions":
            killed = [r for r in present if r.label in surgery.kills]
            script = versions_script(surgery, killed)
            return cond(*(operands(script) or (script,)), removal_script(surgery, killed))
        case _:
            return drain_script(surgery)


def _looked_at(asked: Subject, script: Process, surgery: Surgery, limit: int) -> Checked:
    protocol = Protocol(
        reactor=asked.call,
        script=script,
        named=frozenset(surgery.named),
        kills=frozenset(surgery.kills),
        adds=frozenset(surgery.adds),
    )
    return check(protocol, _opened(asked.world, inf), limit=limit)


def _bound(script: Process, present: list[Reaction], asked: Subject, host: HostSource | None) -> float | None:
    """Seconds from the windows of the host's processes; None if the script waits for more than drains."""
    if _named(script, ("WAIT", "WAITINHIBIT", "WAITOLD")):
        return None
    used = find_host(host)(Scheduler(VirtualClock())) if host is not None else Host("none")
    limits = {name: process.limit for name, process in used.processes.items()}

    def served(situation: str) -> tuple[Process, ...]:
        return tuple(operands(r.schema.body)[1] for r in present if r.situation == situation)

    held = [a.name for c in calls(script) if c.name == "DRAIN" for a in c.arguments if isinstance(a, Symbol)]
    return Bounds(asked.program, used.signatures, limits, served).drains(held)


def _told(found: Checked, script: Process, bound: float | None) -> dict[str, Any]:
    endless = bound is not None and isinf(bound)
    first = found.first
    return {
        **{law: law not in found.broken and not (law == "bounded" and endless) for law in LAWS},
        "bound_s": None if endless else bound,
        "broken": first.law if first else "bounded" if endless else None,
        "why": first.why if first else "what is in service may go on for ever" if endless else "",
        "counterexample": [show_label(label) for label in first.path] if first else [],
        "cycle": first.cycle if first else 0,
        "script": show(script),
        "states": found.states,
    }
