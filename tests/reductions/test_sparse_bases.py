"""Reductions of sparse structures: what they give is what they give of the same matrices in full."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.models.test_sparse import in_full, net
from vibeam_models.beams.beam import Damping
from vibeam_models.sparse import SparseStructure
from vibeam_reductions.declaration import REDUCTIONS

BASES = ["residual_flexibility", "massless_boundary", "craig_bampton"]


@pytest.fixture(scope="module")
def sparse() -> SparseStructure:
    return net(11, 13, Damping("constant", (0.02,)))


@pytest.mark.parametrize("name", BASES)
def test_sparse_is_as_dense(sparse: SparseStructure, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    expected = REDUCTIONS[name].make(in_full(sparse), 7)
    for matrix in ("M", "C", "K"):
        monkeypatch.setattr(type(getattr(sparse, matrix)), "toarray", _refused)
    found = REDUCTIONS[name].make(sparse, 7)
    monkeypatch.undo()
    np.testing.assert_allclose(found.structure.modes().omega, expected.structure.modes().omega, rtol=1e-8)
    assert found.structure.contact_flexibility == pytest.approx(expected.structure.contact_flexibility, rel=1e-7)
    angles = np.linalg.svd(np.linalg.qr(found.basis)[0].T @ np.linalg.qr(expected.basis)[0])[1]
    np.testing.assert_allclose(angles, 1, atol=1e-6)  # the mass is the same everywhere: orthogonal is M-orthogonal
    damping = [np.linalg.eigvalsh(each.structure.C) for each in (found, expected)]
    np.testing.assert_allclose(*damping, rtol=1e-6)


def _refused(*_: Any, **__: Any) -> None:
    raise AssertionError("a full matrix was made of a sparse one")


def test_pod_of_a_sparse_structure_is_refused(sparse: SparseStructure) -> None:
    from vibeam_reductions.pod import Snapshots, pod

    with pytest.raises(ValueError, match="the shapes of 143 modes"):
        pod(sparse, 2, Snapshots(np.ones((3, 2)), np.ones((3, 2))))


def test_held_modes_of_a_net_are_those_of_two_nets(sparse: SparseStructure) -> None:
    """With a whole row of knots held, what is left are nets of 4 × 13 and 6 × 13 knots on fixed edges."""
    from tests.models.test_sparse import squared_frequencies

    rows = np.zeros((13, 143))
    rows[np.arange(13), 4 * 13 + np.arange(13)] = 1.0
    held, basis = sparse.held(rows)
    expected = np.sort(np.concatenate([squared_frequencies(4, 13), squared_frequencies(6, 13)]))[:20]
    np.testing.assert_allclose(held.modes(20).omega ** 2, expected, rtol=1e-9)
    assert np.abs(rows @ basis).max() == 0
