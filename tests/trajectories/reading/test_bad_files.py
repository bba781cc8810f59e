"""Every bad file is refused with the line, and the column where there is one."""

from __future__ import annotations

import json
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.trajectories.reading import json_values, table
from app.trajectories.reading.csv_file import read_csv
from app.trajectories.reading.euroc import read_euroc
from app.trajectories.reading.evaal import posi_table, read_position_log
from app.trajectories.reading.geojson import read_geojson
from app.trajectories.reading.geopose import read_geopose
from app.trajectories.reading.kitti import read_kitti
from app.trajectories.reading.table import UnreadableTrajectory
from app.trajectories.reading.tum import read_tum

GOOD = "1.0 1 2 3 0 0 0 1"
HEADING = "time_s,x_m,y_m,z_m,qx,qy,qz,qw"
ROW = "1.0,1,2,3,0,0,0,1"
IDENTITY = "1 0 0 1 0 1 0 2 0 0 1 3"


def kitti(poses: bytes) -> object:
    return read_kitti(poses, b"1.0\n2.0\n")


def feature(**properties: object) -> str:
    point = {"type": "Point", "coordinates": [11.0, 48.0]}
    told = {"type": "Feature", "geometry": point, "properties": {"time": 1.0, **properties}}
    return json.dumps({"type": "FeatureCollection", "features": [told]})


def geopose(**members: object) -> str:
    place, turn = {"lat": 48.0, "lon": 11.0, "h": 500.0}, {"x": 0, "y": 0, "z": 0, "w": 1}
    return json.dumps([{"position": place, "quaternion": turn, "validTime": 1000, **members}])


LOPSIDED = [[1, 0.5, 0], [0, 1, 0], [0, 0, 1]]
IMPOSSIBLE = [[1, 2, 0], [2, 1, 0], [0, 0, 1]]

BAD: list[tuple[Callable[[bytes], Any], str, dict[str, object], str]] = [
    (read_tum, "", {}, "empty"),
    (read_tum, "# only\n# comments\n", {}, "no pose"),
    (read_tum, f"{GOOD}\n1.5 1 2 3 0 0 0\n", {"line": 2, "columns": 7}, "8 are needed"),
    (read_tum, f"# a comment\n\n{GOOD}\n2.0 1 x 3 0 0 0 1\n", {"line": 4, "column": "y"}, "'x' is no number"),
    (read_tum, f"{GOOD}\n2.0 1 2 nan 0 0 0 1\n", {"line": 2, "column": "z"}, "no finite number"),
    (read_tum, f"{GOOD}\n2.0 inf 2 3 0 0 0 1\n", {"line": 2, "column": "x"}, "no finite number"),
    (read_tum, f"{GOOD}\n2.0 1_0 2 3 0 0 0 1\n", {"line": 2, "column": "x"}, "no number"),
    (read_tum, f"{GOOD}\n0.5 1 2 3 0 0 0 1\n", {"line": 2, "column": "timestamp"}, "before the one above"),
    (read_tum, f"{GOOD}\n{GOOD}\n", {"line": 2, "column": "timestamp"}, "comes twice"),
    (read_tum, f"{GOOD}\n2.0 1 2 3 0 0 0 0\n", {"line": 2, "column": "qx"}, "length 0"),
    (read_tum, f"{GOOD}\n2.0 1 2 3 0 0 0 2\n", {"line": 2, "column": "qx"}, "length 2"),
    (
        read_tum,
        "1760000000.0 1 2 3 0 0 0 1\n1760000001000 1 2 3 0 0 0 1\n",
        {"line": 2, "column": "timestamp"},
        "another unit",
    ),
    (read_csv, "", {}, "empty"),
    (read_csv, HEADING, {}, "no pose"),
    (read_csv, f"{HEADING},colour\n{ROW},red", {"line": 1, "column": "colour"}, "no such column"),
    (read_csv, "time_s,x_m,y_mm\n1,2,3", {"line": 1, "column": "y_mm"}, "did you mean y_m"),
    (read_csv, f"{HEADING},x_m\n{ROW},1", {"line": 1, "column": "x_m"}, "named twice"),
    (read_csv, "x_m,y_m\n1,2", {"line": 1}, "must name x_m, y_m and a time"),
    (read_csv, "time_utc,x_m,y_m\nyesterday,1,2", {"line": 2, "column": "time_utc"}, "ISO 8601"),
    (read_csv, "time_s,x_m,y_m,z_m\n1,1,2,\n2,1,2,3", {"line": 3, "column": "z_m"}, "empty above"),
    (read_csv, "time_s,x_m,y_m,z_m\n1,1,2,3\n2,1,2,", {"line": 3, "column": "z_m"}, "no number"),
    (read_csv, "time_s,x_m,y_m,floor\n1,1,2,0.5", {"line": 2, "column": "floor"}, "whole numbers"),
    (read_euroc, "1760000000000000000,1,2,3\n", {"line": 1, "columns": 4}, "8 are needed"),
    (read_tum, "1.0 1e300 2 3 0 0 0 1", {"line": 1, "column": "x"}, "of use"),
    (read_position_log, "1.0,2.0,3.0,1e15\n", {"line": 1, "column": "floor"}, "no storey"),
    (read_position_log, "1.0,2.0,3.0,0.5\n", {"line": 1, "column": "floor"}, "whole numbers"),
    (posi_table, "WIFI;1;2\n", {}, "no POSI line"),
    (posi_table, "POSI;1;2;3\n", {"line": 1, "columns": 3}, "6 are needed"),
    (read_csv, "time_s,x_m,y_m,arrived_s\n5,1,2,900000\n", {"line": 2, "column": "arrived_s"}, "one clock"),
    (read_geojson, "{", {"line": 1}, "no JSON"),
    (read_geojson, "{}", {}, "no FeatureCollection"),
    (read_geojson, feature(time="soon"), {"feature": 1, "column": "time"}, "'soon' is no time"),
    (read_geojson, feature(time=True), {"feature": 1, "column": "time"}, "no time"),
    (read_geojson, feature(covariance=[[1, 0], [0, 1]]), {"feature": 1, "column": "covariance"}, "3 rows of 3"),
    (read_geojson, feature(covariance=LOPSIDED), {"feature": 1, "column": "covariance"}, "symmetric"),
    (read_geojson, feature(covariance=IMPOSSIBLE), {"feature": 1, "column": "covariance"}, "negative eigenvalue"),
    (read_geojson, feature(arrived=None), {"feature": 1, "column": "arrived"}, "no time"),
    (read_geojson, feature(floor=0.5), {"feature": 1, "column": "floor"}, "whole numbers"),
    (read_geojson, feature(orientation_xyzw=[0, 0, 0, 0]), {"feature": 1, "column": "orientation_xyzw"}, "length 0"),
    (read_geopose, "[]", {}, "no list of GeoPoses"),
    (read_geopose, "[1]", {"feature": 1, "column": "validTime"}, "milliseconds"),
    (read_geopose, geopose(position={"lat": 1}), {"feature": 1, "column": "position"}, "lon, lat, h"),
    (read_geopose, geopose(position={"lat": 91, "lon": 0, "h": 0}), {"feature": 1, "column": "position"}, "degrees"),
    (read_geopose, geopose(quaternion=[0, 0, 0, 1]), {"feature": 1, "column": "quaternion"}, "x, y, z, w"),
    (kitti, IDENTITY, {}, "one line of times.txt for each pose"),
    (kitti, f"{IDENTITY}\n2{IDENTITY[1:]}\n", {"line": 2, "column": "r00"}, "no rotation"),
]


