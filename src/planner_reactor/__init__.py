"""planner-reactor: robot programs that start acting at once and keep improving while they run."""
