"""Is it chaos, or is it my solver?

Ask a number that a solver cannot invent: the mean rate at which near motions part. A positive largest Lyapunov exponent
is chaos; round-off then decides the motion after a while, in any solver, and only statistics of it mean something.

An oscillator that strikes a stop in its rest position and keeps 0.8 of its velocity is chaotic at 2.8 times its own
frequency: the exponent is 0.15 ± 0.01 a second. Motions begun 1e-9 m apart part by as much as they are wide within 200
periods, and the first 140 impacts are all that is more than round-off in it, whoever computes them. At 2.5 times its
own frequency it is regular, the exponent is −0.139, and all 200 impacts are right to the last digits.

Exponents at impacts need the jump of the [tangent map](../../vibeam/flight/README.md#tangent-maps); they are
[exact for every contact law](../../vibeam/periodic/README.md#lyapunov-exponents). Asked in
[DynamicalSystems.jl#14](https://github.com/JuliaDynamics/DynamicalSystems.jl/issues/14) and
[ChaosTools.jl#324](https://github.com/JuliaDynamics/ChaosTools.jl/issues/324).
"""

import matplotlib.pyplot as plt
import numpy as np

import vibeam

restitution, apart, periods = 0.8, 1e-9, 200
system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, gap=0.0, restitution=restitution)
print(f"restitution: {restitution}, starts {apart:.0e} m apart, {periods} periods")
figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
for omega, colour in ((2.5, "C0"), (2.8, "C1")):
    drive = vibeam.Drive(omega, amplitude=0.1)
    found = vibeam.lyapunov(system, drive, periods=2000)
    print(f"driven at: {omega} times its own frequency, exponent {found.largest:.3f} ± {found.errors[0]:.3f} a second")
    turns = np.linspace(0, periods, 6001)
    instants = turns * (2 * np.pi / omega)
    path, beside = (
        vibeam.simulate(system, drive, instants[-1], vibeam.State([-start], [0.0])) for start in (0.5, 0.5 + apart)
    )
    print(f"more than round-off, to tens: {round(path.errors.meaningful, -1)} impacts")
    distance = np.abs(path.at(instants) - beside.at(instants))
    axes.semilogy(turns, distance, color=colour, lw=0.8, label=f"driven at {omega} times its own frequency")
    axes.semilogy(turns, apart * np.exp(found.largest * instants), "--", color=colour, label="by the mean exponent")
axes.set(ylim=(1e-16, 10), xlabel="time [drive periods]", ylabel="distance [m]", title="Two motions begun 1e-9 m apart")
axes.legend(loc="center right")
figure.savefig("chaos.png", dpi=150)
