"""``python -m vibeam`` is the command ``vibeam``."""

from __future__ import annotations

from vibeam.cli.main import main

main()
