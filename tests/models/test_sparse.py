"""SparseStructure: what reductions ask of it is what they get of the same matrices in full."""

import numpy as np
import pytest
from scipy.sparse import csc_array, diags_array, eye_array, kron

from vibeam_models.beams.beam import Damping
from vibeam_models.damping import damped
from vibeam_models.sparse import SparseStructure
from vibeam_models.sparse_factor import factor
from vibeam_models.sparse_modes import lowest_modes
from vibeam_models.structure import Structure
from vibeam_reductions.modes import full, modal
from vibeam_reductions.static_shapes import static_mode

STIFFNESS, MASS = 1e4, 0.3  # N/m of each spring of the net, kg of each knot

KINDS = {
    "constant": (0.02,),
    "stiffness": (0.02,),
    "rayleigh": (0.02, 0.025),
    "list": (0.01, 0.03, 0.02),
}


def chain(size: int, free: bool) -> csc_array:
    off = -np.ones(size - 1)
    made = diags_array([off, 2 * np.ones(size), off], offsets=[-1, 0, 1]).tolil()
    if free:
        made[0, 0] = made[size - 1, size - 1] = 1
    return made.tocsc()


def net(rows: int, columns: int, damping: Damping | None, free: bool = False) -> SparseStructure:
    """A net of knots between springs, its edge fixed, each knot moving out of the plane."""
    one, other = chain(rows, free), chain(columns, free)
    K = csc_array(STIFFNESS * (kron(one, eye_array(columns)) + kron(eye_array(rows), other)))
    size = rows * columns
    M = csc_array(MASS * eye_array(size))
    contact, sensor = np.zeros(size), np.zeros(size)
    contact[size // 3] = sensor[size // 5] = 1.0
    zero = csc_array((size, size))
    load = -(M @ np.ones(size))
    return SparseStructure(M, zero, K, load, np.zeros(size), contact, {"sensor": sensor}, damping=damping)


def squared_frequencies(rows: int, columns: int) -> np.ndarray:
    """ω² of the net: 4k/m (sin² iπ/2(r+1) + sin² jπ/2(c+1)) (two chains, Rayleigh, Theory of Sound §120)."""
    one, other = (np.sin(np.arange(1, n + 1) * np.pi / (2 * (n + 1))) ** 2 for n in (rows, columns))
    return np.sort((4 * STIFFNESS / MASS * (one[:, None] + other)).ravel())


def in_full(given: SparseStructure) -> Structure:
    zero = np.zeros(given.M.shape)
    made = Structure(
        given.M.toarray(), zero, given.K.toarray(), given.load, given.static, given.contact, given.outputs
    )  # fmt: skip
    return made if given.damping is None else damped(made, given.damping)


@pytest.mark.parametrize("kind", KINDS)
def test_static_mode_and_modes_are_those_of_the_full_matrices(kind: str) -> None:
    sparse = net(11, 14, Damping(kind, KINDS[kind]))
    dense = in_full(sparse)
    for reduce in (static_mode, lambda structure: modal(structure, 6)):
        one, other = reduce(sparse), reduce(dense)
        for name in ("M", "C", "K", "load", "contact"):
            value = getattr(other.structure, name)
            np.testing.assert_allclose(
                getattr(one.structure, name), value, rtol=1e-9, atol=1e-11 * np.abs(value).max(), err_msg=name
            )
        assert one.mobility_kept == pytest.approx(other.mobility_kept, rel=1e-12)
        assert one.flexibility_kept == pytest.approx(other.flexibility_kept, rel=1e-9)


def test_a_square_net_has_all_of_its_double_frequencies() -> None:
    squared = net(13, 13, None).modes(20).omega ** 2
    np.testing.assert_allclose(squared, squared_frequencies(13, 13)[:20], rtol=1e-12)


def test_a_cubic_lattice_has_all_of_its_threefold_frequencies() -> None:
    """Lanczos' method alone leaves three of these modes out: the count sends it back for them."""
    n, count = 9, 10
    one = chain(n, False)
    eye = eye_array(n)
    K = csc_array(
        STIFFNESS * (kron(kron(one, eye), eye) + kron(kron(eye, one), eye) + kron(kron(eye, eye), one))
    )  # fmt: skip
    M = csc_array(MASS * eye_array(n**3))
    squared, shapes = lowest_modes(K, M, count, factor(K))
    each = np.sin(np.arange(1, n + 1) * np.pi / (2 * (n + 1))) ** 2
    every = 4 * STIFFNESS / MASS * np.add.outer(np.add.outer(each, each), each).ravel()
    np.testing.assert_allclose(squared, np.sort(every)[:count], rtol=1e-11)
    np.testing.assert_allclose(shapes.T @ (M @ shapes), np.eye(count), atol=1e-10)


def test_a_free_net_moves_as_one_and_has_no_static_mode() -> None:
    free = net(9, 12, Damping("constant", (0.02,)), free=True)
    modes = free.modes(4)
    assert modes.omega[0] < 1e-4 * modes.omega[1]
    np.testing.assert_allclose(np.abs(modes.shapes[:, 0]), 1 / np.sqrt(MASS * free.size), rtol=1e-8)
    lowest = 4 * STIFFNESS / MASS * np.sin(np.pi / 24) ** 2
    assert modes.omega[1] ** 2 == pytest.approx(lowest, rel=1e-10)
    np.testing.assert_allclose(np.diag(modal(free, 4).structure.C)[1:], 0.04 * modes.omega[1:], rtol=1e-6)
    with pytest.raises(ValueError, match="the body is free"):
        static_mode(free)


def test_what_would_be_dense_is_refused() -> None:
    sparse = net(11, 14, None)
    with pytest.raises(ValueError, match=r"the shapes of 154 modes in 154 coordinates .* 51 at most"):
        full(sparse)
    with pytest.raises(ValueError, match="K: must be positive semidefinite"):
        modal(sparse.with_(K=sparse.K - 4000 * sparse.M), 3)
    with pytest.raises(ValueError, match="contact: must be 154 finite numbers"):
        sparse.with_(contact=np.ones(3))
    with pytest.raises(ValueError, match="makes the highest modes negative"):
        static_mode(net(11, 14, Damping("rayleigh", (0.02, 0.001))))


def test_twenty_thousand_coordinates_are_reduced_without_becoming_dense() -> None:
    sparse = net(141, 142, Damping("stiffness", (0.02,)))
    reduced = modal(sparse, 20)
    assert sparse.size == 20022
    np.testing.assert_allclose(np.diag(reduced.structure.K), squared_frequencies(141, 142)[:20], rtol=1e-11)
    assert static_mode(sparse).flexibility_kept == pytest.approx(1.0, rel=1e-9)
    assert reduced.basis.nbytes < 0.02 * 8 * sparse.size**2
    assert sparse.stiffness_factor.factors.L.nnz < 0.02 * sparse.size**2
