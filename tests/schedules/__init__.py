"""Random schedules of failures, returns, other perceptions and answers, on the real planner (docs/regimes.md)."""
