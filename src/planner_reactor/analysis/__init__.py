"""What a program can do: states, limit sets, properties, adaptations; equivalence of behaviours, conformance of runs.

Where to look: `explore` is the plain reading, every configuration of a small program; `transitions` the fast one, over
`networks` of `cells`, which `partitions` and `stubborn` reduce, `factoring` and `enumeration` count, `verdicts` judge
and `exports` write. `evolution` and `limits` read a text with unknowns; `properties` and `protocols` ask about runs and
adaptations; `equivalence` compares two processes; `conformance` follows a live run through the semantics. All stand on
`rs.evolves`; nothing here executes programs.
"""
