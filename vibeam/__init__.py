"""vibeam: how much model does a vibro-impact beam need?

The public names, loaded when first used: ``import vibeam`` itself loads no scipy, matplotlib or numba, nor anything
that the interpreter has not loaded before it runs a module. They are listed in ``__init__.pyi``.
"""

from __future__ import annotations

from importlib import import_module

from vibeam.system.public_names import from_home, hand_in, homes_of

__version__ = "0.1.0"
_HOMES = homes_of(__file__)
_OF_A_CASE = (
    *("run", "modes", "cost", "fit", "limit", "stability", "uncertainty", "influence", "verdict", "reduce", "derive"),
    *("check", "compare_measured", "identify_keys", "evaluate", "run_map"),
)  # which take the case's file, or its tables, as well
__all__ = sorted((*_HOMES, "__version__"))


def __getattr__(name: str) -> object:
    value = from_home(_HOMES, __name__, name)
    if name in _OF_A_CASE:
        value = import_module("vibeam.casefile.by_file").loading(value, __name__)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__


hand_in("plot", lambda: __getattr__("plot"))
