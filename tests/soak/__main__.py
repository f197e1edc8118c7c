"""`python -m tests.soak [SITUATIONS]`: a million situations, ten thousand at once; ends with 1 if anything grows.

Memory is that of the process as the system counts it, looked at a hundred times; the line is laid through what comes
after the crowd, whose memory the system does not get back. It must rise by less than a byte a situation.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

from tests.soak.soak import Sample, Soak, resident, slope

CROWD = 10_000
SAMPLES = 100


def main() -> None:
    many = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    began = time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        soak = Soak(Path(folder) / "reactor.journal")
        soak.crowd(CROWD)
        samples: list[Sample] = []
        while soak.situations < many:
            soak.live(many // SAMPLES)
            samples.append(soak.sample(resident))
            print(*samples[-1], flush=True)
    rises = slope(samples[SAMPLES // 10 :])
    grown = [samples[-1][n] - samples[0][n] for n in (2, 3)]
    print(f"{soak.situations:,} situations, {soak.most:,} at once, {soak.applied:,} adaptations applied,"
          f" {soak.scheduler.now / 3600:.1f} h: {rises:+.3f} bytes a situation, threads {grown[0]:+d}, open files"
          f" {grown[1]:+d}, {len(soak.reactor.laws.violations)} violations; {time.process_time() - began:.0f} s of CPU"
          " time")  # fmt: skip
    raise SystemExit(abs(rises) > 1.0 or any(grown) or bool(soak.reactor.laws.violations) or soak.most < CROWD)


main()
