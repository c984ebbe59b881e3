"""Dictionary of restitution: the contact's, that of mode 1 at a sensor, and the same in other programs' terms."""

from __future__ import annotations

from vibeam_models.extensions import Extension

HOME = "vibeam.extensions.dictionary"
EXTENSION = Extension(
    {
        "plan of a study": f"{HOME}.declared:PLANS",
        "study": f"{HOME}.studies:STUDIES",
        "command": f"{HOME}.declared:COMMANDS",
    }
)
