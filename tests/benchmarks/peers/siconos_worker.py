"""Run by the Python that has Siconos, apart from vibeam: a job on stdin as JSON, CPU seconds and impacts on stdout.

The drive is one more degree of freedom, s'' = −Ω²s with s = sin Ωt, so that the whole system is linear with constant
matrices and nothing is called back in Python between events.
"""

import json
import os
import sys
import time

import numpy as np
import siconos.kernel as sk

NON_SMOOTH = 2  # type of an event at which an impact is solved


def parts(job, omega, start):
    """Everything there is, the moving part of it, and the matrices, which Python must keep alive."""
    n = len(job["omega"])
    stiffness, damping = np.zeros((n + 1, n + 1)), np.zeros((n + 1, n + 1))
    stiffness[range(n), range(n)] = np.square(job["omega"])
    damping[range(n), range(n)] = 2 * np.multiply(job["zeta"], job["omega"])
    stiffness[:n, n] = -np.multiply(job["load"], job["amplitude"] * omega**2)
    stiffness[n, n] = omega**2
    system = sk.LagrangianLinearTIDS(start[0] + [0.0], start[1] + [omega], np.eye(n + 1))
    system.setKPtr(stiffness)
    system.setCPtr(damping)
    end = job["periods"] * 2 * np.pi / omega
    whole = sk.NonSmoothDynamicalSystem(0.0, end)
    whole.insertDynamicalSystem(system)
    row = np.append(-np.array(job["contact"]), 0.0).reshape(1, n + 1)
    contact = sk.Interaction(
        sk.NewtonImpactNSL(job["restitution"]), sk.LagrangianLinearTIR(row, np.array([job["gap"]]))
    )
    whole.link(contact, system)
    return whole, system, (stiffness, damping, row)


def event_driven(job, omega, start):
    """Flights by LSODAR with root finding, impacts by a complementarity problem."""
    whole, system, _kept = parts(job, omega, start)
    simulation = sk.EventDriven(whole, sk.TimeDiscretisation(0.0, 2 * np.pi / omega))
    integrator = sk.LsodarOSI()
    simulation.insertIntegrator(integrator)
    simulation.insertNonSmoothProblem(sk.LCP(), sk.SICONOS_OSNSP_ED_IMPACT)
    simulation.insertNonSmoothProblem(sk.LCP(), sk.SICONOS_OSNSP_ED_SMOOTH_ACC)
    n, c, times, speeds = len(job["contact"]), np.array(job["contact"]), [], []
    manager = simulation.eventsManager()
    simulation.initialize()
    integrator.setMaxNstep(100_000)
    while simulation.hasNextEvent() and len(times) < job["limit"]:
        simulation.advanceToEvent()
        if manager.nextEvent().getType() == NON_SMOOTH:
            times.append(float(simulation.nextTime()))
            speeds.append(float(c @ system.velocity()[:n]))
        try:
            simulation.processEvents()
        except Exception as error:
            return times, speeds, str(error)
    return times, speeds, "stuck on the stop" if simulation.hasNextEvent() else ""


def time_stepping(job, omega, start):
    """Moreau–Jean, θ = ½; an impact is a step in which the contact's velocity turns back."""
    whole, system, _kept = parts(job, omega, start)
    step = 2 * np.pi / omega / job["steps"]
    simulation = sk.TimeStepping(whole, sk.TimeDiscretisation(0.0, step))
    simulation.insertIntegrator(sk.MoreauJeanOSI(0.5))
    simulation.insertNonSmoothProblem(sk.LCP())
    n, c, times, speeds = len(job["contact"]), np.array(job["contact"]), [], []
    before = float(c @ start[1])
    while simulation.hasNextEvent():
        simulation.computeOneStep()
        after = float(c @ system.velocity()[:n])
        if system.p(1) is not None and np.any(system.p(1) != 0.0) and before > 0:
            times.append(float(simulation.nextTime()))
            speeds.append(before)
        before = after
        simulation.nextStep()
    return times, speeds, ""


def main():
    """One job."""
    job = json.load(sys.stdin)
    answer = os.dup(1)
    os.dup2(2, 1)  # what the library prints is no part of the answer
    solve = {"event driven": event_driven, "time stepping": time_stepping}[job["method"]]
    begun = time.process_time()
    found = [solve(job, omega, start) for omega, start in zip(job["grid"], job["starts"], strict=True)]
    seconds = time.process_time() - begun
    with os.fdopen(answer, "w") as out:
        json.dump({"seconds": seconds, "points": found}, out)


if __name__ == "__main__":
    main()
