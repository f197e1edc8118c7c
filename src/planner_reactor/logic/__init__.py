"""INTERVAL TEMPORAL LOGIC: the kernel of the planner (R §7.4), which knows nothing of RS.

Allen relations and networks (`allen`, `network`, `scenarios`, `network_text`), formulas and unification
(`formulas`), planning domains and the notation `*.itl` (`domain`, `reader`; grammar in `itl_syntax`, faults
in `checks`).
"""
