"""Control points: what can be believed is read, the rest is named row by row."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from app.errors import InvalidControlPoints, NotFound
from app.services.control_points import (
    COLUMNS,
    ControlLimits,
    check_datum,
    points_of_records,
    put_control_points,
    records_of_csv,
)
from app.storage.database import Database
from app.storage.sites import SiteRepository
from app.targets.family import family_by_name
from tests.storage.examples import site_with_survey

GOLAY = family_by_name("golay")
CODES = [int(code) for code in GOLAY.codes[:6]]
PLACES_M = [(0.0, 0.0, 1.0), (4.0, 0.5, 2.0), (4.5, 3.5, 1.0), (0.5, 4.0, 2.5), (2.0, 2.0, 1.5), (1.0, 3.0, 0.5)]


def row(index: int, **changes: Any) -> dict[str, Any]:
    x_m, y_m, z_m = PLACES_M[index]
    values = {"name": f"CP{index}", "code": CODES[index], "dot": "A", "x_m": x_m, "y_m": y_m, "z_m": z_m}
    return {**values, "sigma_m": 0.001, "role": "control", **changes}


def as_csv(*rows: dict[str, Any]) -> str:
    return "\n".join([",".join(COLUMNS), *(",".join(str(item[name]) for name in COLUMNS) for item in rows)])


def test_json_and_csv_say_the_same() -> None:
    rows = [row(0), row(1, dot="centre", role="check"), row(2, dot="r2c1")]
    from_json = points_of_records(rows, GOLAY)
    from_csv = points_of_records(records_of_csv("\ufeff" + as_csv(*rows) + "\r\n"), GOLAY)
    assert [repr(point) for point in from_json] == [repr(point) for point in from_csv]
    assert (from_json[1].dot, from_json[1].role, from_json[1].cell) == ("centre", "check", None)
    np.testing.assert_array_equal(from_json[2].position_m, PLACES_M[2])


@pytest.mark.parametrize(
    ("changes", "column", "problem"),
    [
        ({"x_m": "4,46"}, "x_m", "no number"),
        ({"y_m": "nan"}, "y_m", "no number"),
        ({"z_m": float("inf")}, "z_m", "no number"),
        ({"x_m": 10**400}, "x_m", "no number"),
        ({"x_m": True}, "x_m", "no number"),
        ({"x_m": [1.0]}, "x_m", "no number"),
        ({"y_m": 4_466_000.0}, "y_m", "subtract a local origin"),
        ({"z_m": ""}, "z_m", "is missing"),
        ({"role": None}, "role", "is missing"),
        ({"sigma_m": 0}, None, "sigma_m must be positive"),
        ({"sigma_m": "-0.001"}, None, "sigma_m must be positive"),
        ({"code": 1}, "code", "no code of the site's family golay"),
        ({"code": 0}, "code", "no code"),
        ({"code": CODES[1] + 0.5}, "code", "no code"),
        ({"code": 10**30}, "code", "no code"),
        ({"code": "seven"}, "code", "no code"),
        ({"dot": "F"}, None, "none of A ... E"),
        ({"dot": "r4c0"}, None, "none of A ... E"),
        ({"role": "ground"}, None, "neither control nor check"),
        ({"name": "x" * 101}, "name", "at most 100"),
        ({"name": "a\x00b"}, "name", "printable"),
        ({"colour": "red"}, None, "not expected: colour"),
    ],
)
def test_a_bad_row_is_named_with_what_is_wrong(changes: dict[str, Any], column: str | None, problem: str) -> None:
    with pytest.raises(InvalidControlPoints, match="row 2") as refused:
        points_of_records([row(0), row(1, **changes), row(2)], GOLAY)
    (found,) = refused.value.fields["rows"]
    assert (found["row"], found["column"]) == (2, column)
    assert problem in found["problem"]


def test_all_bad_rows_are_named_and_five_are_shown() -> None:
    with pytest.raises(InvalidControlPoints, match="and 1 more") as refused:
        points_of_records([row(index, x_m="wrong") for index in range(6)], GOLAY)
    assert [found["row"] for found in refused.value.fields["rows"]] == [1, 2, 3, 4, 5, 6]


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"name": "CP0"}, "names are unique"),
        ({"code": CODES[0]}, "stands in an earlier row"),
        ({"code": CODES[0], "dot": "r0c0"}, "stands in an earlier row"),  # dot A by its other name
    ],
)
def test_a_name_or_dot_given_twice_is_refused(changes: dict[str, Any], problem: str) -> None:
    with pytest.raises(InvalidControlPoints, match=problem):
        points_of_records([row(0), row(1, **changes)], GOLAY)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("", "must name the columns"),
        ("name;code;dot\n", "commas"),
        ("name,code,dot,x_m,y_m,z_m,sigma_m\n", "missing are role"),
    ],
)
def test_a_csv_without_its_columns_is_refused(text: str, problem: str) -> None:
    with pytest.raises(InvalidControlPoints, match=problem):
        records_of_csv(text)


@pytest.mark.parametrize(
    ("line", "problem"), [("CP1,1,A,0,0,0,0.001,control,extra", "more cells"), ("CP1,1,A", "is missing")]
)
def test_a_csv_row_of_another_length_is_refused(line: str, problem: str) -> None:
    with pytest.raises(InvalidControlPoints, match=problem):
        points_of_records(records_of_csv(",".join(COLUMNS) + "\n" + line), GOLAY)


def test_a_cell_as_long_as_a_book_is_refused() -> None:
    with pytest.raises(InvalidControlPoints, match="cannot be read"):
        records_of_csv(as_csv(row(0, name="x" * 200_000)))


def test_a_datum_takes_three_control_points_off_one_line_or_none() -> None:
    def points(*rows: dict[str, Any]) -> Any:
        return points_of_records(list(rows), GOLAY)

    check_datum(())
    check_datum(points(row(0), row(1), row(2)))
    check_datum(points(row(0), row(1), row(2), row(3, role="check")))
    for too_few in (points(row(0)), points(row(0), row(1)), points(row(0), row(1), row(2, role="check"))):
        with pytest.raises(InvalidControlPoints, match="at least 3"):
            check_datum(too_few)
    in_line = [row(index, x_m=index * 2.0, y_m=1.0, z_m=1.0) for index in range(4)]
    with pytest.raises(InvalidControlPoints, match="in one line"):
        check_datum(points(*in_line))
    nearly = ControlLimits().least_breadth * 4.0
    check_datum(points(*in_line[:3], {**in_line[3], "y_m": 1.0 + nearly * 10}))
    same_place = [row(index, x_m=1.0, y_m=1.0, z_m=1.0) for index in range(3)]
    with pytest.raises(InvalidControlPoints, match="in one line"):
        check_datum(points(*same_place))


def test_nothing_changes_when_a_row_is_wrong(database: Database) -> None:
    site, _ = site_with_survey(database)
    with database.writing() as session:
        put_control_points(session, site.site_id, [row(0), row(1), row(2)])
    with pytest.raises(InvalidControlPoints), database.writing() as session:
        put_control_points(session, site.site_id, [row(3), row(4), row(5, code=1)])
    with database.reading() as session:
        assert [point.name for point in SiteRepository(session).control_points(site.site_id)] == ["CP0", "CP1", "CP2"]
    with pytest.raises(NotFound), database.writing() as session:
        put_control_points(session, "nowhere", [])
