"""Exploration of a case: the page in which its exact engine flies, as a file or in a notebook."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from html import escape
from os import PathLike
from pathlib import Path

from vibeam.case.case import Case
from vibeam.case.source import of_source
from vibeam.exchange.whole_files import write_whole

HEIGHT = 1000  # px of a page in a notebook
SANDBOX = "allow-scripts allow-downloads"  # nothing else: no request, nothing of the notebook


@dataclass(frozen=True)
class Exploration:
    """Page of a case as one ``html`` text; the fidelities that are ``flown`` in it, and why others are ``refused``.

    A notebook shows it as a frame of ``height`` px.
    """

    html: str = field(repr=False)
    title: str
    flown: tuple[str, ...]
    refused: Mapping[str, str]
    height: int = HEIGHT

    def write(self, path: str | PathLike[str]) -> Path:
        """Write the page, and give its path."""
        write_whole(Path(path), self.html.encode())
        return Path(path)

    def _repr_html_(self) -> str:
        style = f"width: 100%; height: {self.height}px; border: 0"
        head = f'<iframe title="{escape(self.title)}" sandbox="{SANDBOX}" style="{style}"'
        return f'{head} srcdoc="{escape(self.html)}"></iframe>'


@of_source
def explore(case: Case, height: int = HEIGHT) -> Exploration:
    """Fly a case in a page as its sliders move: in a notebook, ``height`` px high, or in the file that ``write`` makes.

    ``case``: or its file, or its tables. The page holds the compiled kernels and needs neither a server nor a network.
    CaseError where the case cannot be run, ValueError where a page can fly none of its fidelities, KernelsUnavailable
    where the kernels of pages are missing.

    >>> import vibeam
    >>> page = vibeam.explore("cases/dtu_neutral.toml")
    >>> page.flown, page.write("dtu_neutral_explore.html").name
    (('sdof', 'two_modes', 'beam'), 'dtu_neutral_explore.html')
    """
    return exploration(case, height)


def exploration(case: Case, height: int = HEIGHT) -> Exploration:
    """As ``explore``, of a case."""
    from vibeam.extensions.explore.page import explore_page
    from vibeam.extensions.explore.payload import payload
    from vibeam.runs.systems import require_runnable

    require_runnable(case)
    made = payload(case)
    refused = {each["name"]: str(each["refusal"]) for each in made["models"] if not each["engine"]}
    if len(refused) == len(case.fidelities):
        told = "\n".join(f"{name}: {why}" for name, why in refused.items())
        raise ValueError(f"no fidelity of this case can be flown in a page; vibeam run sweeps it:\n{told}")
    flown = tuple(name for name in case.fidelities if name not in refused)
    return Exploration(explore_page(case, made), case.title, flown, refused, height)
