"""A disk that crashes, tears and fills, for tests."""

from planner_reactor.simulation.disks import SimulatedDisk as TornDisk

__all__ = ["TornDisk"]
