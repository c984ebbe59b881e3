"""vibeam: how much model does a vibro-impact beam need?

The public names, loaded when first used: ``import vibeam`` itself loads no scipy, matplotlib, numba or pint.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

_HOMES = {
    "load": "vibeam.case",
    "run": "vibeam.run",
    "derive": "vibeam.derive",
    "ImpactSystem": "vibeam.system",
    "Drive": "vibeam.system",
    "State": "vibeam.state",
    "simulate": "vibeam.simulate",
    "sweep": "vibeam.sweep",
    "Ended": "vibeam.response",
    "FrequencyResponse": "vibeam.response",
}

__all__ = ["__version__", *sorted(_HOMES)]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'vibeam' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return list(__all__)