@pytest.mark.parametrize(("read", "text", "fields", "words"), BAD)
def test_it_is_refused_and_pointed_at(
    read: Callable[[bytes], Any], text: str, fields: dict[str, object], words: str
) -> None:
    with pytest.raises(UnreadableTrajectory) as refusal:
        read(text.encode())
    assert words in refusal.value.detail
    assert refusal.value.fields == fields
    if "line" in fields:
        assert f"line {fields['line']}" in refusal.value.detail


def test_a_covariance_that_no_errors_have() -> None:
    names = [f"cov_{a}_{b}" for row, a in enumerate("xyz") for b in "xyz"[row:]]
    with pytest.raises(UnreadableTrajectory, match="negative eigenvalue"):
        read_csv(f"time_s,x_m,y_m,{','.join(names)}\n1,1,2,1,5,0,1,0,1\n".encode())


def test_what_is_no_text_is_told_by_its_line() -> None:
    with pytest.raises(UnreadableTrajectory, match="line 2: the file is not UTF-8"):
        read_tum(GOOD.encode() + b"\n\xff\xfe\n")


def test_more_poses_than_can_be_taken_are_counted_before_they_are_read(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(table, "GREATEST_ROWS", 3)
    with pytest.raises(UnreadableTrajectory, match="line 4: the file has more than 3 poses"):
        read_tum("\n".join(f"{time_s} 1 2 3 0 0 0 1" for time_s in range(5)).encode())


@given(st.binary(max_size=200))
def test_no_bytes_at_all_bring_another_error(data: bytes) -> None:
    for read in (read_tum, read_csv, read_euroc, read_position_log, posi_table, kitti, read_geojson, read_geopose):
        with suppress(UnreadableTrajectory):
            read(data)


@given(st.text(alphabet="0123456789.,;-+e# \nnaifPOSI_xymtz", max_size=80))
def test_nor_does_any_text(text: str) -> None:
    for read in (read_tum, read_csv, read_euroc, read_position_log, posi_table, kitti):
        for content in (text, f"{GOOD}\n{text}", f"{HEADING}\n{text}", f"{IDENTITY}\n{text}"):
            with suppress(UnreadableTrajectory):
                read(content.encode())


def test_a_file_of_far_too_many_lines_is_refused_before_it_is_decoded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(table, "GREATEST_LINES", 3)
    with pytest.raises(UnreadableTrajectory, match="more than 3 lines"):
        read_tum(b"\xff\n" * 4)
    monkeypatch.setattr(json_values, "GREATEST_BYTES", 10)
    with pytest.raises(UnreadableTrajectory, match="JSON is taken up to 10"):
        read_geojson(feature().encode())


def test_lines_are_split_piece_by_piece_without_loss(monkeypatch: pytest.MonkeyPatch) -> None:
    text = "a\nbb\r\n\n# c\nccc\rdddd\n" + "e" * 50 + "\nf"
    whole = table.data_lines(text)
    for piece in (1, 2, 5, 7, 1000):
        monkeypatch.setattr(table, "PIECE", piece)
        assert table.data_lines(text) == whole
    assert whole == [(1, "a"), (2, "bb"), (5, "ccc"), (6, "dddd"), (7, "e" * 50), (8, "f")]
