"""Why is my gradient wrong through an impact?

Because the time of the impact moves with the state. A program that differentiates its steps holds that time fixed, and
leaves out how much longer the motion before the impact lasts, and how much shorter the one after it.

An oscillator strikes its stop once a period and keeps 0.5 of its velocity. How its place one period later depends on
its place now: −1.5532, by differences of exact motions. With the impact time held fixed the chain rule says 0.5875:
wrong in sign. The stability turns with it: the largest multiplier is −2.687, the motion is unstable and its period
doubles; the fixed time says −0.739, stable. One more entry in the matrix of the jump, the saltation matrix, makes it
right to 9 digits.

vibeam has the jump for every contact law in its [tangent maps](../../vibeam/flight/README.md#tangent-maps): fits,
continuation and stability rest on it. Asked in
[SciMLSensitivity.jl#1447](https://github.com/SciML/SciMLSensitivity.jl/issues/1447),
[SciMLSensitivity.jl#4](https://github.com/SciML/SciMLSensitivity.jl/issues/4) and
[AMICI#1539](https://github.com/AMICI-dev/AMICI/pull/1539).
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.linalg import expm

import vibeam

restitution, zeta, drive = 0.5, 0.05, vibeam.Drive(omega=2.9, amplitude=0.1)
print(f"restitution: {restitution}")
system = vibeam.ImpactSystem.from_modes(1.0, zeta, 1.0, 1.0, restitution=restitution)
[orbit] = vibeam.orbits(system, drive)
begin, end = orbit.time + orbit.span / 2, orbit.time + 3 * orbit.span / 2
state = orbit.path().modes_at(begin)[:, 0]


def after(state):
    """Displacement and velocity one drive period later."""
    path = vibeam.simulate(system, drive, end, vibeam.State(state[:1], state[1:]), t_start=begin)
    return path.modes_at(end)[:, 0]


step = 1e-6
flown = np.transpose([(after(state + each) - after(state - each)) / (2 * step) for each in step * np.eye(2)])

impact, velocity = orbit.times[0] + orbit.span, orbit.velocities[0]
push = system.load[0] * drive.load_at(impact)
to, away = push - 2 * zeta * velocity, push + 2 * zeta * restitution * velocity  # accelerations at the stop
fixed = np.array([[1.0, 0.0], [0.0, -restitution]])
moving = np.array([[-restitution, 0.0], [(away + restitution * to) / velocity, -restitution]])
flow = np.array([[0.0, 1.0], [-1.0, -2 * zeta]])
by = {name: expm(flow * (end - impact)) @ jump @ expm(flow * (impact - begin)) for name, jump in
      (("impact time fixed", fixed), ("impact time moving", moving))}  # fmt: skip

for name, jacobian in {"flown": flown, **by}.items():
    largest = max(np.linalg.eigvals(jacobian), key=abs)
    print(f"{name}: place by place {jacobian[0, 0]:.4f}, largest multiplier {largest:.3f}")
same = np.allclose(by["impact time moving"], flown, rtol=1e-9, atol=1e-9)
print(f"moving and flown: equal to 9 digits {same}")

figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
moved = np.linspace(-0.02, 0.02, 81)
places = np.array([after(state + np.array([each, 0]))[0] for each in moved]) - after(state)[0]
axes.plot(1e3 * moved, 1e3 * places, label="flown")
for name, style in (("impact time fixed", "--"), ("impact time moving", ":")):
    axes.plot(1e3 * moved, 1e3 * by[name][0, 0] * moved, style, label=f"gradient, {name}")
axes.set(xlabel="change of the place now [mm]", ylabel="of the place a period later [mm]", title="Through one impact")
axes.legend()
figure.savefig("gradients.png", dpi=150)
