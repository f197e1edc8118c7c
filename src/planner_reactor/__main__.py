"""`python -m planner_reactor`: the command."""

import sys

from planner_reactor.cli import main

sys.exit(main())
