"""An adaptation that could wait for itself is refused before anything begins; exploration shows that it would."""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from planner_reactor.link.messages import Adaptation, Change
from tests.analysis.small_reactors import Case, looked_at, named
from tests.reactor.driving import FIRST, SECOND, Bench, change

THREE = Adaptation(
    id=1,
    definitions="""
    P[0] = STOP :; ASSERT[p]
    P[1] = SIT[p]<k> :; (~(REASSERT[c] : SUCCEED[p, k]) : FAIL[p, k])
    P[2] = SIT[c]<k> :; (~(REASSERT[d] : SUCCEED[c, k]) : FAIL[c, k])
    P[3] = SIT[d]<k> :; (~(Do[old, 2] : SUCCEED[d, k]) : FAIL[d, k])
    """,
    changes=(change("p"), change("c"), change("d")),
    adds=(3, 2, 1, 0),
)
WHOLE = "P[{n}] = SIT[{s}]<k> :; (~(Do[new, 1] : SUCCEED[{s}, k]) : FAIL[{s}, k])"


def changed(number: int, *situations: str, mode: str = "wait", first: int = 10, removed: str = "") -> Adaptation:
    """Each of these is done at once from now on; `removed` is needed no more."""
    old = {"p": 1, "c": 2, "d": 3}
    new = {s: first + n for n, s in enumerate(situations) if s != removed}
    return Adaptation(
        id=number,
        definitions="\n".join(WHOLE.format(n=n, s=s) for s, n in new.items()),
        changes=tuple(Change(situation=s, base=1) for s in new),
        removed=(removed,) if removed else (),
        kills=tuple(old[s] for s in situations),
        adds=tuple(reversed(new.values())),
        mode=mode,  # type: ignore[arg-type]
    )


def refusal(bench: Bench) -> str:
    """Why the last one was refused, if that is because it could wait for itself."""
    found = [p for p in bench.perceptions() if p.kind == "adaptation_refused"]
    return str(found[-1].values[0]) if found and found[-1].cause == "deadlock" else ""


def after(adaptation: Adaptation, first: Adaptation = THREE) -> Bench:
    bench = Bench()
    bench.at(0.0, first)
    bench.at(1.0, adaptation)
    bench.run(1.5)
    return bench


@pytest.mark.parametrize("mode", ["wait", "drain", "versions"])
def test_a_child_held_before_its_parent_is_refused(mode: str) -> None:
    bench = after(changed(2, "d", "p", mode=mode))
    assert refusal(bench).startswith("d is held before p, which needs it: expected p first")
    bench.run(30.0)
    assert bench.reactor.laws.violations == []


def test_it_would_indeed_wait_for_ever() -> None:
    case = named("chain :; pcd")
    script = "WAITINHIBIT[d] : WAITINHIBIT[p] : KILL[2] : KILL[4] : POST[14] : POST[12]"
    assert looked_at(case, script).broken["bounded"].why == "from here on the script cannot end"
    assert not looked_at(case, script.replace("[d] : WAITINHIBIT[p]", "[p] : WAITINHIBIT[d]")).broken


def test_in_mode_versions_what_is_removed_goes_after_what_needs_it() -> None:
    right = replace(changed(2, "p", removed="c", mode="versions"), removed=("c", "d"), kills=(1, 2, 3))
    bench = after(replace(right, kills=(2, 1, 3)))
    assert refusal(bench) == "what serves c goes before what serves p: expected p first"
    assert refusal(after(right)) == ""
    found = looked_at(
        named("nested :; p-c"),
        "RETIRE[2] : RETIRE[3] : RENEW[p] : POST[12] : RENEW[c] : WAITOLD[c] : KILL[3] : WAITOLD[p] : KILL[2]",
        patient=True,
    )
    assert not found.broken["bounded"].cycle


CROSSED = """
R = (E[1] # P[1]) | (E[2] # P[2]) | (E[3] # P[3]) | (E[4] # P[4]) | (E[5] # P[5]) | (E[6] # P[6])
P[1] = Asks :; ASSERT[y]
P[2] = Asks :; ASSERT[w]
P[3] = SIT[y]<k> :; (~(ASSERT[z] : SUCCEED[y, k]) : FAIL[y, k])
P[4] = SIT[w]<k> :; (~(ASSERT[x] : SUCCEED[w, k]) : FAIL[w, k])
P[5] = SIT[z]<k> :; (~(Works : SUCCEED[z, k]) : FAIL[z, k])
P[6] = SIT[x]<k> :; (~(Works : SUCCEED[x, k]) : FAIL[x, k])
"""


ONCE = """
R = ASSERT[y] | ASSERT[w] | P[3] | P[4] | P[5] | P[6]
P[3] = SIT[y]<k> :; (ASSERT[z] : SUCCEED[y, k])
P[4] = SIT[w]<k> :; (ASSERT[x] : SUCCEED[w, k])
P[5] = SIT[z]<k> :; SUCCEED[z, k]
P[6] = SIT[x]<k> :; SUCCEED[x, k]
"""


