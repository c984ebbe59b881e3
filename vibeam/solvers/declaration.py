"""Declaration of a solver: everything that the case file, the sweep, the studies and the figures know of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from inspect import Parameter, signature
from typing import Any, Literal

from vibeam_models.registry import loaded

GIVEN = ("system", "slowest", "span")  # arguments of every solver


@dataclass(frozen=True)
class CostSettings:
    """Settings for a cost study: named options, or methods at falling tolerances, or numbers of steps.

    ``limit``: events, or evaluations, a drive period after which a solver with tolerances stops.

    >>> import vibeam
    >>> settings = vibeam.CostSettings({"coarse": {"steps": 50}, "fine": {"steps": 500}})
    >>> list(vibeam.SolverDeclaration("mine", "mine.solver:Solver", settings=settings).settings.options)
    ['coarse', 'fine']
    """

    options: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    methods: tuple[str, ...] = ()
    limit: int = 0
    steps: bool = False


@dataclass(frozen=True)
class SolverDeclaration:
    """Declaration of a solver: its name in a case file, its class, its capabilities.

    ``home``: the class ``made as Class(system, slowest, span, **options)``, or ``"module:Class"``, imported when it is
    asked for. ``beyond_plain``: the same for systems with another contact law, coupled damping or a second stop; None
    where the solver cannot take them; ``several``: the same for systems with contacts in several places.
    ``stationary``: steady motions by formula, nothing settles. ``motion``:
    ``"exact"`` trajectories by ``simulate``, ``"samples"`` by ``motion``, or ``"none"`` beyond steady points.
    ``blocks``: ``steady`` takes an amplitude for each frequency, and a list ``states`` to which it adds the state after
    each point: a sweep then asks it for several points at once.
    ``derivatives``: it reads outputs that are velocities or accelerations, whose jumps it knows.
    ``curves``: it knows all motions of its kind, stable or not. ``harmonics``: it takes the light undamped modes of
    ``SeveralHarmonics``; ``records``: a ``Record``. ``gaps``: ``"module:function"`` (system, rad/s, drive periods) that
    gives by formula the gaps (points, 2) a metre of drive between which a motion exists, and the gap of the one mode.
    ``marker``: matplotlib's, and its size in points.

    >>> import vibeam
    >>> vibeam.SolverDeclaration("mine", "mine.solver:Solver", motion="samples").samples
    True
    """

    name: str
    home: str | type[Any]
    beyond_plain: str | type[Any] | None = None
    several: str | type[Any] | None = None
    stationary: bool = False
    motion: Literal["exact", "samples", "none"] = "none"
    blocks: bool = False
    derivatives: bool = False
    curves: bool = False
    harmonics: bool = False
    records: bool = False
    gaps: str = ""
    settings: CostSettings = field(default_factory=CostSettings)
    marker: tuple[str, float] = ("D", 4.5)

    @property
    def samples(self) -> bool:
        """True where its motion consists of samples and is not exact between impacts."""
        return self.motion == "samples"

    def make(self, system: Any, slowest: float, span: float, options: Mapping[str, Any]) -> Any:
        """Build the solver of one system; ValueError for what it cannot take."""
        made = loaded(self._home_of(system))
        known = _options_of(made) if options else ()
        unknown = [key for key in options if key not in known]
        if unknown:
            there = ", ".join(known) or "none"
            raise ValueError(f"solver {self.name!r} has no option {', '.join(unknown)}: there are {there}")
        return made(system, slowest, span, **options)

    def _home_of(self, system: Any) -> str | type[Any]:
        """The class for this kind of system; ValueError where there is none."""
        if not system.beyond_plain:
            return self.home
        found = self.beyond_plain if system.further is None else self.several
        if found is None:
            system.require_plain(f"solver {self.name!r}")
        return found or self.home


def _options_of(made: type[Any]) -> list[str]:
    """Options of a solver class, those passed on to its base class included."""
    parameters = signature(made).parameters
    handed_on = any(each.kind is Parameter.VAR_KEYWORD for each in parameters.values())
    own = [name for name, each in parameters.items() if each.kind is not Parameter.VAR_KEYWORD and name not in GIVEN]
    return own + (_options_of(made.__base__ or object) if handed_on else [])
