"""Why does scipy miss two of three impacts?

`solve_ivp` compares the sign of the event at both ends of a step. Of a gap that closes and opens again within one step
the signs tell nothing; of one that closes, opens and closes they tell one root.

The cubic of the first thread below has 3 roots, at −6, −2 and 2; `solve_ivp` finds 1 root. A beam at its stop, driven
at 19 Hz, has 13 impacts in the first second. With its default tolerance, 1e-03, `solve_ivp` finds 5 impacts, goes
0.02 mm through the stop unseen, and flies on in another motion. With 1e-09 it finds 13 impacts too, here: a tolerance
bounds the error of a step, not what happens within it.

vibeam's motion is a closed form from impact to impact, and a piece of it is left behind only where a bound proves that
the gap stays open in it. `certify=True` hands out that proof, to be checked by a
[second program](../../tests/independent/README.md): [what a certificate
proves](../../vibeam/flight/README.md#what-a-certificate-proves). Asked in
[scipy#9228](https://github.com/scipy/scipy/issues/9228), [CyRK#98](https://github.com/jrenaud90/CyRK/issues/98) and
[diffrax#507](https://github.com/patrick-kidger/diffrax/issues/507).
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import solve_ivp

import vibeam
from vibeam_models.laws.compliant import LinearStop

found = solve_ivp(lambda t, y: 3 * t**2 + 12 * t - 4, (-8, 4), [-120.0], events=lambda t, y: y[0])
print(f"of the cubic solve_ivp finds: {len(found.t_events[0])} root")

free = vibeam.ImpactSystem.from_modes(0.0, 0.0, 1.0, 1.0, gap=0.0, law=LinearStop(1e-12))  # 1 kg, hardly held
force = vibeam.Record([0.0, 12.0], [[-36.0, 6.0, 0.0, 0.0]], "force")  # second derivative of the cubic, N
entered, lasted = vibeam.simulate(free, force, 12.0, vibeam.State([-120.0], [92.0])).contacts[:, :2].T
roots = sorted({*entered - 8, *(entered + lasted - 8)} - {4.0})
print(f"of the cubic vibeam finds: {len(roots)} roots, at {', '.join(f'{root:.4g}' for root in roots)}")

case = vibeam.load(Path(__file__).parents[1] / "dtu_loose.toml")
system, drive = case.system("sdof"), vibeam.Drive(2 * np.pi * 19, case.base_amplitude)
sure = vibeam.simulate(system, drive, 1.0, certify=True)
print(f"driven at: 19 Hz, {len(sure.impact_times)} impacts in a second, proof complete {sure.certificate.complete}")


def flow(t, y):
    """Rate of displacement and velocity of the mode."""
    held = 2 * system.zeta[0] * system.omega[0] * y[1] + system.omega[0] ** 2 * y[0]
    return [y[1], system.load[0] * drive.load_at(t) - held]


def beyond(t, y):
    """Displacement beyond the stop."""
    return y[0] * system.contact[0] - system.gap


beyond.terminal, beyond.direction = True, 1
figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
for rtol in (1e-9, 1e-3):
    t, y, impacts, times, places = 0.0, np.zeros(2), 0, [], []
    for _ in range(100):
        part = solve_ivp(flow, (t, 1.0), y, events=beyond, rtol=rtol, atol=1e-3 * rtol, dense_output=True)
        times.append(np.linspace(t, part.t[-1], 200))
        places.append(part.sol(times[-1])[0] * system.contact[0])
        t, y = part.t[-1], part.y[:, -1] * [1, -system.restitution]
        impacts += part.status
        if t >= 1.0:
            break
    deepest = 1e3 * (np.max(np.hstack(places)) - system.gap)
    print(f"solve_ivp with tolerance: {rtol:.0e}, {impacts} impacts, {deepest:.2f} mm through the stop")

instants = np.linspace(0, 1, 4001)
axes.plot(instants, 1e3 * sure.at(instants), label="exact", lw=1)
axes.plot(np.hstack(times), 1e3 * np.hstack(places), label="solve_ivp, default tolerance", lw=1)
axes.axhline(1e3 * system.gap, color="0.3", lw=1, label="stop")
axes.set(xlabel="time [s]", ylabel="contact point [mm]", title="A beam at its stop, 19 Hz", xlim=(0, 0.6))
axes.legend(loc="lower right")
figure.savefig("missed_impacts.png", dpi=150)
