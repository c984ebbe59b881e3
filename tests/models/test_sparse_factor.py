"""Multifrontal factors: solutions, inertia, singular matrices, sizes and memory, against full matrices."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csc_array, diags_array, eye_array, kron

from vibeam_models import memory, sparse_factor
from vibeam_models.phases import phase, phases_told
from vibeam_models.sparse import SparseStructure
from vibeam_models.sparse_factor import _by_fronts, congruent_pattern, factor, pattern_of, symbolic
from vibeam_models.sparse_ordering import compressed, dissection, is_net


def brick(*knots: int, free: bool = False, seed: int = 0) -> csc_array:
    """Stiffness of knots with three motions each, every pair of neighbours (diagonal ones too) tied in all directions.

    Free: the ties resist a difference alone, so that three translations cost nothing.
    """
    near = [diags_array([np.ones(n - 1), np.ones(n), np.ones(n - 1)], offsets=[-1, 0, 1]) for n in knots]
    pairs = near[0]
    for each in near[1:]:
        pairs = kron(pairs, each)
    pairs = csc_array(pairs).tocoo()
    rng, n = np.random.default_rng(seed), pairs.shape[0]
    full = np.zeros((3 * n, 3 * n))
    for i, j in zip(pairs.row, pairs.col, strict=True):
        if i < j:
            half = rng.standard_normal((3, 3))
            tie = half @ half.T + np.eye(3)
            for a, b, sign in ((i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)):
                full[3 * a : 3 * a + 3, 3 * b : 3 * b + 3] += sign * tie
    if not free:
        full[:3, :3] += 10 * np.eye(3)
    return csc_array(full)


def by_fronts(matrix: csc_array) -> sparse_factor.SymmetricFactor:
    return _by_fronts(matrix, symbolic(pattern_of(matrix)), keep=True)


@pytest.mark.parametrize("knots", [(5, 4, 6), (17, 3, 2), (1, 1, 40)], ids=str)
def test_solutions_are_those_of_the_full_matrix(knots: tuple[int, ...]) -> None:
    K = brick(*knots)
    right = np.random.default_rng(1).standard_normal((K.shape[0], 3))
    found = by_fronts(K)
    assert found.regular
    assert found.negative == 0
    expected = np.linalg.solve(K.toarray(), right)
    np.testing.assert_allclose(found.solve(right), expected, rtol=0, atol=1e-11 * np.abs(expected).max())
    np.testing.assert_allclose(found.solve(right[:, 0]), found.solve(right)[:, 0], rtol=1e-12)


def test_negative_eigenvalues_are_counted_and_indefinite_matrices_solved() -> None:
    K = brick(5, 4, 6)
    values = np.linalg.eigvalsh(K.toarray())
    for count in (1, 7, 90, 250):
        shifted = K - (values[count - 1] + values[count]) / 2 * csc_array(eye_array(K.shape[0]))
        found = by_fronts(shifted)
        assert found.negative == count
        assert factor(shifted, found.symbolic, keep=False).negative == count
        right = np.ones(K.shape[0])
        np.testing.assert_allclose(shifted @ found.solve(right), right, atol=1e-8)


def test_a_matrix_without_inverse_is_known_as_one() -> None:
    assert not by_fronts(brick(5, 4, 6, free=True)).regular
    assert not by_fronts(brick(30, 3, 2, free=True)).regular
    assert not by_fronts(csc_array((5, 5))).regular
    slender = brick(400, 1, 1)  # soft, by the fourth power of its length, but held
    assert by_fronts(slender).regular


def test_knots_are_vertices_and_every_front_borders_on_later_ones() -> None:
    K = brick(9, 5, 5)
    graph = compressed(pattern_of(K))
    assert len(graph.weight) < K.shape[0] // 3 + 1  # three motions of a knot, and of corners more, touch the same
    parts = dissection(graph)
    np.testing.assert_array_equal(np.sort(np.concatenate(parts)), np.arange(len(graph.weight)))
    fronts = symbolic(pattern_of(K)).fronts
    assert all((front.border >= front.end).all() for front in fronts)
    assert [front.begin for front in fronts[1:]] == [front.end for front in fronts[:-1]]


def test_entries_that_are_zero_by_chance_stay_in_the_pattern() -> None:
    """A tie between two coordinates of one knot cancels an entry: the pattern is that of any other numbers."""
    A = csc_array(np.array([[2.0, 2.0, 1.0], [2.0, 4.0, -1.0], [1.0, -1.0, 2.0]]))
    basis = csc_array(np.array([[1.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))
    assert (basis.T @ A @ basis).nnz == 2
    found = congruent_pattern(pattern_of(A), basis)
    assert found.nnz == 4
    assert not found.data.any()
    structure = SparseStructure(csc_array(eye_array(2)), found, basis.T @ A @ basis, *np.zeros((3, 2)))
    assert pattern_of(structure.K, structure.C).nnz == 4


def test_matrices_of_another_pattern_are_refused() -> None:
    K = brick(9, 5, 5)
    with pytest.raises(ValueError, match="outside the pattern"):
        factor(csc_array(np.ones(K.shape)), symbolic(pattern_of(K)))


def test_nets_go_to_superlu_and_bricks_do_not() -> None:
    chain = csc_array(diags_array([-np.ones(39), 2 * np.ones(40), -np.ones(39)], offsets=[-1, 0, 1]))
    assert is_net(csc_array(kron(chain, eye_array(40)) + kron(eye_array(40), chain)))
    assert not is_net(pattern_of(brick(5, 4, 6)))


def test_what_does_not_fit_is_told_with_its_size_before_it_is_factored(monkeypatch: pytest.MonkeyPatch) -> None:
    K = brick(9, 5, 5)
    fronts = symbolic(pattern_of(K))
    assert 8 * sum((f.end - f.begin) * (f.end - f.begin + len(f.border)) for f in fronts.fronts) < fronts.bytes()
    assert fronts.bytes(keep=False) < fronts.bytes()
    monkeypatch.setattr(memory, "free_bytes", lambda: fronts.bytes() - 1.0)
    with pytest.raises(ValueError, match=r"of 675 coordinates: needs .* GB of memory, .* GB are free: take a coarser"):
        factor(K, fronts)
    monkeypatch.setattr(memory, "free_bytes", lambda: fronts.bytes() + 1.0)
    assert factor(K, fronts).regular


def test_free_memory_is_what_the_tightest_limit_leaves(monkeypatch: pytest.MonkeyPatch) -> None:
    texts = {"/proc/meminfo": "MemTotal: 9 kB\nMemAvailable:    4000 kB\n"}
    monkeypatch.setattr(memory, "_read", lambda path: texts.get(str(path), ""))
    monkeypatch.setattr(memory, "_of_process", lambda: iter(()))
    assert memory.free_bytes() == 4_096_000
    texts |= {"/sys/fs/cgroup/memory.max": "3000000\n", "/sys/fs/cgroup/memory.current": "1000000\n"}
    assert memory.free_bytes() == 2_000_000
    texts["/sys/fs/cgroup/memory.max"] = "max\n"
    assert memory.free_bytes() == 4_096_000
    texts.clear()
    assert memory.free_bytes() is None


def test_rows_change_and_factors_stay() -> None:
    K = brick(5, 4, 6)
    zero, one = np.zeros(K.shape[0]), np.eye(K.shape[0])[7]
    structure = SparseStructure(csc_array(eye_array(K.shape[0])), 0 * K, K, zero, zero, one)
    other = structure.with_(outputs={"sensor": one}, contact=np.eye(K.shape[0])[9])
    assert other.stiffness_factor is structure.stiffness_factor
    modes = other.modes(4)
    np.testing.assert_array_equal(np.abs(modes.shapes), np.abs(structure.modes(6).shapes[:, :4]))
    assert (modes.shapes[9] > 0).all()
    assert (structure.modes(4).shapes[7] > 0).all()
    assert structure.with_(K=2 * K).stiffness_factor is not structure.stiffness_factor


def test_phases_are_told_of_large_structures() -> None:
    told: list[str] = []
    with phases_told(told.append):
        phase("ordering", 100)
        phase("ordering", 104_544)
    phase("ordering", 104_544)
    assert told == ["ordering: 104 544 coordinates"]
