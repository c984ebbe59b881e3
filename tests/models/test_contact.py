import numpy as np
import pytest
from refusals import answers

from tests.models.bench import RIG
from vibeam_models.beam import assemble
from vibeam_models.laws.restitution import Restitution, contact_restitution, first_mode_restitution


@pytest.fixture(scope="module")
def contact_values():
    structure = assemble(RIG)
    return structure.contact @ structure.modes().shapes


@pytest.mark.parametrize(("modes", "seen"), [(1, 0.72), (2, 0.684), (5, 0.619), (10, 0.599)])
def test_what_the_first_mode_sees_of_the_rig(contact_values, modes, seen):
    c = contact_values[:modes]
    assert round(first_mode_restitution(0.72, c[0], np.sum(c**2)), 3) == seen


def test_the_first_mode_sees_its_own_velocity_ratio(contact_values):
    """Straight from the impact: mode 1 alone moves, the impulse reverses it to −R₁ of what it had."""
    c = contact_values[:5]
    velocity = np.array([1.0, 0, 0, 0, 0])
    mobility = np.sum(c**2)
    after = velocity - c * 1.72 * (c @ velocity) / mobility
    assert c @ after == pytest.approx(-0.72 * (c @ velocity))
    assert after[0] == pytest.approx(-first_mode_restitution(0.72, c[0], mobility))


@pytest.mark.parametrize("restitution", [0.0, 0.3, 0.72, 1.0])
def test_there_and_back(restitution):
    seen = first_mode_restitution(restitution, 1.9, 4.2)
    assert contact_restitution(seen, 1.9, 4.2) == pytest.approx(restitution, abs=1e-15)


def test_coefficients_out_of_range_are_refused():
    said = r"outside \[0, 1\].*86.0% of this model's contact mobility"
    assert answers(lambda seen: contact_restitution(seen, 1.9, 1.9**2 / 0.86), [0.95, -0.9], said) == []
    assert answers(Restitution, [-0.01, 1.01, float("nan")], r"in \[0, 1\]") == []


def test_a_mode_that_does_not_move_the_contact_sees_no_restitution():
    with pytest.raises(ValueError, match="mode 1 does not move the contact"):
        contact_restitution(0.8, 0.0, 4.2)
