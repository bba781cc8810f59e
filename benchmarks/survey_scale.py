"""How a survey's cost grows, and what it finds: ``python -m benchmarks.survey_scale``.

Surveys of synthetic buildings whose observations are computed, not rendered, all from seeds. Without options the cost
of 54 to 5,000 photographs with two plates to each is measured, every size in a process of its own, and the
exponents by which time and memory grow. ``--faults`` puts one fault after the other into a building and tells what was
found and named; ``--drift`` holds a corridor at one end; ``--extend`` ties a second survey to the first one's map.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from app.cli.arguments import at_least_one
from benchmarks.output import mm, print_table, write_json
from benchmarks.survey_fault_score import FaultScore, score_faults
from benchmarks.survey_run import BUILDINGS, STAGES, SurveyRun, run_survey
from benchmarks.survey_ties import Drift, Tie, corridor_drift, extension

DEFAULT_SIZES = (54, 500, 1500, 5000)
BYTES_PER_MB = 1e6


def main() -> None:
    """Measure what is asked for."""
    arguments = _parser().parse_args()
    record: dict[str, object] = {}
    if not (arguments.faults or arguments.drift or arguments.extend):
        runs = [_in_own_process(size, arguments.seed) for size in arguments.photos]
        _print_runs(runs)
        record["runs"] = runs
    if arguments.faults:
        scores = list(score_faults(range(arguments.seed, arguments.seed + arguments.seeds), arguments.only))
        _print_faults(scores)
        record["faults"] = scores
    seeds = range(arguments.seed, arguments.seed + arguments.seeds)
    if arguments.drift:
        record["drift"] = drifts = [corridor_drift(seed) for seed in seeds]
        _print_drifts(drifts)
    if arguments.extend:
        record["extend"] = ties = [extension(seed) for seed in seeds]
        _print_ties(ties)
    if arguments.json is not None:
        write_json(arguments.json, record)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.survey_scale", description=__doc__)
    parser.add_argument("--photos", type=int, nargs="+", choices=sorted(BUILDINGS), default=DEFAULT_SIZES)
    parser.add_argument("--faults", action="store_true", help="the matrix of faults")
    parser.add_argument("--only", default="", help="of the faults, those whose name holds this")
    parser.add_argument("--drift", action="store_true", help="a corridor with control at one end")
    parser.add_argument("--extend", action="store_true", help="a map extended by a second survey")
    parser.add_argument("--seed", type=int, default=1, help="of the first building; the others count on from it")
    parser.add_argument("--seeds", type=at_least_one, default=3, help="buildings of each row of the tables")
    parser.add_argument("--json", type=Path, help="write the figures to this file, too")
    return parser


def _in_own_process(size: int, seed: int) -> SurveyRun:
    """One size in a fresh process, whose greatest memory is its own."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        return pool.submit(run_survey, size, seed).result()


def growth_exponent(sizes: Sequence[float], costs: Sequence[float]) -> float:
    """Exponent of the power law that fits costs at sizes best, in logarithms."""
    return float(np.polyfit(np.log(sizes), np.log(costs), 1)[0])


def _print_runs(runs: Sequence[SurveyRun]) -> None:
    costs = [
        [
            f"{run.photos:,}",
            f"{run.plates:,}",
            f"{run.sightings:,}",
            *(f"{run.cpu_s[stage]:.1f}" for stage in STAGES),
            f"{run.adjust_cpu_s:.1f}",
            f"{run.peak_bytes / BYTES_PER_MB:,.0f}",
        ]
        for run in runs
    ]
    headings = ["photographs", "plates", "sightings", *STAGES, "observations to map", "peak MB"]
    print_table("CPU seconds of each stage, and memory", headings, costs)
    found = [
        [
            f"{run.photos:,}",
            f"{run.oriented:,}",
            f"{run.targets:,}",
            str(run.named),
            mm(run.score.shape_rmse_m),
            mm(run.score.absolute_rmse_m),
            f"{run.score.target_nees:.1f}",
            f"{run.score.datum_nees:.1f}",
        ]
        for run in runs
    ]
    headings = [
        "photographs",
        "oriented",
        "targets",
        "faults named",
        "shape mm",
        "absolute mm",
        "NEES (6)",
        "datum (7)",
    ]
    print_table("What came of it; there is no fault in it", headings, found)
    if len(runs) > 1:
        photos = [run.photos for run in runs]
        time_exponent = growth_exponent(photos, [run.adjust_cpu_s for run in runs])
        memory_exponent = growth_exponent(photos, [run.peak_bytes for run in runs])
        print(f"\ngrowth exponents: time {time_exponent:.2f}, memory {memory_exponent:.2f}")


def _print_faults(scores: Sequence[FaultScore]) -> None:
    rows = [
        [
            score.kind,
            *(str(count) for count in (score.faults, score.detected, score.named, score.false_alarms, score.lost)),
            "-" if not score.effects else f"{np.median(score.effects):.2f}",
            "-" if not score.effects else f"{max(score.effects):.2f}",
        ]
        for score in scores
    ]
    headings = ["fault", "put in", "kept out", "named", "false alarms", "lost", "effect, sigma", "worst"]
    print_table("Faults found and named; effect: step of the other targets", headings, rows)


def _print_drifts(drifts: Sequence[Drift]) -> None:
    rows = [[str(one.targets), mm(one.error_m), mm(one.sigma_m), f"{one.nees:.1f}"] for one in drifts]
    rows.append(["mean", "", "", f"{np.mean([one.nees for one in drifts]):.1f}"])
    headings = ["targets at the far end", "error mm", "sigma mm", "NEES (3)"]
    print_table("A corridor of 60 m with control at one end", headings, rows)


def _print_ties(ties: Sequence[Tie]) -> None:
    rows = [
        [
            *(str(count) for count in (one.old, one.added, one.moved, one.moved_named, one.moved_falsely)),
            mm(one.error_m),
            f"{one.nees:.1f}",
        ]
        for one in ties
    ]
    rows.append(["mean", *[""] * 5, f"{np.mean([one.nees for one in ties]):.1f}"])
    headings = ["old targets", "added", "moved", "named", "falsely", "error mm", "NEES (6)"]
    print_table("A map extended by a second survey", headings, rows)


if __name__ == "__main__":
    main()
