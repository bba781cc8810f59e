from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import pytest

from app.errors import InvalidInput
from app.settings import PREFIX, Settings, settings_from_environment


def test_nothing_set_means_the_defaults() -> None:
    assert settings_from_environment({}) == Settings()
    assert settings_from_environment({f"{PREFIX}QUEUE_DEPTH": ""}) == Settings()


def test_every_field_can_be_set() -> None:
    samples = {"Path": "/srv/data", "str": "sqlite:///x", "int": "7", "float": "2.5", "bool": "yes"}
    environment = {f"{PREFIX}{entry.name.upper()}": samples[str(entry.type)] for entry in fields(Settings)}
    settings = settings_from_environment(environment)
    assert (settings.data_dir, settings.database_url) == (Path("/srv/data"), "sqlite:///x")
    assert (settings.queue_depth, settings.locate_timeout_s, settings.require_keys) == (7, 2.5, True)


def test_what_may_be_none_may_be_zero() -> None:
    settings = settings_from_environment({f"{PREFIX}DRAIN_S": "0", f"{PREFIX}WORKER_METRICS_PORT": "0"})
    assert (settings.drain_s, settings.worker_metrics_port) == (0.0, 0)


def test_the_embedded_database_lies_in_the_data_folder() -> None:
    settings = Settings(data_dir=Path("/srv/data"))
    assert settings.sqlalchemy_url == "sqlite:////srv/data/scattermark.db"
    assert settings.embedded
    assert not Settings(database_url="postgresql://host/name").embedded


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("LOCATE_WORKERS", "many"),
        ("LOCATE_WORKERS", "0"),
        ("QUEUE_DEPTH", "-1"),
        ("LOCATE_TIMEOUT_S", "nan"),
        ("DRAIN_S", "-1"),
    ],
)
def test_a_value_that_cannot_be_is_named(name: str, value: str) -> None:
    with pytest.raises(InvalidInput, match=PREFIX + name):
        settings_from_environment({PREFIX + name: value})
