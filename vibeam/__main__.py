"""``python -m vibeam`` is the command ``vibeam``."""

from vibeam.cli import main

main()
