"""Check of an installation: versions, extras, machine, kernels, places, and closed forms."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from vibeam.studies.doctor.machine import Finding, Severity

__all__ = ["Finding", "Severity", "examine"]


def examine() -> tuple[Finding, ...]:
    """Examine the installation; a fault in one part leaves the others as they are."""
    return tuple(finding for part in _parts() for finding in _within(part))


def _within(part: Callable[[], Iterator[Finding]]) -> Iterator[Finding]:
    try:
        yield from part()
    except Exception as fault:  # of a package that is missing or broken, which has its own line
        name = part.__name__.replace("_", " ")
        yield Finding(name, name, Severity.FAULT, f"not examined: {type(fault).__name__}: {fault}")


def _parts() -> tuple[Callable[[], Iterator[Finding]], ...]:
    from vibeam.studies.doctor.machine import machine, packages, places
    from vibeam.studies.doctor.self_check import kernels, self_check

    return packages, machine, places, kernels, self_check
