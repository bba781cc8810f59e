from __future__ import annotations

import numpy as np

from app.services.evaluation_report.thinning import distinct_rows, extreme_rows, moved_rows, said, spread_rows, unbroken


def test_extremes_of_every_column_and_both_ends_are_kept() -> None:
    series = np.random.default_rng(1).normal(size=(50_000, 2))
    rows = extreme_rows(series, 1000)
    assert len(rows) <= 1002 and (np.diff(rows) > 0).all()
    assert {0, 49_999, *series.argmin(axis=0), *series.argmax(axis=0)} <= set(rows.tolist())
    for stretch in np.array_split(np.arange(50_000), 250):
        assert stretch[series[stretch, 0].argmax()] in rows


def test_short_series_are_kept_whole() -> None:
    assert len(extreme_rows(np.zeros((7, 2)), 7)) == len(spread_rows(np.zeros(7), 4, 3)) == 7
    assert said(7, 7) == ""


def test_spread_rows_hold_the_greatest() -> None:
    values = np.random.default_rng(2).random(9000)
    rows = spread_rows(values, 300, 20)
    assert set(np.argsort(values)[-20:]) <= set(rows.tolist())
    assert np.diff(rows).max() <= 31


def test_each_square_keeps_one() -> None:
    places = np.random.default_rng(3).uniform(0.0, 10.0, (5000, 2))
    kept = places[distinct_rows(places, 1.0)]
    assert len(kept) == 100
    assert len(np.unique(np.floor(kept), axis=0)) == 100


def test_a_path_keeps_where_it_enters_and_ends() -> None:
    path = np.column_stack([np.linspace(0.0, 3.5, 71), np.zeros(71)])
    assert moved_rows(path, 1.0).tolist() == [0, 20, 40, 60, 70]
    assert moved_rows(np.zeros((1, 2)), 1.0).tolist() == [0]


def test_a_gap_that_is_not_drawn_parts_the_line_too() -> None:
    times_s = np.array([0.0, 1.0, 2.0, 9.0, 10.0, 11.0])
    assert [run.tolist() for run in unbroken(times_s, np.array([0, 2, 4, 5]), 2.0)] == [[0, 2], [4, 5]]
