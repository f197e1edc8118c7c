"""Deterministic simulation: the real reactor, journal, link and planner in one process, and everything that goes wrong.

One seeded scheduler owns time and order; link, disk, clock and world are simulated, and faults strike at given times or
at given points inside an adaptation. What a run comes to depends on its `Case` alone (docs/reliability.md).
"""
