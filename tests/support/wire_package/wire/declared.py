"""What it brings."""

from vibeam.casefile.kinds import ModelDeclaration
from vibeam.cli.declaration import Command
from vibeam.figures.declaration import FigureKind
from vibeam.report.declaration import PageSection, StudyDeclaration
from vibeam_models.registry import Home
from wire.plans import Wire, WiresPlan

MODEL = (ModelDeclaration("wire", "the beam with a wire", Wire, "wire.physics:scene"),)
KIND_OF_FIGURE = (FigureKind("stiffened", "wire.physics", "natural frequencies with the wire", takes=("frequency",)),)
PLAN_OF_A_STUDY = (Home("wires", WiresPlan),)
STUDY = (StudyDeclaration("wires", "wire.physics:wires", "frequencies under wires", asks=WiresPlan),)
COMMAND = (Command("wires", "From geometry", "Frequencies under wires.", STUDY[0]),)
SECTION_OF_A_PAGE = (PageSection("wires", "wire.physics:section"),)
