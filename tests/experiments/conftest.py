"""The papers' run, replayed once for all tests of this folder, and the page of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from planner_reactor.experiments import papers
from planner_reactor.experiments.papers_run import Replay, replay
from planner_reactor.experiments.registry import EXPERIMENTS


@dataclass(frozen=True)
class Written:
    """What the experiment `papers` left in a folder, what it found, and the progress it told."""

    folder: Path
    found: Mapping[str, Any]
    progress: list[tuple[int, int]]


@pytest.fixture(scope="session")
def replayed() -> Replay:
    """On the papers' clock, on ours, and with every assumption relaxed."""
    return replay()


@pytest.fixture(scope="session")
def written(replayed: Replay, tmp_path_factory: pytest.TempPathFactory) -> Written:
    """The experiment, of this replay."""
    folder, seen = tmp_path_factory.mktemp("papers"), list[tuple[int, int]]()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(papers, "replay", lambda: replayed)
        run = EXPERIMENTS["papers"].run
        found = run(folder, trials=None, workers=1, watch=lambda done, of: seen.append((done, of)))
    return Written(folder, found, seen)
