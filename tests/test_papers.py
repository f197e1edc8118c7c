"""The known errors of the papers: each printed form is shown to fail, and the corrected one to work.

What is wrong in a text alone (missing parentheses, ports, recursion) is in `tests/rs/test_papers_texts.py`; that App. B
has no rule for `~` and that REASSERT as printed can never succeed are in `tests/rs/test_evolves.py`.
"""

from __future__ import annotations

from collections.abc import Iterable

from planner_reactor.analysis.explore import Exploration, explore
from planner_reactor.rs.checks import check_text
from planner_reactor.rs.configurations import Config, World
from planner_reactor.rs.evolves import started
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.states import Ended
from planner_reactor.rs.vocabulary import Signature
from planner_reactor.runtime import Budgets, Executer, Scheduler, VirtualClock

OPEN = (0.0, float("inf"))
LEAVES = {name: Signature(name, (), (), window=OPEN) for name in ("Q", "RSB", "Yes", "No")}


def ends(name: str, arguments: tuple[object, ...]) -> Iterable[tuple[bool, tuple[object, ...]]]:
    return [(name != "No", ())]


def explored(reactor: str, *scripts: str) -> Exploration:
    world = World(parse_program(reactor), LEAVES, endings=ends)
    config = started(parse_process("R"), world)
    for script in scripts:
        config = started(parse_process(script), world, config=config)
    return explore(config, world, limit=5_000)


def script_has_ended(config: Config) -> bool:
    return isinstance(config.root(2), Ended)


def test_r0_as_printed_never_ends_its_situations_so_it_can_never_be_adapted() -> None:
    """R equation (6): no reaction of R0 SUCCEEDs or FAILs anything; WAITINHIBIT waits for ever."""
    printed = "R = P1 | P2 | P3\nP1 = Q :; ASSERT[sa]\nP2 = SIT[sa] :; ASSERT[sb]\nP3 = SIT[sb] :; RSB"
    assert explored(printed, "WAITINHIBIT[sa]").trapped(script_has_ended) is not None
    corrected = """
    R = P1 | P2 | P3
    P1 = Q :; ASSERT[sa]
    P2 = SIT[sa]<k> :; (~(ASSERT[sb] : SUCCEED[sa, k]) : FAIL[sa, k])
    P3 = SIT[sb]<k> :; (~(RSB : SUCCEED[sb, k]) : FAIL[sb, k])
    """
    assert explored(corrected, "WAITINHIBIT[sa]").trapped(script_has_ended) is None


def test_equation_2_as_printed_serves_one_instance_while_another_is_served() -> None:
    """R (2) prints `::`; "as long as the situation is active, the reactions are re-enabled" describes `:;`."""

    def most_bodies(loop: str) -> int:
        reactor = f"R = (SIT[s]<k> {loop} (Q ; SUCCEED[s, k])) | ASSERT[s] | ASSERT[s]"
        return max(len(state.store.run) for state in explored(reactor).states)

    assert most_bodies("::") == 2
    assert most_bodies(":;") == 1


def test_p11_as_printed_is_content_with_one_part_of_three() -> None:
    """R §8.3 prints `|` between the parts that a tray lacks: one success of three suffices (App. B)."""

    def fills(operator: str) -> set[bool]:
        reactor = f"R = SIT[s]<k> :; (~((Yes {operator} No {operator} No) : SUCCEED[s, k]) : FAIL[s, k])"
        found = explored(reactor, "ASSERT[s]")
        return {state.root(2).ok for state in found.states if isinstance(state.root(2), Ended)}  # type: ignore[union-attr]

    assert fills("|") == {True}
    assert fills("&") == {False}


def test_bounded_if_all_situations_terminate_is_not_enough() -> None:
    """R §5.5: every instance of the child terminates, yet its parent's REASSERT never does; DRAIN ends it."""
    reactor = """
    R = P1 | P2 | P3
    P1 = Q :; ASSERT[sa]
    P2 = SIT[sa]<k> :; (~(REASSERT[sb] : SUCCEED[sa, k]) : FAIL[sa, k])
    P3 = SIT[sb]<k> :; (RSB ; FAIL[sb, k])
    """
    assert explored(reactor, "WAITINHIBIT[sa]").trapped(script_has_ended) is not None
    assert explored(reactor, "DRAIN[sa]").trapped(script_has_ended) is None


def test_waitinhibit_as_in_table_2_would_cut_what_follows_a_verdict() -> None:
    """With "no instance is on" alone, a body that has given its verdict is still at work when the wait ends."""
    reactor = "R = (SIT[s]<k> :; (SUCCEED[s, k] ; RSB)) | ASSERT[s]"
    found = explored(reactor)
    on_is_over_but_a_body_is_not = [
        state
        for state in found.states
        if state.store.run and all(instance.status != "on" for instance in state.store.instances)
    ]
    assert on_is_over_but_a_body_is_not  # WAIT asks for the ends of bodies too: `test_evolves`


def test_move_as_printed_leaves_the_robot_without_its_commands() -> None:
    """X §5.2 prints `move … STREAM[rp, d]`: nobody then writes rc, which Robot reads, and rp has two writers."""
    printed = """
    World = Robot[0] | move
    Robot[p] = (IN[rc]<d> # STREAM[rp, p]) ; Robot[p + d]
    move = (IN[r]<d> ; Delay[1]) :; (STREAM[rp, d] # Delay[1])
    """
    corrected = printed.replace("STREAM[rp, d]", "STREAM[rc, d]")

    def never_written(text: str) -> set[str]:
        found = check_text(text, "model.rsl", ports=("r", "rp"))
        return {word for d in found if d.code == "unserved-port" for word in ("rc", "rp") if word in d.message.split()}

    assert never_written(printed) == {"rc"}
    assert never_written(corrected) == set()


def ran(text: str, until: float) -> Executer:
    scheduler = Scheduler(VirtualClock())
    executer = Executer(parse_program(text), scheduler=scheduler, budgets=Budgets(turns=1_000))
    executer.start("World")
    executer.run(until=until)
    return executer


def test_stream_as_printed_is_zeno_against_a_reader_without_a_delay() -> None:
    """X §4.1.2: `STREAM[y,v] = OUT[y,v] :; STOP` writes without end at one instant; ours waits a quantum."""
    printed = ran("World = Stream[p, 1] | (IN[p]<x> :; STOP)\nStream[y, v] = OUT[y, v] :; STOP", 0.05)
    ours = ran("World = STREAM[p, 1] | (IN[p]<x> :; STOP)", 0.05)
    assert printed.statistics().zeno is not None
    assert ours.statistics().zeno is None
    assert ours.statistics().rendezvous < 10
