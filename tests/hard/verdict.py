"""What came of one number of a part of the torture: counts, worst figures, findings."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

FOLDERS = re.compile(r"(?<![\w.])/(?:[\w.+-]+/)+")


@dataclass
class Verdict:
    """Filled in as checks go on."""

    counts: dict[str, int] = field(default_factory=dict)
    worst: dict[str, float] = field(default_factory=dict)
    findings: list[str] = field(default_factory=list)

    def count(self, name: str, more: int = 1) -> None:
        self.counts[name] = self.counts.get(name, 0) + more

    def find(self, text: str) -> None:
        """A finding, its files without the folders that they lay in: the report is to be the same on any machine."""
        self.findings.append(FOLDERS.sub("", text))

    def hold(self, true: bool, text: str) -> None:
        """A finding unless ``true``."""
        if not true:
            self.find(text)

    def measure(self, name: str, value: float, bar: float) -> None:
        """A figure kept where it is the worst so far; a finding where it is beyond ``bar``, or no number."""
        self.worst[name] = max(self.worst.get(name, 0.0), float(value))
        if not value <= bar:
            self.find(f"{name} {value:.3g} beyond {bar:.0e}")
