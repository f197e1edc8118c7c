"""evolves: the one readable statement of what RS means, on concrete values.

R §4.4 and X App. B define `P -c-> Q`; docs/language.md closes their gaps. The rules stand here in the order of that
page, one case each, with their ids: first the termination rules N1 to N10 (silent: they belong to the step that ends a
component), then the transitions SEQ, PAR, COM, TIME; what each leaf does is in `leaves` and `serving`. The executer is
an optimised interpreter of these rules and is held against them; `analysis` explores them.

A configuration is a tuple of roots (a program, or a reactor and the scripts that change it) over one store. After a
step everything settles: endings and the store's consequences first, then, innermost first and leftmost among equals,
the `#`s of which a part has ended.
"""

from __future__ import annotations

from collections.abc import Iterator

from msgspec.structs import replace

from planner_reactor.errors import BudgetError
from planner_reactor.rs.configurations import Config, World
from planner_reactor.rs.expressions import EvaluationError, Unbound, evaluate
from planner_reactor.rs.states import (
    Await,
    Bindings,
    Chain,
    Deciding,
    Delivered,
    Ended,
    Export,
    Group,
    Inverted,
    Keep,
    Leaf,
    Queued,
    Round,
    Run,
    Serve,
    Spawning,
    Testing,
    Wait,
    Waiting,
    bind,
    leaf_of,
    only,
    parts_of,
    variables,
    with_parts,
)
from planner_reactor.rs.store import Store
from planner_reactor.rs.terms import (
    All,
    Call,
    Cond,
    Disable,
    If,
    Loop,
    Not,
    Par,
    Process,
    Seq,
    Spawn,
    Value,
    cond,
    seq,
)

UNFOLDING_LIMIT = 100
"""Calls that may unfold without a leaf between them; guardedness is checked when a program is loaded."""


def started(
    process: Process, world: World, *, config: Config | None = None, scope: Bindings = (), number: int = 0
) -> Config:
    """A configuration in which a new root, the next if no `number` is given, runs this process beside `config`."""
    config = config or Config()
    number = number or max((n for n, _ in config.roots), default=0) + 1
    return settle(replace(config, roots=(*config.roots, (number, begin(process, scope, world)))), world)


def killed(config: Config, root: int, world: World) -> Config:
    """N9 for a whole root, which somebody outside aborts."""
    roots = tuple((n, Ended(False, cause="cancelled") if n == root else t) for n, t in config.roots)
    return settle(Config(roots, abort(config.root(root), config.store, root)), world)


# ---------------------------------------------------------------------------------------------- coming to life


def begin(process: Process, scope: Bindings, world: World, depth: int = 0) -> Run:
    """P with the bindings in scope, up to its first leaves. Silent, and without effect on the store."""
    match process:
        case Call():
            return _begin_call(process, scope, world, depth)
        case Seq(parts):
            first = _begin_left(parts[0], scope, world, depth)
            return Chain(";", first, seq(*parts[1:]), _needed(process, scope))
        case Cond(parts):
            first = _begin_left(parts[0], scope, world, depth)
            return Chain(":", first, cond(*parts[1:]), _needed(process, scope))
        case Par(parts):
            return Group("|", tuple(begin(p, scope, world, depth) for p in parts))
        case All(parts):
            return Group("&", tuple(begin(p, scope, world, depth) for p in parts))
        case Disable(parts):
            return Group("#", tuple(begin(p, scope, world, depth) for p in parts))
        case Not(body):
            return Inverted(begin(body, scope, world, depth))
        case Loop(condition, _):
            return Testing(_begin_left(condition, scope, world, depth), process, _needed(process, scope))
        case Spawn(condition, _):
            return Spawning(_begin_left(condition, scope, world, depth), process, _needed(process, scope))
        case If(test):
            return Deciding(begin(test, scope, world, depth), process, _needed(process, scope))


