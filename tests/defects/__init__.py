"""Defects in the reactor, its journal, the link and the planner, and the law of the simulation that catches each.

By hand (`by_hand.toml`: at least one for each law and each row of the fault table), and by the tool that makes mutants
of the rules (`tests.mutants.operators`). Each meets up to a hundred seeds of chaos in a process of its own; the working
tree is not touched. `python -m tests.defects` runs them, `telling` makes the table of docs/defects.md.
"""
