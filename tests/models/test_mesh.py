import numpy as np
import pytest

from vibeam_models.space import nodes


def test_a_uniform_mesh_where_nothing_is_inserted():
    np.testing.assert_allclose(nodes(0.18, 36), np.linspace(0, 0.18, 37), rtol=0, atol=1e-15)


@pytest.mark.parametrize("elements", [1, 7, 36, 101])
def test_every_inserted_position_is_a_node_and_no_element_is_needlessly_short(elements):
    inserted = [0.132, 0.1203, 0.1437]
    mesh = nodes(0.18, elements, inserted)
    assert set(inserted) <= set(mesh)
    assert (mesh[0], mesh[-1]) == (0.0, 0.18)
    assert np.min(np.diff(mesh)) >= min(0.25 * 0.18 / elements, 0.0117) * (1 - 1e-12)
    assert np.max(np.diff(mesh)) <= 1.5 * 0.18 / elements


def test_uniform_nodes_too_near_an_inserted_one_give_way():
    mesh = nodes(1.0, 10, [0.52])
    assert 0.5 not in mesh
    assert len(mesh) == 11


def test_the_same_position_twice_is_one_node():
    assert len(nodes(1.0, 4, [0.5, 0.5, 0.5 + 1e-12, 1.0])) == 5


@pytest.mark.parametrize("position", [-0.01, 1.01, np.nan])
def test_a_node_off_the_beam_is_refused(position):
    with pytest.raises(ValueError, match="no node can stand"):
        nodes(1.0, 4, [position])


def test_no_elements_are_refused():
    with pytest.raises(ValueError, match="at least 1"):
        nodes(1.0, 0)
