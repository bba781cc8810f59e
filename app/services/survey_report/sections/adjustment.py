"""The adjustment as a whole: its size, its fit, the datum and the print."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.photogrammetry.report import AdjustmentReport, PrintBatchRecord, PrintRecord
from app.services.reporting.document import Facts, Figure, Section
from app.services.reporting.numbers import MDEG_PER_DEG, MM_PER_M, count, fixed, metres, signed_percent
from app.services.survey_report.figures.plan_view import plan_view
from app.services.survey_report.material import ReportMaterial

PARTS_PER_MILLION = 1e6
PERCENT = 100.0
CODES_TOLD = 12  # of a print batch; the JSON report holds them all


def adjustment(material: ReportMaterial) -> Section:
    """Facts of the adjustment."""
    report = material.report
    part = report.plate_sigmas
    lines = (
        ("Image coordinates", count(report.observations)),
        ("Redundancy", count(report.redundancy)),
        ("sigma0", f"{fixed(report.sigma0, 3)} (residuals over what the measured dots promise; 1 when they keep it)"),
        (
            "Of a plate's parts",
            f"shift {fixed(part.shift, 2)}, linear deformation {fixed(part.linear, 2)}, single dots "
            f"{fixed(part.dots, 2)}: errors that a plate's dots share are weighted by these",
        ),
        ("Steps", f"{report.steps}, {'converged' if report.converged else 'NOT converged'}"),
        *_prints(report),
        *_datum(report),
    )
    return Section("Adjustment", (Facts(lines),))


def plan(material: ReportMaterial) -> Section:
    """The plan view."""
    figure: Figure = plan_view(material)
    return Section("Plan view", (figure,))


def _prints(report: AdjustmentReport) -> tuple[tuple[str, str], ...]:
    """The print scale, or that of each batch."""
    if len(report.print_batches) <= 1:
        return (("Print scale", _print_scale(report.print_scale)),)
    return tuple((_heading(one), f"{_print_scale(one)}; {_seen_in(one)}") for one in report.print_batches)


def _heading(batch: PrintBatchRecord) -> str:
    if batch.found:
        return "Print batch found"
    return f"Print batch {batch.name}" if batch.name else "Prints on no list"


def _seen_in(batch: PrintBatchRecord) -> str:
    codes = ", ".join(str(code) for code in batch.codes[:CODES_TOLD])
    more = f" and {len(batch.codes) - CODES_TOLD} more" if len(batch.codes) > CODES_TOLD else ""
    return f"{count(len(batch.codes))} targets ({codes}{more})"


def _print_scale(record: PrintRecord | PrintBatchRecord) -> str:
    if record.held:
        return "held at what was expected, since no control points fix the scale"
    axes = [
        f"{axis} {signed_percent(scale)} ± {fixed(PERCENT * sigma, 3)} %"
        for axis, scale, sigma in zip("xy", record.scale.tolist(), record.sigmas.tolist(), strict=True)
    ]
    return f"against the nominal size: {', '.join(axes)}"


def _datum(report: AdjustmentReport) -> tuple[tuple[str, str], ...]:
    """What all targets share; with an assumed datum it says how far the frame itself is known."""
    datum = report.datum
    origin = ", ".join(metres(value) for value in datum.origin_m)
    shift = _three(MM_PER_M * datum.translation_sigma_m, 2)
    turn = _three(MDEG_PER_DEG * np.degrees(datum.rotation_sigma_rad), 2)
    return (
        ("Datum's origin", f"{origin} m"),
        (
            "Sigmas of the datum",
            f"translation {shift} mm, rotation {turn} mdeg, scale {PARTS_PER_MILLION * datum.scale_sigma:.0f} ppm; all "
            "targets share these",
        ),
    )


def _three(values: npt.NDArray[np.float64], digits: int) -> str:
    return " / ".join(fixed(value, digits) for value in values)
