"""Mutants of the semantics: is every rule pinned down by a test?

`operators` makes small changes to the code of the rules (a case less, a condition turned round, the old store
given back), `rules` says which rule each belongs to, `running` runs the tests on one of them in a process of its
own, and `python -m tests.mutants` (`make mutants`) runs them all. Survivors either get a test, or stand in
`equivalent.toml` with the reason why no test can tell them from the original (docs/decisions, 0022).
"""