def _begin_left(process: Process, scope: Bindings, world: World, depth: int = 0) -> Run:
    """The left operand of `;` `:` `:;` `::`. If it is a SIT, what follows it is the body of the instance."""
    term = begin(process, scope, world, depth)
    return replace(term, opens=True) if isinstance(term, Leaf) and term.name == "SIT" else term


def _begin_call(call: Call, scope: Bindings, world: World, depth: int) -> Run:
    if call.name == "STOP":
        return Ended(True)
    if call.name == "ABORT":
        return Ended(False, cause="failed")
    try:
        arguments = tuple(evaluate(a, dict(scope), world.functions) for a in call.arguments)
    except (Unbound, EvaluationError) as problem:
        return leaf_of(call, problem=str(problem))
    if not world.defines(call.name):
        return leaf_of(call, arguments)
    return _unfold(call, arguments, world, depth)


def _unfold(call: Call, arguments: tuple[Value, ...], world: World, depth: int) -> Run:
    """N7. `N_e<y> = [body[e/z]]_{r→y}`."""
    schema = world.select(call.name, arguments)
    if schema is None:
        return leaf_of(call, problem=f"no clause of {call.name} applies")
    if depth > UNFOLDING_LIMIT:
        raise BudgetError("unfolding", f"{call.name} calls itself without a process between")
    values = zip(schema.head, arguments, strict=True)
    scope = bind(tuple((h.name, v) for h, v in values if hasattr(h, "name")))
    renamed = tuple(zip(schema.results, call.results, strict=False))
    return Export(renamed, begin(schema.body, scope, world, depth + 1))


def _needed(process: Process, scope: Bindings) -> Bindings:
    return only(scope, variables(process))


# ------------------------------------------------------------------------------------- termination: N1 to N8, N10


def terminate(term: Run, store: Store, world: World, root: int) -> tuple[Run, Store]:
    """The term with every ending drawn that follows at once; an ended part of a `#` is left for `decide`."""
    if (waits := term.waits) is not None and not (waits and any(granted(wait, store) for wait in waits)):
        return term, store
    parts = parts_of(term)
    after: list[Run] = []
    for index, part in enumerate(parts):
        new, store = terminate(part, store, world, root)
        if new is not part:
            after = after or list(parts)
            after[index] = new
    if after:
        term = with_parts(term, tuple(after))
    match term:
        case Chain():
            return _chain(term, store, world)
        case Testing() | Round():
            return _loop(term, store, world)
        case Spawning():
            return _spawning(term, store, world)
        case Serve(_, k, g, Ended() as ended):  # {x.r}_{s,k,g} = x.r, and the body leaves `run`
            return ended, store.left(k, g)
        case Await() | Queued() | Waiting():
            return _granted(term, store, root)
        case _:
            return _joined(term, world), store


def _chain(term: Chain, store: Store, world: World) -> tuple[Run, Store]:
    match term:
        # N1  ok.r;Q = ab.r;Q = r>Q[r]
        case Chain(";", Ended(_, r), rest, scope):
            return Keep(r, begin(rest, bind(scope, r), world)), store
        # N2  ok.r:Q = r>Q[r]     ab.r:Q = ab.r
        case Chain(":", Ended(True, r), rest, scope):
            return Keep(r, begin(rest, bind(scope, r), world)), store
        case Chain(":", Ended(False) as aborted):
            return aborted, store
        # SIT: what follows a delivered instance is its body
        case Chain(_, Delivered() as d, rest, scope):
            body, store = _served(d, rest, scope, store, world)
            return Keep(d.bindings, body), store
        case _:
            return term, store


def _served(d: Delivered, rest: Process, scope: Bindings, store: Store, world: World) -> tuple[Run, Store]:
    body = begin(rest, bind(scope, d.bindings), world)
    return Serve(d.situation, d.instance, d.reaction, body), store.entered(d.instance, d.reaction)


