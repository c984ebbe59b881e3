"""Write ``laser.csv``: the neutral rig's up-sweep with noise, in the form of a spreadsheet. No measurement.

The rig that is "measured" is not the one of the case: thinner by 0.5 %, R₁ 0.70 for 0.72, so that the curve is shifted
and lower. Amplitudes have normal noise of 1 % (seed 19), frequencies are off the case's grid.

    python cases/synthetic/make_laser.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import vibeam

HERE = Path(__file__).parent
FREQUENCIES = np.arange(14.013, 17.0, 0.0731)
CHANGES = {"beam.thickness": "1.02883 mm", "stop.restitution": 0.70}
SPREAD, SEED = 0.01, 19


def text() -> str:
    """The file: a preamble, heads with units, semicolons, decimal commas."""
    case = vibeam.load(
        HERE.parent / "dtu_neutral.toml",
        set=CHANGES | {"sweep.frequency": FREQUENCIES.round(4).tolist(), "sweep.direction": "up"},
    )
    curve = vibeam.run(case, show=False)["beam"].up
    measured = curve.amplitude * (1 + SPREAD * np.random.default_rng(SEED).standard_normal(len(curve)))
    lines = ["Synthetic data: vibeam's 8-mode model, changed, with 1 % noise; no measurement", "Kanal 1: Laser;;;", ""]
    lines += ["Frequenz [Hz];Weg [mm];Unsicherheit [mm];Bemerkung"]
    for frequency, value in zip(curve.frequency, measured, strict=True):
        lines.append(f"{frequency:.4f};{1e3 * value:.5f};{1e3 * SPREAD * value:.5f};".replace(".", ","))
    return "\r\n".join(lines) + "\r\n"


if __name__ == "__main__":
    (HERE / "laser.csv").write_bytes(text().encode("cp1252"))
