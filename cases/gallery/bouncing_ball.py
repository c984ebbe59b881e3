"""Why does my bouncing ball fall through the floor?

Because it bounces infinitely often in a finite time. Event after event comes closer to the last, until two of them lie
within the tolerance of the clock. Then one of two things happens, and the last digits decide which. Either an event is
missed: from then on the ball is below the floor, where the event that would have stopped it is behind it, and it falls.
Or the same event is found again and again, and the time stands still.

A ball dropped from 1 m that keeps 0.5 of its velocity is at rest after 1.354571 s, by the geometric series of its
free flights. `solve_ivp` from event to event, with a tolerance of 1e-10, never has it at rest after 3 s: within
200 impacts it has missed one, or its time stands still. vibeam computes 20 impacts one by one, sums the rest of the
series with a bound of what it leaves out, and keeps the ball on the floor from 1.354571 s on.

Permanent contact then ends where the contact force vanishes, not before: on a table that shakes it at 2 Hz with 1.2 g
the ball comes to rest in each of 20 periods, and is thrown up again each time when the table falls faster than it.

[Chatter and rest](../../vibeam/flight/README.md#how-it-is-computed). Asked in
[OpenModelica#4229](https://github.com/OpenModelica/OpenModelica/issues/4229) and
[ModelingToolkit.jl#4822](https://github.com/SciML/ModelingToolkit.jl/issues/4822): "one impact is fine permanent
contact is not".
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import solve_ivp

import vibeam

gravity, height, restitution, end = 9.81, 1.0, 0.5, 3.0
print(f"dropped from: {height:.0f} m, restitution {restitution}, for {end:.0f} s")
ball = vibeam.ImpactSystem.from_modes(0.0, 0.0, 1.0, 1.0, static=gravity, restitution=restitution)  # downwards
path = vibeam.simulate(ball, vibeam.Drive(1.0, 0.0), end, vibeam.State([-height], [0.0]), certify=True)
series = np.sqrt(2 * height / gravity) * (1 + restitution) / (1 - restitution)
print(f"at rest: after {path.rests[0, 0]:.9f} s, by the series after {series:.9f} s")
print(f"computed one by one: {len(path.impact_times)} impacts")


def above(t, y):
    """Height above the floor."""
    return y[0]


above.terminal, above.direction = True, -1
tolerance, most, t, y, parts = 1e-10, 200, 0.0, [height, 0.0], []
accurate = {"rtol": tolerance, "atol": 1e-12, "dense_output": True}
for _ in range(most):
    part = solve_ivp(lambda t, y: [y[1], -gravity], (t, end), y, events=above, **accurate)
    instants = np.linspace(t, part.t[-1], 100)
    parts.append((instants, part.sol(instants)[0]))
    t, y = part.t[-1], [part.y[0, -1], part.y[1, -1] * (-restitution if part.status else 1)]
    if t >= end:
        break
outcome = "falls through the floor" if t >= end else f"stands still at {t:.6f} s"
print(f"solve_ivp with tolerance: {tolerance:.0e}, within {most} impacts: {outcome}")

omega = 2 * np.pi * 2
table = vibeam.simulate(ball, vibeam.Drive(omega, 1.2 * gravity / omega**2), 12.0, vibeam.State([-height], [0.0]))
print(f"on a table: {omega / (2 * np.pi):.0f} Hz, {1.2} g, the ball comes to rest in {len(table.rests)} periods")

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
instants = np.linspace(0, end, 4001)
left.plot(instants, -path.at(instants), label="vibeam")
left.plot(*np.hstack(parts), "--", label="solve_ivp")
left.set(xlabel="time [s]", ylabel="height [m]", ylim=(-1, 1.05), title="Dropped on the floor")
left.legend()
instants = np.linspace(9, 12, 4001)
right.plot(instants, -1e3 * table.at(instants))
right.set(xlabel="time [s]", ylabel="height above the table [mm]", title="On a table, 2 Hz, 1.2 g")
figure.savefig("bouncing_ball.png", dpi=150)
