"""Write the files of this folder: a decay, a hammer test and the record of a shaker table. No measurements.

All are closed forms of three modes of a reed with normal noise (seed 48), in the forms of LabVIEW and of a spreadsheet:

- decay: x = Σ a_k e^(−ζ_k ω_k t) cos(√(1 − ζ_k²) ω_k t) after 40 ms at rest, displacement in mm
- hammer test: accelerance H = s² Σ φ_k φ_k(hammer)/(s² + 2 ζ_k ω_k s + ω_k²), s = iω, at two points, in g/N
- table: two half-sines of 8 ms, in m/s²

    python cases/measured/make_files.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
FREQUENCY, RATIO = np.array([42.0, 263.0, 737.0]), np.array([0.012, 0.006, 0.008])
CONTACT, TIP = np.array([9.0, -4.0, 1.5]), np.array([12.0, -11.0, 10.0])  # mass-normalised shapes, 1/√kg
GRAVITY = 9.80665
NOISE = np.random.default_rng(48)

HEAD = """LabVIEW Measurement\t
Writer_Version\t2
Separator\tTab
Decimal_Separator\t{decimal}
Multi_Headings\tNo
X_Columns\tNo
***End_of_Header***\t
\t
Channels\t1\t
Samples\t{samples}\t
Date\t2026/03/02\t
Time\t10:21:33,1250000\t
Y_Unit_Label\t{unit}\t
X_Dimension\tTime\t
X0\t{start}\t
Delta_X\t{step}\t
***End_of_Header***\t\t
X_Value\t{head}\tComment
"""


def lvm(head: str, unit: str, values: np.ndarray, step: str, start: str, decimal: str) -> str:
    """Text of a LabVIEW file whose times stand in its head alone."""
    said = HEAD.format(head=head, unit=unit, samples=len(values), step=step, start=start, decimal=decimal)
    return said + "".join(f"\t{each:.5f}\n".replace(".", decimal) for each in values)


def decay() -> str:
    """Tip displacement of the reed, released from 1 mm in its first mode after 40 ms at rest."""
    t = np.arange(1500) / 2000 - 0.04
    omega = 2 * np.pi * FREQUENCY[0]
    moved = np.exp(-RATIO[0] * omega * t) * np.cos(np.sqrt(1 - RATIO[0] ** 2) * omega * t)
    values = np.where(t < 0, 0.0, moved) + 0.004 * NOISE.standard_normal(len(t))
    return lvm("Laser", "mm", values, "5.000000E-4", "-4.000000E-2", ".")


def hammer() -> str:
    """Accelerances at contact and tip, struck at the contact, with a row of units below the heads."""
    f = np.geomspace(20.0, 1000.0, 300).round(3)
    s = 2j * np.pi * f[:, None]
    poles = s**2 + 2 * RATIO * 2 * np.pi * FREQUENCY * s + (2 * np.pi * FREQUENCY) ** 2
    columns = [f]
    for shape in (CONTACT, TIP):
        exact = (s**2 * shape * CONTACT / poles).sum(axis=1) / GRAVITY
        noise = NOISE.standard_normal((2, len(f)))
        measured = exact * (1 + 0.01 * noise[0]) + 0.01j * exact * noise[1]
        columns += [measured.real, measured.imag]
    heads = "Frequency,Contact Re,Contact Im,Tip Re,Tip Im\nHz,g/N,g/N,g/N,g/N\n"
    return "Hammer test of a reed, struck at the contact\n" + heads + "".join(
        ",".join([f"{row[0]:.3f}", *(f"{each:.6g}" for each in row[1:])]) + "\n" for row in np.transpose(columns)
    )  # fmt: skip


def table() -> str:
    """Acceleration of the table: two half-sines of 8 ms, by a recorder whose clock began long before."""
    t = np.arange(800) / 2000
    pulse = sum(np.where((t > at) & (t < at + 8e-3), np.sin(np.pi * (t - at) / 8e-3), 0.0) for at in (0.05, 0.2))
    return lvm("Table", "m/s^2", 30.0 * pulse, "5,000000E-4", "9,000000E+3", ",")


if __name__ == "__main__":
    for name, made in (("decay.lvm", decay()), ("hammer.csv", hammer()), ("table.lvm", table())):
        (HERE / name).write_text(made, encoding="utf-8", newline="\n")
