"""The first page: what was compared with what, how good it was found, and what to make of it."""

from __future__ import annotations

from app.services.evaluation_report.material import ReportMaterial
from app.services.evaluation_report.numbers import error_m, interval_m, percent
from app.services.reporting.document import (
    Block,
    Column,
    Facts,
    Finding,
    Findings,
    KeyFigure,
    KeyFigures,
    Section,
    Table,
)
from app.services.reporting.numbers import count, listed, moment
from app.services.reporting.software import this_software
from app.trajectories.evaluation import Evaluation
from app.trajectories.metrics.distinguishable import Verdict

MOST_NAMES = 12
NO_VERDICT = "The reference told no covariances: how much of the errors is its own is not known."
OVERVIEW_NOTE = "SE: errors in space; CE: in the plan; EvAAL: third quartile. More, and what the words mean, below."


def summary(material: ReportMaterial) -> Section:
    """Key figures of one system, or a line for each of several; then the verdicts."""
    evaluations = material.evaluations
    single = next(iter(evaluations.values())) if len(evaluations) == 1 else None
    shown: Block = _overview(material) if single is None else _key_figures(single)
    return Section("Summary", (shown, _facts(material), Findings(_findings(material))))


def _key_figures(evaluation: Evaluation) -> KeyFigures:
    accuracy, rms = evaluation.accuracy, evaluation.intervals.rms
    pairs = f"{count(len(evaluation.pairs))} pairs of {count(evaluation.pairs.estimate_count)} poses"
    return KeyFigures(
        (
            KeyFigure(f"{error_m(accuracy.spatial.median)} m", "SE50, half of the errors in space", pairs),
            KeyFigure(f"{error_m(accuracy.spatial.quantile_95)} m", "SE95, 95 % of the errors in space"),
            KeyFigure(
                f"{error_m(accuracy.spatial.rms)} m",
                "RMS in space",
                f"interval {error_m(rms.low)} to {error_m(rms.high)} m",
            ),
            KeyFigure(f"{error_m(accuracy.horizontal.quantile_95)} m", "CE95, 95 % in the plan"),
            KeyFigure(f"{error_m(evaluation.evaal.quantile_75)} m", "third quartile, EvAAL's score"),
            KeyFigure(f"{percent(evaluation.availability.covered_share)} %", "of the reference covered"),
        )
    )


def _overview(material: ReportMaterial) -> Table:
    columns = (
        Column("System", align="left"),
        Column("Pairs"),
        Column("RMS in space (interval), m"),
        Column("SE50, m"),
        Column("SE95, m"),
        Column("CE95, m"),
        Column("EvAAL, m"),
        Column("Covered, %"),
    )
    rows = tuple(
        (
            name,
            count(len(evaluation.pairs)),
            interval_m(evaluation.intervals.rms),
            error_m(evaluation.accuracy.spatial.median),
            error_m(evaluation.accuracy.spatial.quantile_95),
            error_m(evaluation.accuracy.horizontal.quantile_95),
            error_m(evaluation.evaal.quantile_75),
            percent(evaluation.availability.covered_share),
        )
        for name, evaluation in material.evaluations.items()
    )
    return Table("Systems", columns, rows, OVERVIEW_NOTE)


def _facts(material: ReportMaterial) -> Facts:
    times_s = [evaluation.errors.times_s for evaluation in material.evaluations.values()]
    first_s, last_s = min(float(times[0]) for times in times_s), max(float(times[-1]) for times in times_s)
    systems = list(material.evaluations)
    return Facts(
        (
            ("Reference", material.reference_name),
            ("System" if len(systems) == 1 else "Systems", listed(systems, MOST_NAMES)),
            ("First and last pair", f"{moment(first_s)}, {moment(last_s)}"),
            ("Errors", "estimate minus reference, in the site frame"),
            ("Software", this_software()),
        )
    )


def _findings(material: ReportMaterial) -> tuple[Finding, ...]:
    """The gravest first."""
    verdicts = {name: evaluation.verdict for name, evaluation in material.evaluations.items()}
    findings = [_finding(name, verdict) for name, verdict in verdicts.items() if verdict is not None]
    unknown = [name for name, verdict in verdicts.items() if verdict is None]
    if unknown:
        findings.append(Finding(f"No verdict on {listed(unknown, MOST_NAMES)}", NO_VERDICT, grave=False))
    return tuple(sorted(findings, key=lambda finding: not finding.grave))


def _finding(name: str, verdict: Verdict) -> Finding:
    left = (
        ""
        if verdict.system_rms_m is None
        else f" Without the reference's part {error_m(verdict.system_rms_m)} m are left (RMS)."
    )
    within = f" {percent(verdict.indistinct_share)} % of the pairs lie within the reference's 95 % ellipsoid."
    sentence = f"{verdict.sentence[0].upper()}{verdict.sentence[1:]}."
    return Finding(name, f"{sentence}{left}{within}", grave=not verdict.distinguishable)
