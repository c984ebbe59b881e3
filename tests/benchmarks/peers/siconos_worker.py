"""Run by the Python that has Siconos, apart from vibeam: a job on stdin as JSON, CPU seconds and motions on stdout.

A job: modes (omega, zeta, load, static), stops (row, gap, restitution), amplitude of the drive, and points: drive
frequency, start, begin, end, step. A motion: times and velocities of impacts, why it failed, state in the end, the
least and greatest place of the first stop's row. The drive is one more degree of freedom, s'' = −Ω²s with s = sin Ωt,
so that the whole system is linear with constant matrices and nothing is called back in Python between events.
"""

import json
import math
import os
import sys
import time

import numpy as np
import siconos.kernel as sk

NON_SMOOTH = 2  # type of an event at which an impact is solved


class Motion:
    """Everything there is at a point, and what is found; ``kept``: matrices, which Python must keep alive."""

    def __init__(self, job, point):
        n, omega, begin = len(job["omega"]), point["drive"], point["begin"]
        stiffness, damping = np.zeros((n + 1, n + 1)), np.zeros((n + 1, n + 1))
        stiffness[range(n), range(n)] = np.square(job["omega"])
        damping[range(n), range(n)] = 2 * np.multiply(job["zeta"], job["omega"])
        stiffness[:n, n] = -np.multiply(job["load"], job["amplitude"] * omega**2)
        stiffness[n, n] = omega**2
        place = point["start"][0] + [math.sin(omega * begin)]
        velocity = point["start"][1] + [omega * math.cos(omega * begin)]
        self.system = sk.LagrangianLinearTIDS(place, velocity, np.eye(n + 1))
        self.system.setKPtr(stiffness)
        self.system.setCPtr(damping)
        static = np.append(np.array(job["static"]), 0.0)
        if static.any():
            self.system.setFExtPtr(static)
        self.whole = sk.NonSmoothDynamicalSystem(begin, point["end"])
        self.whole.insertDynamicalSystem(self.system)
        self.stops, self.rows, self.kept = [], [], [stiffness, damping, static]
        for row, gap, restitution in job["stops"]:
            down = np.append(-np.array(row), 0.0).reshape(1, n + 1)
            relation = sk.LagrangianLinearTIR(down, np.array([gap]))
            self.stops.append(sk.Interaction(sk.NewtonImpactNSL(restitution), relation))
            self.whole.link(self.stops[-1], self.system)
            self.rows.append(np.array(row))
            self.kept.append(down)
        self.n, self.times, self.speeds, self.failed = n, [], [], ""
        self.least = self.greatest = float(self.rows[0] @ point["start"][0])

    def speeds_now(self):
        """Velocities toward the stops."""
        velocity = self.system.velocity()[: self.n]
        return [float(row @ velocity) for row in self.rows]

    def seen(self):
        """Note where the contact is."""
        place = float(self.rows[0] @ self.system.q()[: self.n])
        self.least, self.greatest = min(self.least, place), max(self.greatest, place)

    def answer(self):
        """As JSON takes it."""
        last = [self.system.q()[: self.n].tolist(), self.system.velocity()[: self.n].tolist()]
        return self.times, self.speeds, self.failed, last, self.least, self.greatest


def event_driven(job, point):
    """Flights by LSODAR with root finding, impacts by a complementarity problem."""
    motion = Motion(job, point)
    simulation = sk.EventDriven(motion.whole, sk.TimeDiscretisation(point["begin"], point["step"]))
    integrator = sk.LsodarOSI()
    simulation.insertIntegrator(integrator)
    simulation.insertNonSmoothProblem(sk.LCP(), sk.SICONOS_OSNSP_ED_IMPACT)
    simulation.insertNonSmoothProblem(sk.LCP(), sk.SICONOS_OSNSP_ED_SMOOTH_ACC)
    manager = simulation.eventsManager()
    simulation.initialize()
    integrator.setMaxNstep(100_000)
    if "tolerance" in job:
        simulation.setToleranceED(job["tolerance"])
    while simulation.hasNextEvent() and len(motion.times) < job["limit"]:
        try:
            simulation.advanceToEvent()
            if manager.nextEvent().getType() == NON_SMOOTH:
                motion.times.append(float(simulation.nextTime()))
                motion.speeds.append(max(motion.speeds_now()))
            simulation.processEvents()
            motion.seen()
        except Exception as error:
            motion.failed = str(error)
            return motion.answer()
    motion.failed = "stuck on the stop" if simulation.hasNextEvent() else ""
    return motion.answer()


def time_stepping(job, point):
    """Moreau–Jean, θ = ½; an impact is a step in which a stop pushes and its contact's velocity turns back."""
    motion = Motion(job, point)
    simulation = sk.TimeStepping(motion.whole, sk.TimeDiscretisation(point["begin"], point["step"]))
    simulation.insertIntegrator(sk.MoreauJeanOSI(0.5))
    simulation.insertNonSmoothProblem(sk.LCP())
    before = motion.speeds_now()
    while simulation.hasNextEvent():
        simulation.computeOneStep()
        for stop, speed in zip(motion.stops, before, strict=True):
            if speed > 0 and stop.lambda_(1)[0] > 0:
                motion.times.append(float(simulation.nextTime()))
                motion.speeds.append(speed)
        before = motion.speeds_now()
        motion.seen()
        simulation.nextStep()
    return motion.answer()


def main():
    """One job."""
    job = json.load(sys.stdin)
    answer = os.dup(1)
    os.dup2(2, 1)  # what the library prints is no part of the answer
    solve = {"event driven": event_driven, "time stepping": time_stepping}[job["method"]]
    begun = time.process_time()
    found = [solve(job, point) for point in job["points"]]
    seconds = time.process_time() - begun
    with os.fdopen(answer, "w") as out:
        json.dump({"seconds": seconds, "points": found}, out)


if __name__ == "__main__":
    main()
