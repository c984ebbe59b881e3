"""One scene in Siconos: numbers in JSON on stdin, impacts and contact places in JSON on stdout. No vibeam here."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np


def run(told: dict) -> dict:
    """TimeStepping with MoreauJeanOSI (θ = ½), one one-sided contact with Newton's law; modes as coordinates."""
    import siconos.kernel as sk

    omega, zeta, contact, load, static = (np.array(told[k]) for k in ("omega", "zeta", "contact", "load", "static"))
    n, (drive, amplitude) = len(omega), told["drive"]
    q, v, begin = np.array(told["displacement"]), np.array(told["velocity"]), told["begin"]
    rates = [drive] if drive > 0 else [*omega[omega > 0], np.inf]
    cycle = 2 * np.pi / min(rates) if np.isfinite(min(rates)) else 1.0
    impacts, places = [], []
    for end in told["pieces"]:
        count = max(1, int(np.ceil((end - begin) / (cycle / told["steps"]) - 1e-9)))
        h = (end - begin) / count
        body = sk.LagrangianLinearTIDS(q, v, np.eye(n), np.diag(omega**2), np.diag(2 * zeta * omega))

        stop = sk.Interaction(
            sk.NewtonImpactNSL(told["restitution"]), sk.LagrangianLinearTIR(-contact[None, :], [told["gap"]])
        )
        world = sk.NonSmoothDynamicalSystem(begin, end + h)
        world.insertDynamicalSystem(body)
        world.link(stop, body)
        march = sk.TimeStepping(world, sk.TimeDiscretisation(begin, h), sk.MoreauJeanOSI(0.5), sk.LCP())
        for k in range(count):
            sines = np.sin(drive * (begin + h * np.array([k, k + 1])))
            body.setFExtPtr(load * (drive**2 * amplitude) * sines.mean() + static)  # copied: so at every step
            before = float(contact @ body.velocity())
            march.computeOneStep()
            if stop.lambda_(1)[0] > 0 and before > 0:
                impacts.append((begin + h * (k + 1), before))
            march.nextStep()
            places.append(float(contact @ body.q()))
        q, v, begin = np.array(body.q()), np.array(body.velocity()), end
    return {"impacts": impacts, "places": places}


def installed() -> str:
    """Which Siconos there is; ImportError where there is none. Its module tells no version: Debian's package does."""
    import siconos.kernel  # noqa: F401

    try:
        told = subprocess.run(
            ["dpkg-query", "-W", "-f", "${Version}", "python3-siconos"], capture_output=True, text=True, check=True
        )
    except (OSError, subprocess.CalledProcessError):
        return "version not told"
    return told.stdout.strip()


if __name__ == "__main__":
    if "--version" in sys.argv:
        try:
            print(installed())
        except ImportError as error:
            sys.exit(f"no Siconos here: {error}")
    else:
        print(json.dumps(run(json.load(sys.stdin))))
