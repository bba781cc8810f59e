"""A stored adjustment report read back: the inverse of ``AdjustmentReport.to_json``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from types import NoneType, UnionType
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np

from app.photogrammetry.report import AdjustmentReport


def report_from_json(record: Mapping[str, Any]) -> AdjustmentReport:
    """The report of a record; members that belong to others are passed over.

    Raises
    ------
    ValueError
        When the record lacks a member that has no default, as one of an older version may, or holds another thing.
    """
    try:
        report = _read(AdjustmentReport, record)
    except (TypeError, KeyError) as error:
        raise ValueError(f"this is no adjustment report of this version: {error!r}") from error
    assert isinstance(report, AdjustmentReport)
    return report


def _read(kind: Any, value: Any) -> Any:
    """A value of an annotated type: arrays, tuples of one kind, dataclasses, optional ones of these, plain values."""
    origin, arguments = get_origin(kind), get_args(kind)
    if origin is UnionType:
        (some,) = (argument for argument in arguments if argument is not NoneType)
        return None if value is None else _read(some, value)
    if origin is tuple:
        return tuple(_read(arguments[0], item) for item in value)
    if origin is np.ndarray:
        (scalar,) = get_args(arguments[1])
        return np.array(value, dtype=scalar)
    if is_dataclass(kind) and isinstance(kind, type):
        hints = get_type_hints(kind)
        told = [field.name for field in fields(kind) if field.name in value or field.default is MISSING]
        return kind(**{name: _read(hints[name], value[name]) for name in told})
    return kind(value)
