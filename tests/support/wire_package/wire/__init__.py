"""A wire that holds the beam: an extension of a user's own."""

from vibeam_models.extensions import Extension

KINDS = ("model", "kind of figure", "plan of a study", "study", "command", "section of a page")
EXTENSION = Extension({kind: f"wire.declared:{kind.upper().replace(' ', '_')}" for kind in KINDS})
