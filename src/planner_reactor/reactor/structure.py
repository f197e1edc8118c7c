"""The shape of a reactor (see `rs.reactions`)."""

from planner_reactor.rs.reactions import REACTION, Reaction, children, cycle, reaction_of

__all__ = ["REACTION", "Reaction", "children", "cycle", "reaction_of"]
