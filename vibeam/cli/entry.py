"""The command as ``python -m vibeam`` has it: an extension that cannot be loaded is told in place of a traceback."""

from __future__ import annotations

from vibeam.cli.streams import WRONG, say
from vibeam_models.extensions import ExtensionError

try:
    from vibeam.cli.main import main as main
except ExtensionError as error:
    say(str(error))
    raise SystemExit(WRONG) from None
