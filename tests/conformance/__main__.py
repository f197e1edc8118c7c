"""`python -m tests.conformance`: see `campaign`."""

import sys

from tests.conformance.campaign import main

sys.exit(main(sys.argv[1:]))
