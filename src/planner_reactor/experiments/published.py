"""What the papers print of their own run (R §9.2; T is the conference paper), to be set beside ours.

Where they contradict each other both values stand. Times are seconds from the start of the run.
"""

from __future__ import annotations

from typing import Final

FIRST_ISSUED: Final = 26.0  # Fig. 12
FIRST_APPLIED: Final = 28.0  # Fig. 13; the lag of 2 s in Fig. 12
IDEAL: Final = 40.0  # Fig. 13
IDEAL_ISSUED: Final = 42.0  # "16 s after the first adaptation", Fig. 12
REACTOR_FOLLOWS: Final = (103.0, 104.0)  # both relaxations, Fig. 14
MOVED: Final = 152.0  # AM fails, Figs 17 and 18
ISSUING_FROM: Final = 155.0  # Fig. 18
SILENT: Final = 161.0  # Fig. 18
ISSUING_TO: Final = 165.0  # "continuing for about 10 s", Fig. 18
BLOCKED: Final = 215.0  # ADD fails, Fig. 17
REINSTATED: Final = 357.0  # ADD holds again, Figs 17 and 19
RESPONSE: Final = 11.0  # "roughly 11 s"; 155 + 10 + 1 − 152 would be 14
ASSUMPTIONS: Final = (6, 9)  # in use by the first reactor, by the first ideal one
