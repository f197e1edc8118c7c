"""The kitting workcell of R §8: what happens in it, what its sensors see, what its arm can do.

Three layers, from the outside in: `world` (truth: belt, trays, downstream, ledgers, disturbances), `sensors`
(what can be seen of it) and the basic processes (`picking`, `placing`, `looking`), which know only the
sensors and their own `memory`. `host` puts them together into what a program needs.
"""