def crossed(number: int, child: str, parent: str, mode: str = "wait", first: int = 10) -> Adaptation:
    """Holds a child of the one parent, then the other parent."""
    old = {"y": 3, "w": 4, "z": 5, "x": 6}
    new = {s: first + n for n, s in enumerate((child, parent))}
    definitions = {s: WHOLE.format(n=n, s=s) for s, n in new.items()}
    definitions[parent] = definitions[parent].replace("Do[new, 1]", f"ASSERT[{'z' if parent == 'y' else 'x'}]")
    return Adaptation(
        id=number,
        definitions="\n".join(definitions.values()),
        changes=(Change(situation=child, base=1), Change(situation=parent, base=1)),
        kills=(old[child], old[parent]),
        adds=(new[parent], new[child]),
        mode=mode,  # type: ignore[arg-type]
    )


FOUR = Adaptation(
    id=1,
    definitions="\n".join(CROSSED.splitlines()[2:]).replace("Asks", "STOP").replace("Works", "Do[old, 2]"),
    changes=(change("y"), change("w"), change("z"), change("x")),
    adds=(6, 5, 4, 3, 2, 1),
)


@pytest.mark.parametrize(("modes", "refused"), [("wait wait", True), ("wait drain", False), ("drain wait", False)])
def test_two_that_would_wait_for_each_other_are_not_taken_together(modes: str, refused: bool) -> None:
    one, other = modes.split()
    bench = Bench()
    bench.at(0.0, FOUR)
    bench.at(1.0, crossed(2, "x", "y", one))
    bench.at(1.1, crossed(3, "z", "w", other, first=20))
    bench.run(1.5)
    assert refusal(bench) == ("adaptations would wait for each other: 3 → 2 → 3" if refused else "")
    bench.run(60.0)
    assert bench.times("adaptation_applied", id=2)
    assert bool(bench.times("adaptation_applied", id=3)) != refused
    assert bench.reactor.laws.violations == []


def test_they_would_indeed() -> None:
    case = Case("crossed", ONCE, crossed(2, "x", "y"))
    one, other = "WAITINHIBIT[x] : WAITINHIBIT[y]", "WAITINHIBIT[z] : WAITINHIBIT[w]"
    together = looked_at(case, f"({one}) & ({other})", patient=True)
    assert together.broken["bounded"].why == "from here on the script cannot end"
    for alone in (one, other):
        assert "bounded" not in looked_at(case, alone, patient=True).broken


def test_waiting_above_what_is_disabled_is_refused_and_draining_it_is_not() -> None:
    above = Adaptation(
        id=2,
        definitions=WHOLE.format(n=10, s="work"),
        changes=(Change(situation="work", base=1),),
        removed=("part",),
        kills=(1, 2),
        adds=(10,),
    )
    for mode in ("wait", "drain"):
        bench = Bench()
        bench.at(0.0, FIRST)
        flags = bench.flags
        bench.scheduler.call_at(2.5, lambda flags=flags: flags.update(A=False))  # type: ignore[misc]
        bench.at(5.0, replace(above, mode=mode))
        bench.run(6.0)
        why = "part is disabled, and work cannot end without it: expected mode drain"
        assert refusal(bench) == (why if mode == "wait" else "")


def test_what_an_older_parent_may_still_assert_is_not_removed_by_a_drain() -> None:
    """The parent was retired and goes on; who drained the child away would leave it waiting for ever."""
    bench = Bench()
    bench.at(0.0, THREE)
    bench.at(0.5, changed(2, "p", mode="versions"))  # asserts c no more
    removal = Adaptation(id=3, removed=("c", "d"), kills=(2, 3))
    bench.at(0.6, removal)
    bench.run(0.7)
    assert refusal(bench) == "P[1], retired and not gone yet, may assert c: expected later"
    bench.at(40.0, replace(removal, id=4))
    bench.run(60.0)
    assert bench.times("adaptation_applied", id=4)
    assert sorted(bench.reactor.reactions) == [0, 10]
    assert bench.reactor.laws.violations == []


def test_what_was_removed_may_come_back_while_its_old_reaction_stands() -> None:
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.at(1.0, replace(
        SECOND, mode="versions", changes=(change("work", 1),), removed=("part",), kills=(1, 2),
        definitions="P[4] = SIT[work]<k> :: (~(Do[whole, 1] : SUCCEED[work, k]) : FAIL[work, k])",
    ))  # fmt: skip
    bench.at(1.2, Adaptation(
        id=3, mode="versions", kills=(4,), adds=(6, 5),
        changes=(change("work", 2), replace(change("part", 2), fresh=True)),
        definitions="""
        P[5] = SIT[work]<k> :; (~(REASSERT[part] : SUCCEED[work, k]) : FAIL[work, k])
        P[6] = SIT[part]<k> :; (~(Do[new, 1] : SUCCEED[part, k]) : FAIL[part, k])
        """,
    ))  # fmt: skip
    bench.run(30.0)
    assert bench.times("adaptation_applied", id=3) == [1.2]
    assert sorted(bench.reactor.reactions) == [0, 3, 5, 6]
    assert {1, 2, 4} <= {e.data["label"] for e in bench.trace.of("removed")}
    assert bench.reactor.laws.violations == []


@pytest.mark.parametrize("mode", ["wait", "drain", "versions"])
@pytest.mark.parametrize("situations", ["p", "c", "d", "pc", "pd", "cd", "pcd"])
def test_nothing_is_refused_that_goes_from_the_top(situations: str, mode: str) -> None:
    bench = after(changed(2, *situations, mode=mode))
    assert refusal(bench) == ""
    bench.run(60.0)
    assert bench.times("adaptation_applied", id=2)
    assert bench.reactor.laws.violations == []
