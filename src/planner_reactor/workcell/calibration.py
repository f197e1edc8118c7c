"""The numbers of the event-driven cell: durations in seconds, lengths in metres.

They are pinned here, and nowhere else: a pick and place takes about 6.5 s, as the physics cell of the
prototype did. A duration is a mean; the arm varies each by `spread` (uniform, from its own random stream).
`host` makes of them the age windows that the basic processes declare, which bound every safe adaptation.

Legend: `patience_s` how long a process waits for something to appear before it aborts; `starved_s` after how
long a wait counts as starvation; `quiet_s` how long evidence against an assumption counts.
"""

from __future__ import annotations

import msgspec
from msgspec.structs import replace


class Calibration(msgspec.Struct, frozen=True):
    """Every duration, rate, tolerance and error rate of the cell."""

    # the arm
    arbitration_s: float = 0.05  # the arm collects requests for so long before it chooses
    reach_s: float = 2.3
    close_s: float = 0.3
    carry_s: float = 2.3
    insert_s: float = 1.0
    retreat_s: float = 0.3
    chase_s: float = 1.0  # after a part that moved away from under the gripper
    stack_s: float = 1.5  # to the stack of trays
    set_down_s: float = 2.6  # a tray, from the stack into the tray area
    grip_tray_s: float = 1.2
    push_out_s: float = 2.8
    put_back_s: float = 2.0
    discard_s: float = 1.5
    spread: float = 0.03
    reconcile_s: float = 5.0  # a thing held for nobody for so long is put away
    # looking and testing
    look_s: float = 0.3
    inspect_s: float = 0.5
    verify_s: float = 1.0
    test_s: float = 2.0
    pose_noise: float = 0.0008
    variant_error: float = 0.01
    miss: float = 0.01
    test_error: float = 0.0
    look_again_s: float = 2.0
    # geometry
    belt_speed: float = 0.025
    lanes: tuple[float, ...] = (-0.06, -0.02, 0.02, 0.06)
    lane_noise: float = 0.005
    grasp_tolerance: float = 0.012
    seat_tolerance: float = 0.008
    seen_tolerance: float = 0.015
    # judgement
    patience_s: float = 45.0
    starved_s: float = 15.0
    quiet_s: float = 120.0
    verdict_s: float = 2.0  # downstream's answer after it took a tray
    reservation_s: float = 30.0  # how long downstream keeps the place that it promised
    refill_s: float = 20.0  # a new batch of trays arrives so long after the stack runs low
    refill_below: int = 4
    refill_count: int = 8

    @property
    def pick_and_place_s(self) -> float:
        """Look, reach, close, carry, insert, retreat."""
        return self.look_s + self.reach_s + self.close_s + self.carry_s + self.insert_s + self.retreat_s

    def kit_s(self, kinds: int) -> float:
        """How long one kit takes when nothing goes wrong and nothing is awaited."""
        tray = self.stack_s + self.close_s + self.set_down_s + self.grip_tray_s + self.push_out_s
        return tray + kinds * (self.pick_and_place_s + self.arbitration_s)

    def wait_s(self, kinds: int) -> float:
        """The longest wait of a process that needs the arm: its own patience, and every other kind's turn."""
        return self.patience_s + kinds * (self.pick_and_place_s + self.test_s)


PINNED = Calibration()

MOTIONS = (
    "reach_s", "close_s", "carry_s", "insert_s", "retreat_s", "chase_s", "stack_s", "set_down_s", "grip_tray_s",
    "push_out_s", "put_back_s", "discard_s", "look_s", "inspect_s", "verify_s", "test_s",
)  # fmt: skip
"""What the arm, its camera and its test station take."""


def slowed(calibration: Calibration, factor: float) -> Calibration:
    """The same cell, in which everything that the arm does takes `factor` times as long."""
    return replace(calibration, **{name: getattr(calibration, name) * factor for name in MOTIONS})
