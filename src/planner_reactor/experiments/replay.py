"""Law 16: the same seed and inputs give the same trace. Asked by running the beginning of a run once more.

The replay is stopped after as many events as the trace's checkpoint covers, or at the end of a shorter run; then the
two are compared event by event, by hash. Only runs that are charged no real time can be asked.
"""

from __future__ import annotations

from planner_reactor.experiments.loop import Loop
from planner_reactor.trace import CHECKPOINT, Event


def check_replay(first: Loop, again: Loop, *, until: float | None) -> None:
    """Run `again`, put together as `first` was, and record a breach of law 16 if its trace differs."""
    wanted = min(first.trace.count, CHECKPOINT)

    def stop_when_seen(event: Event) -> None:
        if event.number >= wanted:
            again.scheduler.stop()

    again.trace.sinks.append(stop_when_seen)
    again.run(until=until)
    whole = first.trace.count <= CHECKPOINT
    ours = first.trace.hash if whole else first.trace.checkpoint_hash
    theirs = again.trace.hash if whole else again.trace.checkpoint_hash
    if ours != theirs:
        first.reactor.laws.breach(16, f"a replay of the first {wanted} events gave another trace")
    first.replayed = True
