"""What a program can do: exploration of its states, equivalence of behaviours, conformance of runs.

Where to look: `explore` reaches every configuration of a small program; `equivalence` compares two processes;
`conformance` follows a live run through the semantics. All stand on `rs.evolves`; nothing here executes programs.
"""
