"""Identification: linear parameters of a measured decay, spectrum or frequency response."""

from __future__ import annotations

from vibeam_models.extensions import Extension

EXTENSION = Extension({"command": "vibeam.extensions.identification.declared:COMMANDS"}, replaces=("fit",))
