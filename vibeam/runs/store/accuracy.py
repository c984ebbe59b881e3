"""Accuracy study in the results file: candidate and error estimate of each point of ``/accuracy``.

Each direction has ``fidelity`` and ``solver`` (codes, their meanings as attributes), ``estimate``, ``statistical`` and
``scatter``; the group's attribute ``study`` has the choice and its verification as JSON.
"""

from __future__ import annotations

import json
from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.runs.accuracy.study import AccuracyChoice, Chosen, Curve
from vibeam.runs.accuracy.verification import Verified
from vibeam.runs.store.layout import fixed

if TYPE_CHECKING:
    from collections.abc import Mapping

    import h5py

    from vibeam.system.response import FrequencyResponse


HOME = "accuracy"
PLAIN = ("within", "quantities", "finest", "cpu_seconds", "finest_seconds")
ROWS = {"estimate": "relative error, estimated", "scatter": "relative scatter of single readings, standard deviation"}


def write_study(group: h5py.Group, study: AccuracyChoice) -> None:
    """Write everything but the responses into the group ``/accuracy``."""
    head: dict[str, Any] = {name: getattr(study, name) for name in PLAIN}
    head["chosen"] = [_row(each) for each in study.chosen]
    head["verified"] = [_row(each) for each in study.verified]
    group.attrs["study"] = fixed(json.dumps(head))
    for direction, curve in study.curves.items():
        _write_curve(
            group[direction], curve, [each.fidelity for each in study.chosen], [e.solver for e in study.chosen]
        )


def read_study(group: h5py.Group, responses: Mapping[str, FrequencyResponse]) -> AccuracyChoice:
    """Read the study, given the responses of each direction."""
    head = json.loads(group.attrs["study"].decode())
    head["quantities"] = tuple(head["quantities"])
    return AccuracyChoice(
        **{name: head[name] for name in PLAIN},
        curves={direction: _read_curve(group[direction], response) for direction, response in responses.items()},
        chosen=tuple(Chosen(**row) for row in head["chosen"]),
        verified=tuple(Verified(**row) for row in head["verified"]),
    )


def _row(each: Chosen | Verified) -> dict[str, Any]:
    return {field.name: getattr(each, field.name) for field in fields(each)}


def _write_curve(group: h5py.Group, curve: Curve, fidelities: list[str], solvers: list[str]) -> None:
    codes = {"fidelity": (curve.fidelity, fidelities), "solver": (curve.solver, solvers)}
    for name, (values, known) in codes.items():
        meanings = list(dict.fromkeys(known))
        dataset = _dataset(group, name, np.array([meanings.index(each) for each in values]), f"{name} that gave it")
        dataset.attrs["flag_values"] = np.arange(len(meanings))
        dataset.attrs["flag_meanings"] = " ".join(meanings)
    for name, meaning in ROWS.items():
        _dataset(group, name, getattr(curve, name), meaning)
    _dataset(group, "statistical", curve.statistical.astype(np.int64), "the motion does not repeat (1: so)")


def _dataset(group: h5py.Group, name: str, values: Any, meaning: str) -> h5py.Dataset:
    if name in group:
        del group[name]
    dataset = group.create_dataset(name, data=values)
    dataset.attrs["long_name"], dataset.attrs["units"] = meaning, "1"
    dataset.dims[0].attach_scale(group["frequency"])
    return dataset


def _read_curve(group: h5py.Group, response: FrequencyResponse) -> Curve:
    return Curve(
        response=response,
        fidelity=_named(group["fidelity"]),
        solver=_named(group["solver"]),
        estimate=group["estimate"][()],
        statistical=group["statistical"][()].astype(bool),
        scatter=group["scatter"][()],
    )


def _named(dataset: h5py.Dataset) -> tuple[str, ...]:
    meanings = dataset.attrs["flag_meanings"].split(" ")
    return tuple(meanings[code] for code in dataset[()])
