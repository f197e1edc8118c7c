"""Counterexamples run in the executer, step by step; what the semantics forbids does not."""

from __future__ import annotations

import pytest

from planner_reactor.analysis.lassos import Lasso
from planner_reactor.analysis.notation import read_property
from planner_reactor.analysis.properties import Verdict, check, deadlock_free, zeno_free
from planner_reactor.analysis.systems import System, build
from planner_reactor.analysis.temporal import atoms
from planner_reactor.calls.replaying import Replay, replay
from planner_reactor.reactor.situations import Situations
from planner_reactor.rs.configurations import Label, World, spawned_situations
from planner_reactor.rs.evolves import started
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.vocabulary import BUILT_IN, Signature

SIGNATURES = {
    **BUILT_IN,
    "Try": Signature("Try", (), (), window=(0.0, float("inf"))),
    "Give": Signature("Give", (), ("x",), window=(1.0, 2.0)),
}


def ends(name: str, arguments: tuple[object, ...]) -> list[tuple[bool, tuple[object, ...]]]:
    given: list[tuple[bool, tuple[object, ...]]] = [(True, (3,)), (True, (4,))] if name == "Give" else [(True, ())]
    return [*given, (False, ())]


class Case:
    """A program and what runs beside it, for analysis and for the executer."""

    def __init__(self, text: str, *beside: str) -> None:
        program = parse_program(text)
        self.processes = [parse_process(p) for p in ("Main", *beside)]
        self.world = World(
            program, SIGNATURES, endings=ends,
            spawned=spawned_situations(program, *self.processes),
        )  # fmt: skip

    def system(self, asked: str = "true") -> System:
        config = None
        for process in self.processes:
            config = started(process, self.world, config=config)
        assert config is not None
        return build(config, self.world, atoms(read_property(asked).formula))

    def verdict(self, asked: str) -> Verdict:
        return check(self.system(asked), read_property(asked))

    def replayed(self, labels: tuple[Label, ...], tries: int = 500) -> Replay:
        return replay(self.processes, self.world, labels, tries=tries)

    def rounds(self, found: Lasso | None, times: int = 3) -> bool:
        """The prefix, and the cycle some times over."""
        assert found is not None
        return self.replayed((*found.prefix, *found.cycle * times)).done


CROSSED = Case("Main = (IN[a]<x> : Delay[1] : IN[p]<y> : OUT[q, y]) | (OUT[a, 1] : IN[q]<z> : OUT[p, z])")
STREAM = Case("Main = (OUT[p, 1] :; STOP) | (IN[p]<x> :; STOP)")
RETRY = Case(
    "Main = (Give<x> :; REASSERT[Kit]) | Serves\nServes = SIT[Kit]<k> :; (~(Try : SUCCEED[Kit, k]) : FAIL[Kit, k])"
)
READERS = Case(
    "Main = Writer | Reader[1] | Reader[2]\nWriter = Delay[1] : OUT[p, 1] : Writer\n"
    "Reader[n] = IN[p]<x> : REPORT[met, n] : Reader[n]"
)
DRAINED = Case(
    "Main = (STOP :; (ASSERT[s] ; Term[1])) # (SIT[s]<k> :; (~(Term[2] : SUCCEED[s, k]) : FAIL[s, k]))",
    "Try ; DRAIN[s] : UNINHIBIT[s]",
)
GUARDED = Case("Main = (E[1] # (Give<x> :; OUT[p, x])) | (IN[p]<y> :; STOP)", "Term[3] : KILL[1]")


def test_a_deadlock_and_a_zeno_loop() -> None:
    assert CROSSED.rounds(deadlock_free(CROSSED.system()).counterexample)
    assert STREAM.rounds(zeno_free(STREAM.system()).counterexample)


@pytest.mark.parametrize(("case", "asked"), [
    (RETRY, "always (asserted Kit -> eventually succeeded Kit) under weak fairness"),
    (RETRY, "never aborted Try"),
    (READERS, "eventually reported met[1] under weak fairness"),
    (READERS, "eventually reported met[2] under weak fairness"),
    (DRAINED, "never failed s"),
    (DRAINED, "never queued s"),
    (DRAINED, "never succeeded s"),
    (GUARDED, "never killed 1"),
    (GUARDED, "never sent p[4]"),
])  # fmt: skip
def test_a_lasso(case: Case, asked: str) -> None:
    assert case.rounds(case.verdict(asked).counterexample)


@pytest.mark.parametrize("case", [CROSSED, RETRY, DRAINED, GUARDED], ids=["crossed", "retry", "drained", "guarded"])
def test_every_shortest_way_to_a_state_can_be_run(case: Case) -> None:
    system = case.system()
    for state in range(min(len(system.states), 60)):
        labels = system.path(state)
        assert case.replayed(labels).done, (state, labels)


def test_what_the_semantics_forbids_cannot_be_run() -> None:
    found = deadlock_free(CROSSED.system()).counterexample
    assert found is not None
    first, pause, delay = found.prefix
    for wrong in ((pause, first, delay), (first, delay), (first, pause, delay, delay), (delay,)):
        assert not CROSSED.replayed(wrong).done


def test_a_defect_of_the_executer_keeps_a_counterexample_from_running(monkeypatch: pytest.MonkeyPatch) -> None:
    found = DRAINED.verdict("never queued s").counterexample
    monkeypatch.setattr(Situations, "root_ended", lambda self, owner: None)
    assert DRAINED.rounds(found)
    released = DRAINED.verdict("always (queued s -> always not succeeded s)").counterexample
    assert DRAINED.rounds(released)
    monkeypatch.setattr(Situations, "_release", lambda self, situation: None)
    assert not DRAINED.rounds(released)
