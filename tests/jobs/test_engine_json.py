"""What the engine keeps is JSON, errors included, and nothing in it is ever run."""

from __future__ import annotations

import base64
import json
import pickle

import pytest

from app.errors import SurveyFailed
from app.jobs.engine_json import FAULT, JsonSerializer, Replayed
from app.services.jobs import problem_of_error

serializer = JsonSerializer()


@pytest.mark.parametrize("value", [None, 3, "text", [["a", "b"], []], {"args": ["id", 1], "kwargs": {}}])
def test_values_come_back(value: object) -> None:
    assert serializer.deserialize(serializer.serialize(value)) == value


def test_an_error_comes_back_as_the_same_problem() -> None:
    error = SurveyFailed("the photographs do not overlap", reason="no-overlap")
    back = serializer.deserialize(serializer.serialize(error))
    assert isinstance(back, Replayed)
    assert problem_of_error(back) == problem_of_error(error)


def test_a_fault_comes_back_as_a_fault() -> None:
    back = serializer.deserialize(serializer.serialize(ZeroDivisionError("a fault")))
    assert back.slug == FAULT
    assert "a fault" in back.detail


def test_a_pickle_is_not_read() -> None:
    with pytest.raises(json.JSONDecodeError):
        serializer.deserialize(base64.b64encode(pickle.dumps(print)).decode())
