"""Studies of a case: regression, cost, influence, stability, derived parameters, modes.

Its public names are listed in ``__init__.pyi``.
"""

from __future__ import annotations

from vibeam.system.public_names import namespace

namespace(__name__, __file__)
