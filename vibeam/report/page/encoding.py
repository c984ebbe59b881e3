"""Numbers of the page: few digits as JSON, long arrays as 16-bit integers in base64."""

from __future__ import annotations

import json
from base64 import b64encode
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

STEPS = 65535  # of an array's range


def rounded(values: ArrayLike, digits: int = 6) -> list[float | None]:
    """Numbers with so many significant digits; None for what is not finite."""
    return [float(f"{each:.{digits}g}") if np.isfinite(each) else None for each in np.ravel(np.asarray(values, float))]


def packed(values: ArrayLike) -> dict[str, Any]:
    """An array of finite numbers in steps of 1/65535 of its range: value = low + step · integer."""
    flat: NDArray[np.float64] = np.ravel(np.asarray(values, dtype=float))
    low = float(flat.min(initial=np.inf)) if len(flat) else 0.0
    step = (float(flat.max()) - low) / STEPS if len(flat) else 0.0
    whole = np.rint((flat - low) / step if step > 0 else 0 * flat).astype("<u2")
    return {"low": low, "step": step, "data": b64encode(whole.tobytes()).decode()}


def as_json(values: Any) -> str:
    """JSON that may stand in a script element of a page, whatever texts it holds."""
    text = json.dumps(values, allow_nan=False, separators=(",", ":"), ensure_ascii=False)
    return text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e").replace("\u2028", "\\u2028")
