"""Declaration of the study."""

from __future__ import annotations

from vibeam.extensions.dictionary.plan import ModeSharePlan
from vibeam.report.declaration import StudyDeclaration

HOME = "vibeam.extensions.dictionary"
MODE_SHARE = StudyDeclaration(
    "mode_share",
    f"{HOME}.mode_share:mode_share",
    "what a sensor shows of the restitution; other programs' terms",
    sheet=f"{HOME}.sheets:sheet",
    asks=ModeSharePlan,
    examples=(
        "vibeam mode_share mine.toml",
        "vibeam mode_share mine.toml --contact-time '0.5 ms'  # the stop's restitution in other programs' terms",
    ),
)
STUDIES = (MODE_SHARE,)
