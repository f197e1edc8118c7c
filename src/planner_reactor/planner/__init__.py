"""WHAT KEEPS IMPROVING THE REACTOR: a planner that chains actions in the interval logic (R §7).

From outside in: `planner` (the two loops, what to do next), `issuing` (from segments to what is sent),
`model` (what is known of the reactor), `refinement` (one situation's segment), `reactions` (its text),
`structure` (from a partial plan to a process), `search` and `threats` (chaining), `plan` (the partial
plan), `beliefs` (the problem-solving context). It knows a model of the reactor, never the reactor; no word
of any domain occurs here.
"""

from planner_reactor.planner.planner import Planner
from planner_reactor.planner.steps import Relaxation, Step

__all__ = ["Planner", "Relaxation", "Step"]
