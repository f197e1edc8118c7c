"""What the command does, as plain Python calls: one module for each sub-command, without any printing.

    import planner_reactor
    planner_reactor.kit(trays=5, seed=1)["kits"]

`planner_reactor` itself offers them under the names of the sub-commands and imports a module only when it is asked
for. Each takes what the options of the sub-command say, returns plain data with the keys of its JSON, and raises
`InputError`, `SourceError` or `BudgetError` for what it cannot use, before anything has been written or started.
"""
