"""The last section: how the report's numbers are to be read."""

from __future__ import annotations

from app.services.reporting.document import Facts, Section

LINES = (
    ("Error", "estimate minus reference, in the site frame in metres, Z up"),
    (
        "CE, VE, SE",
        "size in the plan, in height, in space; 50 and 95: as many percent lie below it (ISO/IEC 18305)",
    ),
    ("Quantiles", "of type 7 (Hyndman and Fan, 1996), linear between order statistics"),
    ("Covariance", "of the errors about their mean"),
    (
        "EvAAL",
        "error in the plan, and 15 m for each storey that is wrong; its third quartile is the score (IPIN)",
    ),
    (
        "Intervals",
        "95 % unless asked otherwise: percentiles of a circular block bootstrap, which keeps together errors that "
        "follow each other and are alike",
    ),
    ("Covered", "share of the reference's poses that have an estimate near in time"),
    ("Latency", "how long after its moment a position was there to be used, by the system's clock"),
    (
        "Verdict",
        "errors are told from the reference's uncertainty when the mean of their squares, normalised by its "
        "covariance, exceeds what 95 % of single draws keep within",
    ),
)


def conventions() -> Section:
    """Words and what they mean."""
    return Section("Conventions", (Facts(LINES),))
