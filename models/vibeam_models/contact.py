"""Newton's law of restitution, and how its coefficient changes with the model: R does not carry over."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Restitution:
    """v⁺ = −R v⁻ at the contact, ``coefficient`` R in [0, 1] (ValueError outside)."""

    coefficient: float

    def __post_init__(self) -> None:
        if not 0 <= self.coefficient <= 1:
            raise ValueError(f"restitution: {self.coefficient} is outside [0, 1]")

    def after(self, velocity: float) -> float:
        """Contact velocity in m/s just after, from ``velocity`` just before."""
        return -self.coefficient * velocity

    def impulse(self, velocity: float, mobility: float) -> float:
        """Impulse p = −(1+R) v⁻/S in N s on the contact coordinate; ``mobility`` S = w M⁻¹ wᵀ in 1/kg."""
        return -(1 + self.coefficient) * velocity / mobility


def first_mode_restitution(restitution: float, first: float, mobility: float) -> float:
    """R₁ = (1+R) c₁²/S − 1: what mode 1, of contact value ``first`` c₁, sees of a contact with R.

    ``mobility`` S = Σ c_i² over the modes of the model. Negative where little of S is mode 1's.
    """
    return (1 + restitution) * first**2 / mobility - 1


def contact_restitution(first_mode: float, first: float, mobility: float) -> float:
    """R = (1+R₁) S/c₁² − 1: the contact's coefficient with which mode 1 sees R₁ = ``first_mode``.

    ValueError where no R in [0, 1] gives that R₁ in this model.
    """
    restitution = (1 + first_mode) * mobility / first**2 - 1
    if not 0 <= restitution <= 1:
        raise ValueError(
            f"restitution: mode 1 would see {first_mode} only with {restitution:.4g} at the contact, outside [0, 1]: "
            f"it carries {first**2 / mobility:.1%} of this model's contact mobility"
        )
    return restitution
