"""Physics of the wire, imported where a case asks for it."""

from dataclasses import dataclass, replace

from vibeam.casefile.tables.table import plan_of
from vibeam.figures.sheet import Column, Sheet
from vibeam.report.output import StudySheet
from wire.plans import Wire


def scene(case, folder, beam):
    return replace(beam, effects=(*beam.effects, plan_of(Wire, case.wire)))


@dataclass(frozen=True)
class Row:
    omega: float


def wires(case):
    return [Row(float(case.model("held").at({"wire.stiffness": case.asked["wires"].most}).system().omega[0]))]


def sheets(case, fidelity, plan):
    omega = Column(case.system(fidelity).omega, "rad/s", "natural frequency")
    return [Sheet(fidelity, plan.frequency[0], {"omega": omega})]


def draw(figure, result, plan, shown):
    figure.subplots().plot(shown[0]["omega"], "o")


def section(stored):
    return StudySheet(f"Wires up to {stored.result.case.asked['wires'].most:g} N/m hold the beam.")
