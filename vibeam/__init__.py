"""vibeam: how much model does a vibro-impact beam need?

The public names, loaded when first used: ``import vibeam`` itself loads no scipy, matplotlib or numba, nor anything
that the interpreter has not loaded before it runs a module. They are listed in ``__init__.pyi``, those of the rooms
``vibeam.periodic`` and ``vibeam.studies`` in theirs.
"""

from __future__ import annotations

from vibeam.system.public_names import hand_in, namespace

__version__ = "0.1.0"
namespace(__name__, __file__, "__version__")
hand_in(
    {
        "plot": "vibeam.report.figures:plot",
        "load": "vibeam.casefile.read:load",
        "bar": "vibeam.cli.progress:Bar",
        "html": "vibeam.report.page.notebook:html",
        "rows": "vibeam.report.views:rows",
    }
)
