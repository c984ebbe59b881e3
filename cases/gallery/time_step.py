"""How small must my time step be at a stop?

Several times smaller than without the stop, because an impact is met no closer than a step.

A beam at 15.3 Hz by Moreau's time stepping, the scheme of choice for rigid contact: without its stop 20 steps a period
are 1.0 % off. At the stop they are 25 % off, 50 steps 3.3 %; it takes 100 steps for 1.0 % and 500 steps for 0.1 %.
Where further modes ring, their period counts, not the drive's. Halving the step is the only test that such a scheme has
of itself.

A motion in closed form has no step: the amplitude is 0.3943 mm, by exact flights and by the formula for periodic
motions, the same to 12 digits.

[Solvers and what they cost](../../vibeam/solvers/README.md), and `vibeam verdict CASE --only solvers` for your case.
Asked in [ross#1156](https://github.com/petrobras/ross/pull/1156), where rubbing changed with the integrator, and
[jiminy#36](https://github.com/duburcqa/jiminy/issues/36).
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import vibeam

hertz = 15.3
case = vibeam.load(Path(__file__).parents[1] / "dtu_neutral.toml")
system, drive = case.system("sdof"), vibeam.Drive(2 * np.pi * hertz, case.base_amplitude)
[orbit] = [each for each in vibeam.orbits(system, drive) if each.stable]
exact = orbit.amplitude("sensor")
flown = vibeam.sweep(system, omega=[drive.omega], amplitude=drive.amplitude, output="sensor").amplitude[0]
print(f"exact at: {hertz} Hz, {1e3 * exact:.6f} mm, flown too to 12 digits: {abs(flown / exact - 1) < 1e-12}")
(omega,), (zeta,), (contact,), (load,) = system.omega, system.zeta, system.contact, system.load


def moreau(steps, gap=system.gap, periods=60, kept=5):
    """Amplitude by Moreau's time stepping, ``steps`` a period: midpoint rule, Newton's law for the velocities."""
    h = orbit.span / steps
    pushes = load * drive.load_at(h * (np.arange(steps) + 0.5))
    inertia = 1 + h * zeta * omega + (h * omega / 2) ** 2
    q, v, seen = 0.0, 0.0, []
    for period in range(periods):
        for push in pushes:
            new = v + h * (push - 2 * zeta * omega * v - omega**2 * (q + h / 2 * v)) / inertia
            if contact * (q + h / 2 * v) >= gap and contact * (new + system.restitution * v) > 0:
                new = -system.restitution * v
            q, v = q + h / 2 * (v + new), new
            if period >= periods - kept:
                seen.append(system.outputs["sensor"][0] * q)
    return (max(seen) - min(seen)) / 2


forced = load * drive.omega**2 * drive.amplitude * system.outputs["sensor"][0]
free = forced / abs(omega**2 - drive.omega**2 + 2j * zeta * omega * drive.omega)
print(f"without the stop: 20 steps a period, amplitude off by {100 * (moreau(20, np.inf, 200) / free - 1):.2f} %")
counts = np.array([20, 50, 100, 200, 500, 1000])
off = np.array([100 * (moreau(steps) / exact - 1) for steps in counts])
for steps, each in zip(counts, off, strict=True):
    print(f"Moreau: {steps} steps a period, amplitude off by {each:.2f} %")

figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
axes.loglog(counts, abs(off), "o-", label="Moreau's time stepping")
axes.loglog(counts, 100 / counts, ":", color="0.4", label="one over the steps")
axes.set(xlabel="steps a drive period", ylabel="error of the amplitude [%]", title=f"A beam at its stop, {hertz} Hz")
axes.legend()
figure.savefig("time_step.png", dpi=150)
