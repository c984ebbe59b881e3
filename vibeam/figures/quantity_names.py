"""Names of what an output reads and of its rate, in labels, titles and long names."""

from __future__ import annotations

from vibeam_models.outputs import DISPLACEMENT

#: what the rate of an output's quantity is called
RATES = {
    "displacement": "velocity",
    "velocity": "acceleration",
    "acceleration": "jerk",
    "slope": "rate",
    "strain": "rate",
}


def named_of(text: str, quantity: str) -> str:
    """Text about ``displacement`` and ``velocity``, made one about another quantity and its rate."""
    if quantity == DISPLACEMENT.name:
        return text
    return text.replace("velocity", RATES[quantity]).replace("displacement", quantity)
