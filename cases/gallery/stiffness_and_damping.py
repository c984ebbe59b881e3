"""Why does my contact model need k and c?

Because it is integrated, not because of the impact: a contact that is short beside the drive period acts by its
restitution alone. A motion that is exact between impacts takes R and needs neither k nor c.

Where there must be a spring and a damper, c follows from R and k. The handbook's formula is that of a bound damper,
which may pull. A stop only pushes, lets go earlier, and gives back more: for a restitution of 0.6 the handbook has a
damping ratio of 0.1605, with which a stop gives back 0.632. `LinearStop.matched(k, R, mass)` has the right one, 0.1809.

k is then a question of time alone. For 0.2 kg under 15 Hz the amplitude is 39 % too small with 10 N/mm, where the
contact lasts 12.6 ms, 5.6 % too large with 1 000 N/mm and 1.26 ms, and 0.8 % too large with 100 000 N/mm and 0.126 ms:
the error falls as the contact gets shorter, and the time step of an integrator with it.

[Contact laws](../../models/README.md), [contact time of a case](../../vibeam/studies/README.md). Asked in
[mujoco#2080](https://github.com/google-deepmind/mujoco/issues/2080),
[mujoco#1741](https://github.com/google-deepmind/mujoco/issues/1741) and
[ModelicaBook#487](https://github.com/mtiller/ModelicaBook/issues/487).
"""

import dataclasses

import matplotlib.pyplot as plt
import numpy as np

import vibeam
from vibeam_models.laws.compliant import LinearStop, contact_damping_ratio, linear_restitution

wanted, mass, hertz = 0.6, 0.2, 15.0
bound = -np.log(wanted) / np.hypot(np.pi, np.log(wanted))
print(f"restitution: {wanted}, mass {mass} kg, drive {hertz:.0f} Hz")
print(f"damping ratio by the handbook: {bound:.4f}, with which the stop gives back {linear_restitution(bound):.4f}")
print(f"damping ratio of a stop that only pushes: {contact_damping_ratio(wanted):.4f}")

rigid = vibeam.ImpactSystem.from_modes(2 * np.pi * 7.6, 0.017, mass**-0.5, mass**0.5, gap=0.0, restitution=wanted)
drive = vibeam.Drive(omega=2 * np.pi * hertz, amplitude=1e-4)
[exact] = [orbit for orbit in vibeam.orbits(rigid, drive) if orbit.stable]

stiffnesses, lasts, off = np.geomspace(1e4, 1e9, 11), [], []
for stiffness in stiffnesses:
    law = LinearStop.matched(stiffness, wanted, mass)
    [orbit] = vibeam.orbits(dataclasses.replace(rigid, law=law), drive, start=exact)
    lasts.append(law.free_impact(mass, orbit.velocity).duration)
    off.append(100 * (orbit.amplitude("contact") / exact.amplitude("contact") - 1))
    given = f"{stiffness / 1e3:.0f} N/mm and {law.damping:.0f} N s/m"
    print(f"k and c: {given}, contact {1e3 * lasts[-1]:.3f} ms, amplitude off by {off[-1]:.2f} %")

figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
axes.loglog(stiffnesses, 100 * hertz * np.array(lasts), "o-", label="contact time, share of the drive period")
axes.loglog(stiffnesses, np.abs(off), "s-", label="amplitude, difference from the rigid stop")
axes.set(xlabel="stiffness of the stop [N/m]", ylabel="[%]", title=f"Stops that give back {wanted} of the velocity")
axes.legend()
figure.savefig("stiffness_and_damping.png", dpi=150)
