"""Runs, measures, figures, sweeps: where planner, reactor and a world are brought together.

`loop` is one run; `timing` says what the planner's thinking costs; `report` is what a run comes to; `measures` reads
the papers' quantities off a trace; `figures` draws them. Nobody imports this room but the command line.
"""
