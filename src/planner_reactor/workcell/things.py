"""The things that are truly in the cell: parts and trays. Only the world and its sensors may touch them.

A part on the belt rides with it: `u` is its place in the belt's own frame (m), so its distance from the
entrance at time t is `u + speed * t`; `y` is across the belt. `marks` are the numbers of the faults that
spoiled a thing: by them a rejected kit is traced back to what cost it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

Place = Literal["belt", "gripper", "tray", "shipped", "rejected", "passed", "taken"]
"""Where a part can be; the last four are final."""

TrayPlace = Literal["stack", "gripper", "area", "shipped", "rejected"]


@dataclass(slots=True)
class Part:
    """One part, as it truly is. `number` is the world's own count, which no sensor can read."""

    number: int
    kind: str
    variant: str
    good: bool = True
    damaged: bool = False
    u: float = 0.0
    y: float = 0.0
    place: Place | Literal["nowhere"] = "nowhere"
    marks: tuple[int, ...] = ()


@dataclass(slots=True)
class Tray:
    """One tray: what is in each slot (by the kind that the slot is for), and where it stands in the tray area
    (m).
    """

    number: int
    good: bool = True
    place: TrayPlace | Literal["nowhere"] = "nowhere"
    pose: tuple[float, float] = (0.0, 0.0)
    slots: dict[str, Part] = field(default_factory=dict)
    marks: tuple[int, ...] = ()

    @property
    def tag(self) -> str:
        """The printed code that a camera reads."""
        return f"tag{self.number}"