def _joined(term: Run, world: World) -> Run:
    match term:
        # N3  ~ swaps ok and ab, keeps r
        case Inverted(Ended(ok, r, cause)):
            return Ended(not ok, r, cause)
        # N4  x.r | y.r' = (x or y).(r+r')      N4'  & : (x and y)
        case Group("|" | "&" as operator, parts) if all(isinstance(p, Ended) for p in parts):
            outcomes = [p.ok for p in parts if isinstance(p, Ended)]
            ok = any(outcomes) if operator == "|" else all(outcomes)
            causes = [p.cause for p in parts if isinstance(p, Ended) and p.cause]
            bindings = bind(*(p.bindings for p in parts if isinstance(p, Ended)))
            return Ended(ok, bindings, "" if ok or not causes else causes[0])
        # N6  r > x.r' = x.(r+r')     [x.r]_A = x.(r|A)     [[T]]_{} = [T]_{}  so that tail calls take no space
        case Keep(r, Ended(ok, s, cause)):
            return Ended(ok, bind(r, s), cause)
        case Keep((), body):
            return body
        case Keep(r, Keep(s, body)):
            return Keep(bind(r, s), body)
        case Export(renamed, Ended(ok, r, cause)):
            given = dict(r)
            return Ended(ok, bind(tuple((y, given[x]) for x, y in renamed if x in given)), cause)
        case Export((), Export(_, body)) | Export((), Keep(_, body)):
            return Export((), body)
        # N10  C decides once
        case Deciding(Ended(ok, r), branches, scope):
            branch = branches.then if ok else branches.otherwise
            return Keep(r, begin(branch, bind(scope, r), world))
        case _:
            return term


def _loop(term: Testing | Round, store: Store, world: World) -> tuple[Run, Store]:
    match term:
        # N8  A:;B = A : ([B]_{} ; (A:;B))
        case Testing(Ended(True, r), loop, scope):
            return Round(Export((), begin(loop.body, bind(scope, r), world)), loop, scope), store
        case Testing(Ended(False) as aborted):
            return aborted, store
        case Testing(Delivered() as d, loop, scope):
            body, store = _served(d, loop.body, scope, store, world)
            return Round(Export((), body), loop, scope), store
        case Round(Ended(), loop, scope):
            return begin(loop, scope, world), store
        case _:
            return term, store


def _spawning(term: Spawning, store: Store, world: World) -> tuple[Run, Store]:
    """N8  A::B = A : ([B]_{} | (A::B)); ended bodies are merged away."""
    bodies = tuple(b for b in term.bodies if not isinstance(b, Ended))
    stopped = term.stopped or any(b.ok for b in term.bodies if isinstance(b, Ended))
    match term.condition:
        case Ended(True, r):
            new: Run = begin(term.loop.body, bind(term.scope, r), world)
        case Delivered() as d:
            new, store = _served(d, term.loop.body, term.scope, store, world)
        case Ended(False, r, cause) if not bodies:
            return Ended(stopped, r, "" if stopped else cause), store
        case _ if len(bodies) == len(term.bodies):
            return term, store
        case _:
            return replace(term, bodies=bodies, stopped=stopped), store
    again = _begin_left(term.loop.condition, term.scope, world)
    return Spawning(again, term.loop, term.scope, (*bodies, Export((), new)), stopped), store


def granted(wait: Wait, store: Store) -> bool:
    """Does the store end this ASSERT, WAIT, WAITINHIBIT, DRAIN or WAITOLD now?"""
    match wait:
        # an await returns once the instance, its bodies in service and its descendants have ended
        case Await(k):
            return store.complete(k)
        case Queued(ticket):
            return any(q.ticket == ticket and q.fate is not None for q in store.queue)
        case Waiting("WAITOLD", situation, version):
            return not store.older(situation, version)
        case Waiting(_, situation):
            return store.quiescent(situation)


