"""`kit` and `loop`: what they report, and what they refuse before anything has happened."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from planner_reactor.experiments.loop import Loop, summary
from planner_reactor.workcell.domains import shipped_domain
from tests.cli.conftest import Call

KEYS = {
    "kits", "parts", "adaptations", "changes_applied", "assumptions", "first_adaptation_issued_s", "first_reactor_s",
    "first_ideal_s", "stub_triggers", "relaxations", "faults", "interruptions", "laws_checked", "violations",
    "simulated_s", "wall_s", "cpu_s", "trace_hash", "unstruck", "finished",
}  # fmt: skip
HOST = "planner_reactor.workcell.host"

TINY = """\
atp_assumption Easy() likelihood 0.5 monitor flag 500;
atp_goal Serve forall x, i1: Guest(x) @ i1 => Exists i2: Served(x) @ i2 and ITL(i2, finishes, time);
atp_fact Guest(one);
atp_rule forall x, i, j: Easy() @ j => Ready(x) @ i;
atp_actionschema Greet <x><>
intervals i1, i2;
    executability: Ready(x) @ i1 and ITL(i1, [m o si e di fi], Greet);
    effects:       Served(x) @ i2 and ITL(Greet, meets, i2);
endactionschema
"""

TINY_HOST = '''\
"""A world that is finished after some greetings."""
from planner_reactor.runtime import Host

class World:
    faults = {"rain": {"minutes": 3.0}}
    def __init__(self, target): self.target, self.greeted, self.wet = target, 0, []
    def start(self, scheduler): self.scheduler = scheduler
    def ledger(self): return {}
    def balanced(self): return True
    def finished(self): return 0 < self.target <= self.greeted
    def report(self): return {"greeted": self.greeted, "wet": self.wet}
    def strike(self, kind, **parameters):
        if self.scheduler.now < 4: return False
        self.wet.append(self.scheduler.now)
        return True

def host(scheduler, *, target=0, trace=None):
    made = Host("tiny")
    made.world = World(target)
    @made.process(window=(0.0, 2.0))
    def Greet(who):
        yield 1.0
        made.world.greeted += 1
        trace.record("greeted")
    made.assumption("Easy")(lambda: True)
    return made
'''


@pytest.fixture
def tiny(place: Path) -> Path:
    """A domain and a host that know nothing of kits."""
    (place / "tiny.itl").write_text(TINY)
    (place / "tiny_host.py").write_text(TINY_HOST)
    return place


def test_kit_reports_every_key_and_the_ledger_balances(call: Call) -> None:
    ran = call("kit", "--trays", "2", "--seed", "1", "--json")
    found = ran.object
    assert ran.status == 0
    assert set(found) >= KEYS
    assert found["kits"] == {"completed": 2, "rejected": 0}
    parts = found["parts"]
    accounts = ["on_belt", "held", "in_trays", "shipped", "rejected", "passed", "taken"]
    assert sorted(parts) == sorted(["arrived", *accounts])
    assert parts["arrived"] == sum(parts[account] for account in accounts)
    books = found["adaptations"]
    assert books["issued"] == sum(books[end] for end in ("applied", "refused", "timed_out", "pending"))
    assert (found["violations"], found["interruptions"], found["finished"]) == ([], 0, True)


def test_kit_for_people_shows_the_same_as_tables(call: Call) -> None:
    out = call("kit", "--trays", "1").out
    assert "completed 1, rejected 0" in out
    assert "Relaxations" in out
    assert "arrived" in out
    assert "shipped 3" in out


def test_kit_without_a_number_builds_five_and_with_until_as_many_as_it_can(call: Call) -> None:
    assert call("kit", "--json").object["kits"]["completed"] == 5
    ended = call("kit", "--until", "60", "--json").object
    assert ended["simulated_s"] == 60.0
    assert not ended["finished"]


def test_the_trace_is_one_event_a_line(call: Call, place: Path) -> None:
    found = call("kit", "--trays", "1", "--trace", "run.jsonl", "--json").object
    events = [json.loads(line) for line in (place / "run.jsonl").read_text().splitlines()]
    assert [event["number"] for event in events] == list(range(1, len(events) + 1))
    assert events[-1]["time"] <= found["simulated_s"]


def test_figures_are_drawn_into_a_directory_that_is_made(call: Call, place: Path) -> None:
    pytest.importorskip("matplotlib")
    found = call("kit", "--until", "50", "--figures", "new/figures", "--json").object
    assert found["figures"]
    assert all((place / drawn).is_file() for drawn in found["figures"])


def test_without_matplotlib_figures_are_refused_with_the_extra_that_they_need(
    call: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("planner_reactor.calls.outputs.find_spec", lambda name: None)
    assert call("kit", "--figures", "out").refused("needs matplotlib", "planner-reactor[figures]")


def test_measured_time_and_the_wall_clock_are_marked_as_not_deterministic(call: Call, place: Path) -> None:
    for option in (("--planner-time", "measured"), ("--clock", "wall")):
        call("kit", "--until", "0.2", *option, "--trace", "run.jsonl", "--json")
        assert '"not_deterministic"' in (place / "run.jsonl").read_text()


def test_the_planner_of_1994_takes_its_time(call: Call) -> None:
    found = call("kit", "--until", "30", "--planner-time", "papers", "--json").object
    assert found["first_adaptation_issued_s"] == pytest.approx(26, abs=1)


def test_only_the_assumptions_that_were_named_are_relaxed(call: Call) -> None:
    found = call("kit", "--until", "60", "--relax", "AQ, ACT", "--json").object
    assert [r["assumption"] for r in found["relaxations"]] == ["AQ", "ACT"]
    assert call("kit", "--until", "60", "--relax", "none", "--json").object["relaxations"] == []


def test_a_run_that_ends_with_a_fault_unstruck_says_so(call: Call, place: Path) -> None:
    (place / "faults.toml").write_text('[[fault]]\nat = 900.0\nkind = "part_moved"\n')
    ran = call("kit", "--until", "30", "--faults", "faults.toml", "--json")
    assert ran.object["unstruck"] == [{"kind": "part_moved", "at": 900.0}]
    assert "the fault part_moved, due at 900 s, had not struck by 30 s" in ran.err


def test_another_kit_is_built_from_its_specification(call: Call, place: Path) -> None:
    kinds = "\n".join(f'[[part]]\nkind = "{kind}"\nvariants = ["{kind}_a", "{kind}_b"]' for kind in ("lid", "pot"))
    (place / "kit.toml").write_text(f'name = "pot"\n{kinds}\n')
    found = call("kit", "--kit", "kit.toml", "--trays", "1", "--json").object
    assert (found["kits"]["completed"], found["parts"]["shipped"]) == (1, 2)


def test_loop_runs_the_kitting_domain_as_kit_does(call: Call, place: Path) -> None:
    (place / "kitting.itl").write_text(shipped_domain())
    built = call("kit", "--trays", "1", "--seed", "4", "--json").object
    looped = call("loop", "kitting.itl", "--host", HOST, "--trays", "1", "--seed", "4", "--json").object
    assert looped["trace_hash"] == built["trace_hash"]


def test_loop_runs_a_domain_that_nobody_has_seen(call: Call, tiny: Path) -> None:
    ran = call("loop", "tiny.itl", "--host", "tiny_host", "--trays", "3", "--goal", "Serve", "--json")
    assert (ran.status, ran.object["greeted"], ran.object["finished"]) == (0, 3, True)
    assert ran.object["violations"] == []


def test_loop_lets_faults_strike_any_world_as_soon_as_they_can(call: Call, tiny: Path) -> None:
    (tiny / "faults.toml").write_text('[[fault]]\nat = 2.2\nkind = "rain"\n')
    found = call("loop", "tiny.itl", "--host", "tiny_host", "--until", "9", "--faults", "faults.toml", "--json").object
    assert found["wet"] == [4.2]
    assert found["unstruck"] == []


def test_loop_warns_of_an_assumption_that_nobody_senses(call: Call, tiny: Path) -> None:
    (tiny / "odd.itl").write_text(TINY.replace("Easy", "Easi"))
    ran = call("loop", "odd.itl", "--host", "tiny_host", "--until", "3", "--json")
    assert ran.status == 0
    assert "odd.itl:1:16: nobody can tell whether Easi holds, did you mean Easy?" in ran.err
    assert call("check", "odd.itl", "--host", "tiny_host", "--strict").status == 1


def test_a_broken_law_ends_with_1(call: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(made: Loop) -> Mapping[str, Any]:
        return {**summary(made), "violations": ["law 2 at 1.0 s: a reaction in service was cut"]}

    monkeypatch.setattr("planner_reactor.calls.looping.summary", broken)
    ran = call("kit", "--until", "5")
    assert ran.status == 1
    assert "a reaction in service was cut" in ran.out


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--trays", "0"), "trays is 0, expected a whole number, 1 or more"),
        (("--trays", "-3"), "trays is -3, expected a whole number, 1 or more"),
        (("--seed", "-1"), "seed is -1, expected a whole number, 0 or more"),
        (("--until", "nan"), "until is nan, expected a finite number of seconds, 0 or more"),
        (("--until", "-0.5"), "until is -0.5, expected"),
        (("--cell", "evnts"), "unknown cell evnts, did you mean events?"),
        (("--clock", "sundial"), "unknown clock sundial, expected one of: virtual, wall"),
        (("--planner", "outline"), "unknown planner outline, expected one of: inline, process"),
        (("--mode", "drian"), "unknown mode drian, did you mean drain?"),
        (("--planner-time", "soon"), "planner time is soon, expected measured, papers, or seconds, 0 or more"),
        (("--planner-time", "-1"), "planner time is -1, expected measured"),
        (("--planner-time", "nan"), "planner time is nan, expected measured"),
        (("--relax", "AQ,AX"), "AX is not an assumption"),
        (("--relax", "AQ,"), "relax lacks a name"),
        (("--relax", ""), "relax lacks a name"),
        (("--faults", "flaws.toml"), "flaws.toml:1:1: no such file, did you mean faults.toml?"),
        (("--faults", "faults.toml"), "faults.toml:3:1: unknown fault 'part_moovd', did you mean part_moved?"),
        (("--faults", "broken.toml"), "broken.toml:1:"),
        (("--kit", "kit.toml"), "kit.toml:3:1: unknown key 'varints' in [part], did you mean variants?"),
        (("--kit", "."), ".:1:1: this is a directory, expected a file"),
        (("--domain", "wrong.itl"), "wrong.itl:1:1: unexpected atp_gaol"),
        (("--domain", "tiny.itl"), "tiny.itl:5:18: unknown process Greet, did you mean Get?"),
        (("--trace", "run.txt"), "trace run.txt: expected a name that ends in .jsonl"),
        (("--trace", "nowhere/run.jsonl"), "trace: nowhere/run.jsonl cannot be written: No such file or directory"),
        (("--trace", "folder.jsonl"), "trace: folder.jsonl is a directory, expected a file"),
        (("--figures", "cell.rsl/figures"), "cell.rsl is a file, expected a directory"),
        (("--figures", "/proc/figures"), "figures: /proc/figures cannot be written to: "),
    ],
)
def test_bad_input_is_refused_and_no_output_is_touched(
    call: Call, tiny: Path, options: tuple[str, ...], said: str
) -> None:
    (tiny / "faults.toml").write_text('[[fault]]\nat = 1.0\nkind = "part_moovd"\n')
    (tiny / "broken.toml").write_text("[[fault]\n")
    (tiny / "kit.toml").write_text('[[part]]\nkind = "cap"\nvarints = ["a"]\n')
    (tiny / "wrong.itl").write_text("atp_gaol Kitting;\n")
    (tiny / "kept.jsonl").write_text("an older trace\n")
    (tiny / "folder.jsonl").mkdir()
    before = sorted(path.name for path in tiny.iterdir())
    outputs: tuple[str, ...] = () if "--trace" in options else ("--trace", "kept.jsonl")
    outputs += () if "--figures" in options else ("--figures", "drawn")
    assert call("kit", *outputs, *options).refused(said)
    assert (tiny / "kept.jsonl").read_text() == "an older trace\n"
    assert sorted(path.name for path in tiny.iterdir()) == before


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--host", "tiny_host", "--goal", "Serv"), "no goal Serv, did you mean Serve?"),
        (("--host", "tiny_hots"), "host tiny_hots: no such module, did you mean tiny_host?"),
        (("--host", "tiny_host", "--kit", "kit.toml"), "a domain for kits has one rule"),
        (("--host", "small_host", "--until", "3"), "tiny.itl:5:18: unknown process Greet, host small has no process"),
        (("--host", "greeter", "--trays", "3"), "host greeter knows no trays: its `host` has no parameter target"),
        (("--host", "greeter"), "host greeter has no world that could be finished, expected an end: until"),
        (("--host", "greeter", "--until", "3", "--faults", "faults.toml"), "has no world in which faults could strike"),
        (("--host", "tiny_host", "--until", "3", "--faults", "faults.toml"), "faults.toml:3:1: unknown fault 'rian'"),
        (("--host", "picky", "--until", "3"), "tiny.itl:5:18: Greet with 1 arguments and 0 results, expected Greet"),
    ],
)
def test_loop_refuses_what_does_not_fit_together(call: Call, tiny: Path, options: tuple[str, ...], said: str) -> None:
    host = "from planner_reactor.runtime import Host\nhost = Host('greeter')\n@host.process(window=(0.0, 2.0))\n"
    (tiny / "greeter.py").write_text(host + "def Greet(who):\n    yield 1.0\n")
    (tiny / "picky.py").write_text(host + "def Greet(who, how):\n    yield 1.0\n")
    (tiny / "kit.toml").write_text('[[part]]\nkind = "cap"\nvariants = ["a"]\n')
    (tiny / "faults.toml").write_text('[[fault]]\nat = 1.0\nkind = "rian"\n')
    assert call("loop", "tiny.itl", *options).refused(said)
