"""The pages say what is so: every snippet runs, every link leads somewhere, every table agrees with the code."""

from __future__ import annotations

import doctest
import json
import re
from collections.abc import Iterable, Iterator
from contextlib import chdir
from pathlib import Path
from typing import Any, get_args

import pytest
from typer.main import get_command

from planner_reactor.cli.application import ORDER, app
from planner_reactor.cli.later import LATER
from planner_reactor.errors import Diagnostic
from planner_reactor.experiments.registry import EXPERIMENTS
from planner_reactor.link.messages import Adaptation, PerceptionKind
from planner_reactor.logic.allen import NAMED, names
from planner_reactor.logic.itl_syntax import LABELS, parse
from planner_reactor.logic.itl_tokens import Source
from planner_reactor.logic.reader import check_domain
from planner_reactor.reactor.laws import CHECKED
from planner_reactor.rs import checks
from planner_reactor.rs.checks import check_addition
from planner_reactor.rs.grammar import EXPRESSION_OPERATORS, PREFIX_MINUS, PROCESS_OPERATORS
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.serving import RULES
from planner_reactor.rs.terms import Program
from planner_reactor.rs.vocabulary import BUILT_IN, NEVER_ENDS, Signature
from tests.pages import DOCS, MADE, OWN, PACKAGE, PAGES, ROOT, Block, anchors, blocks, links, made_anew, rows
from tests.transcripts import difference, printed

PROMPT = "$ "
LANGUAGE = DOCS / "language.md"


def found(languages: Iterable[str]) -> list[Block]:
    return [block for page in OWN for block in blocks(page, *languages)]


# --------------------------------------------------------------------------------------- snippets, links, made parts


@pytest.mark.parametrize("page", OWN, ids=lambda page: page.stem)
def test_what_a_page_says_of_python_is_so(page: Path, tmp_path: Path) -> None:
    """All snippets of a page, in order, in one namespace."""
    names: dict[str, Any] = {"__name__": page.stem}
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.IGNORE_EXCEPTION_DETAIL)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    with chdir(tmp_path):
        for block in blocks(page, "python"):
            test = doctest.DocTestParser().get_doctest(block.text, names, str(block), str(page), block.line)
            assert test.examples, block
            said: list[str] = []
            runner.run(test, out=said.append, clear_globs=False)
            names.update(test.globs)
            assert not runner.failures, "".join(said)


@pytest.mark.parametrize("block", found(["console"]), ids=str)
def test_what_a_page_says_a_command_prints_is_what_it_prints(block: Block) -> None:
    for session in block.text.split("\n" + PROMPT):
        command, _, wanted = session.removeprefix(PROMPT).partition("\n")
        if wanted.strip():
            assert not difference(wanted, printed(command))
        else:
            printed(command)