def _granted(term: Wait, store: Store, root: int) -> tuple[Run, Store]:
    if not granted(term, store):
        return term, store
    match term:
        case Await(k, results, again):
            instance = store.get(k)
            assert instance is not None
            store = store.without(k)
            bindings = bind(tuple(zip(results, instance.values, strict=False)))
            if instance.status == "ok" or again is None:
                return Ended(instance.status == "ok", bindings, instance.cause), store
            if store.gone(instance.owner):
                return Ended(False, cause="withdrawn"), store
            return again, store
        case Queued(ticket, leaf):
            fate = next(q.fate for q in store.queue if q.ticket == ticket)
            store = store.left_queue(ticket)
            if isinstance(fate, str):
                return Ended(False, cause=fate), store
            assert fate is not None
            return Await(fate, leaf.results, leaf if leaf.name == "REASSERT" else None), store
        case Waiting("WAITINHIBIT", s):
            return Ended(True), store.inhibit(s, root, "inhibit")
        case Waiting("DRAIN", s):
            return Ended(True), store.drain_ended(s, root).inhibit(s, root, "drain")
        case Waiting():
            return Ended(True), store


# ---------------------------------------------------------------------------------------- settling: N5 and N9


def settle(config: Config, world: World) -> Config:
    """Everything that belongs to the present step, to the end; ended roots release what they held."""
    while True:
        config = _quiet(config, world)
        undecided = max(
            ((depth, n, path) for n, t in config.roots for depth, path in _undecided(t)),
            key=lambda found: (found[0], tuple(-i for i in (found[1], *found[2]))),
            default=None,
        )
        if undecided is None:
            return _guarded(config) if config.store.born or config.store.retired else config
        _, root, path = undecided
        term, store = decide(config.root(root), path, config.store, root)
        config = Config(tuple((n, term if n == root else t) for n, t in config.roots), store)


def _guarded(config: Config) -> Config:
    """Of reactions whose guard is gone the store knows nothing more."""
    guards = [spot.leaf for spot in config.spots() if isinstance(spot.leaf, Leaf) and spot.leaf.name == "E"]
    labels = [label for guard in guards for label in guard.arguments]
    return replace(config, store=config.store.guarded_by(labels))


def _quiet(config: Config, world: World) -> Config:
    roots, store = list(config.roots), config.store
    changed = True
    while changed:
        changed = False
        for index, (number, term) in enumerate(roots):
            before, store = store, store.settled()
            new, store = terminate(term, store, world, number)
            if isinstance(new, Ended):
                store = store.root_ended(number)
            changed = changed or new is not term or store is not before
            roots[index] = (number, new)
    return Config(tuple(roots), store)


def _undecided(term: Run, depth: int = 0) -> Iterator[tuple[int, tuple[int, ...]]]:
    """(how many `#` enclose it, path) of every `#` of which a part has ended."""
    if term.waits is not None:
        return
    inner = depth
    if isinstance(term, Group) and term.operator == "#":
        inner = depth + 1
        if any(isinstance(p, Ended) for p in term.parts):
            yield depth, ()
    for index, part in enumerate(parts_of(term)):
        for found, path in _undecided(part, inner):
            yield found, (index, *path)


def decide(term: Run, path: tuple[int, ...], store: Store, root: int) -> tuple[Run, Store]:
    """N5. `x.r # live Q` = x.r and Q is forcibly aborted; both in one step: stop wins, then the leftmost."""
    if path:
        parts = parts_of(term)
        part, store = decide(parts[path[0]], path[1:], store, root)
        return with_parts(term, (*parts[: path[0]], part, *parts[path[0] + 1 :])), store
    assert isinstance(term, Group)
    ended = [p for p in term.parts if isinstance(p, Ended)]
    winner = next((p for p in ended if p.ok), ended[0])
    for part in term.parts:
        store = abort(part, store, root)
    return winner, store


def abort(term: Run, store: Store, root: int) -> Store:
    """N9. Forced abort of a component, left to right; a body is left after its content."""
    match term:
        case Await(k):
            return store.abandoned(k)
        case Queued(ticket):
            return store.abandoned_in_queue(ticket)
        case Waiting("DRAIN", s):
            return store.drain_ended(s, root).released(s)
        case _:
            for part in parts_of(term):
                store = abort(part, store, root)
            if isinstance(term, Serve):
                store = replace(store.left(term.instance, term.reaction), cut=store.cut + 1)
            return store
