"""py_trees: a subtree of a running tree is replaced between two ticks (`pip install py_trees`)."""

from __future__ import annotations

import importlib.metadata
import random
import time

import py_trees  # type: ignore[import-not-found, unused-ignore]
from measuring import percentiles

VERSION = importlib.metadata.version("py_trees")
GROUPS = 1_000
"""Of ten nodes each."""


class Waits(py_trees.behaviour.Behaviour):  # type: ignore[misc, unused-ignore]
    """A leaf that is never done."""

    def update(self) -> py_trees.common.Status:
        return py_trees.common.Status.RUNNING


def group(name: str) -> py_trees.composites.Composite:
    """A parallel with nine leaves."""
    made = py_trees.composites.Parallel(name, py_trees.common.ParallelPolicy.SuccessOnAll(synchronise=False))
    made.add_children([Waits(f"{name}.{n}") for n in range(9)])
    return made


def swaps(count: int = 50) -> tuple[float, float]:
    """(p50, p99) microseconds of the processor, from a subtree that is built to the end of the first tick with it."""
    root = py_trees.composites.Parallel("root", py_trees.common.ParallelPolicy.SuccessOnAll(synchronise=False))
    root.add_children([group(f"g{n}") for n in range(GROUPS)])
    tree = py_trees.trees.BehaviourTree(root)
    tree.tick()
    draw, latencies = random.Random(count), []
    for n in range(count):
        new, old = group(f"n{n}"), root.children[draw.randrange(GROUPS)]
        began = time.thread_time()
        tree.replace_subtree(old.id, new)
        tree.tick()
        latencies.append(time.thread_time() - began)
    return percentiles(latencies)
