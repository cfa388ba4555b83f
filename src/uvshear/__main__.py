"""``python -m uvshear``: the command line."""

from uvshear.cli import main

main()
