"""The link: what passes between planner and reactor, and how."""
