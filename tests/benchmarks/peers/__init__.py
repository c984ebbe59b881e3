"""Other people's solvers for the same impacts: one peer a file, each as a user who knows it well would write it."""

from __future__ import annotations

from importlib import import_module

from peers.job import Entry

FILES = ("scipy_events", "sundae", "heyoka_taylor", "diffrax_batched", "siconos_event_driven")


def entries() -> tuple[list[Entry], dict[str, str]]:
    """What is installed, and why the other ones are not there."""
    found: list[Entry] = []
    absent: dict[str, str] = {}
    for name in FILES:
        try:
            found += import_module(f"peers.{name}").ENTRIES
        except ImportError as error:
            absent[name] = str(error)
    return found, absent
