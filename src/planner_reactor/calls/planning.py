"""`plan`: what the planner would send, segment by segment, to a reactor that applies everything at once (R §8.3).

Nothing runs: the planner is told that each adaptation was applied, and goes on until there is nothing left to add.
It relaxes nothing by itself; assumptions that are to be done without are given up before it begins.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import msgspec

from planner_reactor.calls.inputs import names_in, read_text, unknown, whole
from planner_reactor.link.messages import Adaptation, Perception, PerceptionKind
from planner_reactor.logic.domain import Domain
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import Program, calls

MONITORS = ("ASSUMONITOR", "HOLDMONITOR")


def plan(
    file: str | Path,
    *,
    without: str | Iterable[str] = (),
    steps: int | None = None,
    goal: str | None = None,
    explain: bool = False,
) -> dict[str, Any]:
    """Plan for a goal of a domain `*.itl` (the first, if none is named).

    `without`: assumptions to do without, such as "AQ,AM"; `steps`: stop after so many segments. Returns `segments`
    (each with `situation`, `purpose`, `text`, `adds`, `kills`, `assumptions`, `monitors`, `perceptions`, `stubs` and
    `issued_s`), `issued_s` (processor seconds until the first was issued, None if there is none), `ideal` (is
    nothing left to add?), `impossible` (situations without a plan, and why) and `warnings`. With `explain` each segment
    has `why` too (what set it off; for each situation what is wanted, which action is there for what, and what rests on
    which assumption) and `explained`, the same to be read.
    """
    if steps is not None:
        whole("steps", steps, 1)
    domain = read_domain(read_text(file), file=str(file))
    relaxed = _known(domain, without)
    began = time.process_time()
    planner = Planner(domain, goal=goal, relax=())
    perceived = 0

    def perceive(kind: PerceptionKind, subject: str) -> None:
        nonlocal perceived
        perceived += 1
        planner.perceive(Perception(number=perceived, time=0.0, kind=kind, subject=subject))

    for name in relaxed:
        perceive("assumption_failure", name)
    segments: list[dict[str, Any]] = []
    ids: list[int] = []
    while (steps is None or len(segments) < steps) and (step := planner.step()) is not None:
        for adaptation in step.adaptations:
            issued = time.process_time() - began
            segments.append({**segment(adaptation), "situation": step.situation, "issued_s": issued})
            ids.append(adaptation.id)
            perceive("adaptation_applied", str(adaptation.id))
    if explain:
        segments = [{**said, **_why(planner, number)} for said, number in zip(segments, ids, strict=True)]
    return {
        "segments": segments[:steps],
        "issued_s": segments[0]["issued_s"] if segments else None,
        "ideal": planner.ideal,
        "impossible": dict(planner.impossible),
        "warnings": list(planner.warnings),
    }


def _why(planner: Planner, adaptation: int) -> dict[str, Any]:
    explanation = planner.explain(adaptation)
    return {"why": msgspec.to_builtins(explanation), "explained": str(explanation)}


def segment(adaptation: Adaptation) -> dict[str, Any]:
    """One adaptation as plain data: its text, and what that text watches, asks for and leaves open."""
    program = parse_program(adaptation.definitions)
    rests_on = dict.fromkeys([*(a for change in adaptation.changes for a in change.assumptions), *adaptation.adopts])
    return {
        "situation": "",
        "purpose": adaptation.purpose,
        "text": adaptation.definitions,
        "adds": list(adaptation.adds),
        "kills": list(adaptation.kills),
        "assumptions": sorted(rests_on),
        "monitors": [f"{name}[{subject}]" for name in MONITORS for subject in _about(program, name)],
        "perceptions": _about(program, "REPORT"),
        "stubs": _about(program, "STUB"),
    }


def _about(program: Program, process: str) -> list[str]:
    """The first arguments of all calls of a process, each once, in the order of the text."""
    found = (call for schema in program.schemas for call in calls(schema.body) if call.name == process)
    return list(dict.fromkeys(show(call.arguments[0]) for call in found))


def _known(domain: Domain, without: str | Iterable[str]) -> tuple[str, ...]:
    names = names_in(without) if without else ()
    for name in names:
        if name.partition("(")[0] not in domain.assumptions:
            raise unknown("assumption", name, domain.assumptions)
    return names
