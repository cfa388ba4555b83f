"""``python -m uvshear``: the command line."""

import sys

from uvshear.cli import main

sys.exit(main())
