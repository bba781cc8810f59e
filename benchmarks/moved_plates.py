"""Which moved plates a survey names, and which that never moved: ``python -m benchmarks.moved_plates``.

Surveys of seeded buildings, computed, not rendered. First with nothing moved, by layout and by lens: as their cameras'
polynomials say, focused anew for each photograph, and off by a wave that no polynomial describes. Then with some plates
moved in random directions after half of the photographs that show them, by millimetres and by what the report without
them calls detectable.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from app.cli.arguments import at_least_one
from app.photogrammetry.survey import PlateSpec, SurveyResult, adjust_survey
from benchmarks.building import FAMILY, BuildingOptions, build_building
from benchmarks.building_views import U_M, ViewOptions, photograph
from benchmarks.output import mm, print_table, write_json
from benchmarks.survey_fault_score import LAYOUTS
from benchmarks.survey_faults import Sound, any_direction, pushed
from benchmarks.survey_run import BUILDINGS

ROOMS = {"54 photographs": BUILDINGS[54], **LAYOUTS, "500 photographs": BUILDINGS[500]}
LENSES = {
    "as described": ViewOptions(),
    "breathes by 0.1 %": ViewOptions(breathes=0.001),
    "breathes by 0.3 %": ViewOptions(breathes=0.003),
    "off by 0.1 px": ViewOptions(wave_px=0.1),
    "off by 0.3 px": ViewOptions(wave_px=0.3),
}
DISTANCES_M = (0.002, 0.005, 0.01, 0.02, 0.05)
FACTORS = (0.5, 1.0, 2.0)  # of what is detectable
MOVED = 4  # plates of a survey
MOVED_LENSES = ("as described", "breathes by 0.1 %")
WRONG = ("moved", "deformed")  # reasons for which a target is left out
SEEDS_OF_LARGE = 5  # one in so many of the surveys of 500 photographs


@dataclass(frozen=True)
class Calm:
    """Surveys without any fault: their number, sound targets, those named as moved or deformed, false sightings."""

    layout: str
    lens: str
    surveys: int
    targets: int
    named: int
    false_sightings: int


@dataclass(frozen=True)
class Moved:
    """Plates moved alike: their number, those named as moved, those not published for another reason, others named.

    ``apart_m`` is the median displacement.
    """

    layout: str
    lens: str
    kind: str
    plates: int
    named: int
    otherwise_out: int
    others_named: int
    apart_m: float


def main() -> None:
    """Measure what is asked for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.moved_plates", description=__doc__)
    parser.add_argument("--seeds", type=at_least_one, default=10, help="surveys of each layout and lens")
    parser.add_argument("--seed", type=int, default=1, help="of the first survey; the others count on from it")
    parser.add_argument("--only", choices=("calm", "moved"), help="one of the tables")
    parser.add_argument("--json", type=Path, help="write the figures to this file, too")
    arguments = parser.parse_args()
    seeds = range(arguments.seed, arguments.seed + arguments.seeds)
    record: dict[str, object] = {}
    if arguments.only != "moved":
        record["calm"] = calms = list(calm_surveys(seeds))
        _print_calms(calms)
    if arguments.only != "calm":
        record["moved"] = moves = list(moved_surveys(seeds))
        _print_moves(moves)
    if arguments.json is not None:
        write_json(arguments.json, record)


def calm_surveys(seeds: range) -> Iterator[Calm]:
    """Every layout by every lens, nothing moved."""
    for layout, options in ROOMS.items():
        some = seeds[::SEEDS_OF_LARGE] if layout.startswith("500") else seeds
        for lens, views in LENSES.items():
            found = [_surveyed(_sound(options, views, seed)) for seed in some]
            named = sum(len(_named(result)) for result in found)
            false = sum(len(result.report.false_sightings) for result in found)
            targets = sum(len(result.target_map.targets) for result in found) + named
            yield Calm(layout, lens, len(found), targets, named, false)


def moved_surveys(seeds: range) -> Iterator[Moved]:
    """The two layouts, with a lens as described and one that breathes, by distance and by what is detectable."""
    for layout, options in LAYOUTS.items():
        for lens in MOVED_LENSES:
            pairs = [_with_report(_sound(options, LENSES[lens], seed)) for seed in seeds]
            for distance_m in DISTANCES_M:
                yield _moved((layout, lens), f"{1e3 * distance_m:g} mm", pairs, distance_m)
            for factor in FACTORS:
                yield _moved((layout, lens), f"{factor:g} x detectable", pairs, None, factor)


def _moved(
    where: tuple[str, str], kind: str, sounds: Sequence[Sound], distance_m: float | None, factor: float = 1.0
) -> Moved:
    counts, apart_m = np.zeros(4, dtype=np.intp), []
    for sound in sounds:
        rng = np.random.default_rng((sound.seed, MOVED))
        codes = [code for code in sound.often_seen(4 * MOVED, rng) if code in sound.detectable_m][:MOVED]
        steps_m = {code: (distance_m or factor * sound.detectable_m[code]) * any_direction(rng) for code in codes}
        result = _surveyed(replace(sound, photos=pushed(sound, steps_m).photos))
        named, published = _named(result), result.target_map.by_code.keys()
        right = {code for code in codes if named.get(code) == "moved"}
        counts += [len(codes), len(right), len(set(codes) - right - published), len(named.keys() - set(codes))]
        apart_m += [float(np.linalg.norm(step_m)) for step_m in steps_m.values()]
    plates, found, otherwise_out, others = counts.tolist()
    layout, lens = where
    return Moved(layout, lens, kind, plates, found, otherwise_out, others, float(np.median(apart_m)))


def _sound(options: BuildingOptions, views: ViewOptions, seed: int) -> Sound:
    building = build_building(options, seed)
    return Sound(options, building, photograph(building, views, seed), (), seed, views=views)


def _with_report(sound: Sound) -> Sound:
    """With what the report of the survey as it is calls detectable."""
    known = {target.code: target.detectable_m for target in _surveyed(sound).report.targets}
    return replace(sound, detectable_m={code: least_m for code, least_m in known.items() if least_m is not None})


def _surveyed(sound: Sound) -> SurveyResult:
    return adjust_survey(sound.photos, (), PlateSpec(FAMILY, U_M))


def _named(result: SurveyResult) -> dict[int, str]:
    """Targets that are said to be wrong themselves, and how."""
    return {one.code: one.reason for one in result.report.left_out if one.reason in WRONG}


def _print_calms(calms: Sequence[Calm]) -> None:
    rows = [
        [one.layout, one.lens, str(one.surveys), f"{one.targets:,}", str(one.named), str(one.false_sightings)]
        for one in calms
    ]
    headings = ["layout", "lens", "surveys", "targets", "named", "false sightings"]
    print_table("Nothing moved", headings, rows)


def _print_moves(moves: Sequence[Moved]) -> None:
    rows = [
        [
            *(one.layout, one.lens, one.kind, mm(one.apart_m)),
            *(str(count) for count in (one.plates, one.named, one.otherwise_out, one.others_named)),
        ]
        for one in moves
    ]
    headings = ["layout", "lens", "moved by", "median mm", "plates", "named", "out otherwise", "others named"]
    print_table("Plates moved in random directions", headings, rows)


if __name__ == "__main__":
    main()
