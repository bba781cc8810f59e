from __future__ import annotations

import numpy as np
import pytest

from app.trajectories.association import AssociationOptions, Pairs, associate
from app.trajectories.metrics.errors import errors_of
from app.trajectories.metrics.floors import evaal_errors_m, floor_score
from app.trajectories.metrics.summary import summarise
from app.trajectories.trajectory import Trajectory

TIMES_S = np.arange(4.0)


def pairs(true_z_m: list[float], told_z_m: list[float], floors: list[int] | None = None) -> Pairs:
    def at(z_m: list[float], storeys: list[int] | None) -> Trajectory:
        told = None if storeys is None else np.array(storeys)
        return Trajectory(TIMES_S, np.column_stack([np.zeros((4, 2)), z_m]), floors=told)

    return associate(at(true_z_m, None), at(told_z_m, floors), AssociationOptions("nearest", max_gap_s=0.0))


def test_heights_become_storeys() -> None:
    score = floor_score(pairs([1.5, 1.5, 4.5, -1.0], [1.0, 3.1, 4.0, -2.0]), floor_height_m=3.0)
    assert score is not None
    assert score.differences.tolist() == [0, 1, 0, 0]
    assert score.detection_probability == 0.75


def test_told_storeys_are_believed_before_heights() -> None:
    score = floor_score(pairs([1.5, 1.5, 4.5, 4.5], [0.0] * 4, floors=[0, 0, 1, 3]), floor_height_m=3.0)
    assert score is not None
    assert score.differences.tolist() == [0, 0, 0, 2]


def test_a_wrong_storey_costs_fifteen_metres() -> None:
    matched = pairs([1.5, 1.5, 4.5, 4.5], [1.0, 1.0, 1.0, 7.0])
    score = floor_score(matched, floor_height_m=3.0)
    penalised_m = evaal_errors_m(errors_of(matched), score)
    assert penalised_m.tolist() == [0.0, 0.0, 15.0, 15.0]
    assert summarise(penalised_m).quantile_75 == 15.0
    assert evaal_errors_m(errors_of(matched), None).tolist() == [0.0] * 4


def test_without_storeys_there_is_no_score() -> None:
    assert floor_score(pairs([1.0] * 4, [1.0] * 4)) is None
    with pytest.raises(ValueError, match="floor_height_m"):
        floor_score(pairs([1.0] * 4, [1.0] * 4), floor_height_m=0.0)
