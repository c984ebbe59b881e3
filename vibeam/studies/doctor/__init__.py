"""Check of an installation: versions, extras, kernels, and closed forms."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from vibeam.studies.doctor.packages import Finding, Severity

__all__ = ["Finding", "Severity", "examine", "verdict"]


def examine() -> tuple[Finding, ...]:
    """Examine the installation; a fault in one part leaves the others as they are."""
    from vibeam.studies.doctor.packages import packages
    from vibeam.studies.doctor.self_check import kernels, pages, self_check

    parts = (packages, kernels, pages, self_check)
    return tuple(finding for part in parts for finding in _within(part))


def verdict(findings: Sequence[Finding]) -> str:
    """Sentence on the installation: what is at fault, or what was found to be right."""
    faults = [each.name for each in findings if each.state is Severity.FAULT]
    if faults:
        return f"The installation has {len(faults)} fault{'s' * (len(faults) > 1)}: {', '.join(faults)}."
    right = [each.topic for each in findings if each.state is Severity.GOOD]
    about = {each.name: each.value.partition(" ")[0] for each in findings}
    return (
        f"The installation is whole: vibeam {about['vibeam']} on Python {about['Python']}, {right.count('packages')} "
        f"packages imported, {right.count('self-check')} known results computed rightly."
    )


def _within(part: Callable[[], Iterator[Finding]]) -> Iterator[Finding]:
    try:
        yield from part()
    except Exception as fault:  # of a package that is missing or broken, which has its own line
        name = part.__name__.replace("_", " ")
        yield Finding(name, name, Severity.FAULT, f"not examined: {type(fault).__name__}: {fault}")