def test_the_program_on_the_first_screen_runs_as_it_says() -> None:
    """Its files are named where they are shown."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    files = dict(re.findall(r"`(\w+\.(?:rsl|py))`[^`]*```\w*\n(.*?)```", text, re.DOTALL))
    sessions = re.findall(r"^\$ (?:\.venv/bin/)?(planner-reactor .+)\n((?:(?!```).+\n)+)", text, re.MULTILINE)
    assert files
    assert sessions
    for command, wanted in sessions:
        assert not difference(wanted, printed(command, files))


@pytest.mark.parametrize("block", found(["rsl"]), ids=str)
def test_programs_on_a_page_can_be_loaded(block: Block) -> None:
    """The note names the processes of hosts that the program uses."""
    names = block.note.split()
    hosts = {n: Signature(n, open_inputs=True, open_results=True, window=(0.0, 1.0)) for n in names}
    found = check_addition(Program(), parse_program(block.text, file=str(block)), signatures=hosts)
    assert not [finding for finding in found if finding.severity == "error"]


@pytest.mark.parametrize("block", found(["itl"]), ids=str)
def test_domains_on_a_page_can_be_read(block: Block) -> None:
    """With the note `whole` a domain must be without fault; else its sentences must be well formed."""
    problems: Iterable[Diagnostic]
    _, problems = parse(Source(block.text, str(block)))
    if block.note == "whole":
        problems = check_domain(block.text, file=str(block))
    assert not list(problems)


@pytest.mark.parametrize("page", [*PAGES, ROOT / "README.md", ROOT / "CHANGELOG.md"], ids=lambda page: page.stem)
def test_links_lead_somewhere(page: Path) -> None:
    for link in links(page):
        if re.match(r"\w+:", link):
            continue
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), link
        assert not anchor or anchor in anchors(target), link


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_made_parts_are_what_the_code_says(page: Path) -> None:
    assert made_anew(page) == page.read_text(encoding="utf-8"), "python -m tests.pages"


def test_every_made_part_is_used_and_every_page_is_in_the_index() -> None:
    assert {name for page in PAGES for name in re.findall(r"<!-- made: (\w+)", page.read_text())} == set(MADE)
    index = DOCS / "index.md"
    linked = {(DOCS / link).resolve() for link in links(index)}
    assert {page for page in OWN if page != index} <= linked


# ------------------------------------------------------------------------------------------------------ the language


def test_the_operators_stand_in_the_order_of_their_strength() -> None:
    told = [re.findall(r"`(?:P )?(~|[^\w\s`]+)(?:P| Q)`", row[0]) for row in rows(LANGUAGE, "## Operators")]
    strengths = sorted({o.strength for o in PROCESS_OPERATORS}, reverse=True)
    assert told == [[o.sign for o in PROCESS_OPERATORS if o.strength == s] for s in strengths]


def test_the_rules_that_the_page_names_are_those_of_the_semantics() -> None:
    code = "".join((PACKAGE / f"rs/{name}.py").read_text(encoding="utf-8") for name in ("evolves", "leaves"))
    text = LANGUAGE.read_text(encoding="utf-8")
    told = set(re.findall(r"\b(N\d+'?|SEQ|PAR|COM|TIME)(?![\w'])", text))
    assert told >= {f"N{n}" for n in range(1, 11)}
    assert all(re.search(rf"\b{rule}", code) for rule in told)


def test_the_operators_on_values_stand_in_the_order_of_their_strength() -> None:
    told = [re.findall(r"`(-(?= x)|[^\w\s`]+)", row[0]) for row in rows(LANGUAGE, "## Names and values")]
    by_strength: dict[int, list[str]] = {PREFIX_MINUS: ["-"]}
    for operator in EXPRESSION_OPERATORS:
        by_strength.setdefault(operator.strength, []).append(operator.sign)
    assert told == [by_strength[s] for s in sorted(by_strength, reverse=True)]


def test_every_built_in_process_is_told_as_it_is() -> None:
    told: dict[str, str] = {}
    for heading in ("### Ports, time, tests", "### Situations", "### Adaptation", "### Monitors"):
        told |= {row[0].strip("`"): row[1] for row in rows(LANGUAGE, heading)}
    assert told == {signature.usage(): ends(signature) for signature in BUILT_IN.values()}


def ends(signature: Signature) -> str:
    if signature.outcomes == NEVER_ENDS:
        return "never"
    how = " or ".join(outcome for outcome in ("stop", "abort") if outcome in signature.outcomes)
    return f"at once, {how}" if signature.window == (0.0, 0.0) else how


def test_every_leaf_with_a_rule_of_its_own_is_told() -> None:
    told = {name for row in rows(LANGUAGE, "### Transitions") for name in re.findall(r"`(\w+)`", row[0])}
    assert told == set(BUILT_IN) - {"STOP", "ABORT", "NIL", "IN", "OUT", "STREAM"}
    assert set(RULES) <= told


def test_every_cause_of_an_abort_is_told() -> None:
    rooms = [PACKAGE / room for room in ("rs", "runtime", "reactor")]
    code = "".join(file.read_text(encoding="utf-8") for room in rooms for file in room.glob("*.py"))
    told = {row[0].strip("`") for row in rows(LANGUAGE, "### Causes")}
    assert told == set(re.findall(r'\bcause="([a-z]+)"', code)) | {"assumption", "budget", "stub"}


def test_every_finding_of_the_checks_is_told() -> None:
    assert checks.__doc__ is not None
    listed = re.findall(r"^ {6}((?:[a-z-]+(?:, )?)+)\s+(error|warning)", checks.__doc__, re.MULTILINE)
    known = {code: severity for codes, severity in listed for code in codes.split(", ")}
    table = rows(LANGUAGE, "## What is checked before anything runs")
    told = {code: row[1] for row in table for code in re.findall(r"`([a-z-]+)`", row[0])}
    assert told == known


# ------------------------------------------------------------------------------------------------------- the domains

DOMAINS = DOCS / "domains.md"


def test_the_relations_that_have_names_are_told() -> None:
    told = {row[0].strip("`"): set(row[1].strip("`").split()) for row in rows(DOMAINS, "## Grammar")}
    assert told == {name: set(names(relation)) for name, relation in NAMED.items()}


def test_the_sections_of_a_schema_are_told() -> None:
    assert {re.findall(r"\w+", row[0])[0] for row in rows(DOMAINS, "### Action schemas")} == set(LABELS)


def test_every_finding_about_a_domain_is_told() -> None:
    code = "".join(file.read_text() for file in (PACKAGE / "logic").glob("*.py"))
    code += (PACKAGE / "calls/checking.py").read_text()
    code = code.replace((PACKAGE / "logic/network_text.py").read_text(), "")
    known = set(re.findall(r'"([a-z]+-[a-z-]+|syntax|arity|contradiction|likelihood|period)"(?:, |\))', code))
    told = {c for row in rows(DOMAINS, "## What is checked") for c in re.findall(r"`([a-z-]+)`", row[0])}
    assert told == known - {"misplaced-host", "utf-8"}


# ------------------------------------------------------------------------------------------------------- the reactor

REACTOR = DOCS / "reactor.md"
LATER_LAWS = {9, 12}
OTHER_LAWS = {16, 17}


def quoted(cell: str) -> list[str]:
    return re.findall(r"`(\w+)`", cell)


def test_the_fields_of_an_adaptation_are_told() -> None:
    told = [name for row in rows(REACTOR, "## An adaptation") for name in quoted(row[0])]
    assert told == list(Adaptation.__struct_fields__)


def test_the_reasons_of_refusals_are_told() -> None:
    files = ("admission", "adaptation", "migrating", "reactor", "waiting")
    code = "".join((PACKAGE / f"reactor/{name}.py").read_text() for name in files)
    told = {name for row in rows(REACTOR, "### Examined") for name in quoted(row[0])}
    assert told == set(re.findall(r'(?:RefusedError\(\s*|\.reason = )"(\w+)"', code))


def test_the_kinds_of_perceptions_are_told() -> None:
    assert [quoted(row[0])[0] for row in rows(REACTOR, "## What it reports")] == list(get_args(PerceptionKind))


def test_the_laws_are_told_as_they_are_watched() -> None:
    told = {int(row[0]): row[2] for row in rows(REACTOR, "## The reactor's laws")}
    assert set(told) == set(range(1, 18))
    assert {law for law, watched in told.items() if watched == "not in this version"} == LATER_LAWS
    assert set(CHECKED) == set(told) - LATER_LAWS - OTHER_LAWS


def test_the_kinds_of_events_are_told() -> None:
    rooms = [PACKAGE / room for room in ("reactor", "runtime", "experiments")]
    code = "".join(file.read_text() for room in rooms for file in room.glob("*.py"))
    known = set(re.findall(r'(?:record|[._]notice|note|[._]told)\(\s*"(\w+)"', code))
    assert {kind for row in rows(REACTOR, "## The trace") for kind in quoted(row[0])} == known


# ------------------------------------------------------------------------------------- places in the code and in tests


def places(page: Path) -> Iterator[tuple[Path, str]]:
    """The files, and the names in them, that stand in the tables of a page as `file.py:name`."""
    for cell in re.findall(r"`([^`\n]+)`", page.read_text(encoding="utf-8")):
        if (found := re.fullmatch(r"((?:\w+/)*\w+\.(?:py|itl|toml|rsl))(?::(\w+))?", cell)) is not None:
            yield Path(found[1]), found[2] or ""


@pytest.mark.parametrize("page", ["papers", "terminology", "tour"])
def test_every_place_that_a_page_names_is_there(page: str) -> None:
    lost = []
    for path, name in places(DOCS / f"{page}.md"):
        files = [top / path for top in (PACKAGE, ROOT / "tests", ROOT) if (top / path).is_file()]
        defined = re.compile(rf"^(?:\s*(?:async )?(?:def|class) {name}\b|\s*{name}\b[^=\n]*=)", re.MULTILINE)
        if not files or (name and not any(defined.search(file.read_text(encoding="utf-8")) for file in files)):
            lost.append(f"{path}:{name}")
    assert not lost


# ---------------------------------------------------------------------------------------------------- the command line

CLI = DOCS / "cli.md"
SAMPLES = {
    "kit and loop": "kit --trays 1",
    "run": "run examples/03_ports.rsl Main",
    "check": "check examples/11_mistakes.rsl",
    "plan": "plan examples/09_cafe.itl",
    "network": "network examples/12_intervals.txt",
    "evolve": "evolve examples/14_limits.rsl Thermometer",
    "limits": "limits examples/14_limits.rsl 'Room[t, s]' --sensors Alarm",
    "verify": "verify examples/03_ports.rsl Main",
}


def options_of(command: str) -> set[str]:
    parameters = get_command(app).commands[command].params  # type: ignore[attr-defined]
    return {option for parameter in parameters for option in parameter.opts if option.startswith("--")}


@pytest.mark.parametrize("command", [name for name in ORDER if name not in LATER])
def test_the_options_of_a_command_are_told(command: str) -> None:
    shared = command in ("kit", "loop")
    table = rows(CLI, f"### Options of {'kit and loop' if shared else command}")
    told = {row[0].strip("`") for row in table if not shared or row[1] in ("both", command)}
    assert told == options_of(command)


@pytest.mark.parametrize("commands", SAMPLES)
def test_the_keys_of_the_json_are_told(commands: str) -> None:
    said = printed(f"planner-reactor {SAMPLES[commands]} --json").replace("…", "0").splitlines()
    found = set(json.loads(next(line for line in said if line.startswith("{"))))
    heading = f"### What {commands} print{'' if ' ' in commands else 's'}"
    told = {key for row in rows(CLI, heading) for key in quoted(row[0])}
    if commands == "kit and loop":
        told |= set(quoted(CLI.read_text().split("for `kit` that is", 1)[1].split(". Then", 1)[0]))
    assert told == found


def test_the_experiments_are_told() -> None:
    told = {row[0].strip("`"): row[1] for row in rows(CLI, "## experiment")}
    assert told == {name: experiment.about for name, experiment in EXPERIMENTS.items()}
