"""`python -m planner_reactor.simulation`: see `campaign`."""

import sys

from planner_reactor.simulation.campaign import main

sys.exit(main())
