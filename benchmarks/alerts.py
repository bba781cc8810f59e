"""How soon a moved target is noticed, and how often an alert is false: ``python -m benchmarks.alerts``.

Sites of 60 targets in a room of 8 m x 6 m, snapshots from everywhere in it. Alerts are asked for after every snapshot
that sees the moved target, and after every tenth of the calm sites.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np

from app.errors import NotLocated
from app.photogrammetry.evidence import gather_evidence
from app.photogrammetry.map_watch import Finding, WatchedSnapshot, watch_map
from app.photogrammetry.resection import resect
from app.services.alert_work import SNAPSHOTS_WATCHED
from app.storage.evidence_blob import blob_of_evidence
from benchmarks.output import print_table
from benchmarks.watched_site import SiteOptions, WatchedSite

CALM_SNAPSHOTS = 20  # before the target is moved
MOST_SIGHTINGS = 30
DISPLACEMENTS_MM = (2, 3, 5, 10, 20)
ASKED_EVERY = 10


@dataclass(frozen=True)
class Noticed:
    """What became of one moved target.

    Attributes
    ----------
    sightings : int or None
        Snapshots that saw it until it was named; None when it was not.
    error_mm, sigmas : float or None
        Of the displacement told then.
    others : int
        Other targets that were named before.
    """

    sightings: int | None
    error_mm: float | None
    sigmas: float | None
    others: int


def notice(seed: int, moved_mm: float) -> Noticed:
    """Move one target of a site and ask for alerts until it is named."""
    site = WatchedSite(SiteOptions(), seed)
    snapshots = site.snapshots()
    history = list(islice(snapshots, CALM_SNAPSHOTS))
    code = site.codes[seed % len(site.codes)]
    shift_mm = 1e3 * site.move(code, 1e-3 * moved_mm)
    sightings, others = 0, 0
    while sightings < MOST_SIGHTINGS:
        history.append(next(snapshots))
        evidence = history[-1].evidence
        if evidence is None or code not in evidence.seen_codes:
            continue
        sightings += 1
        found = {finding.code: finding for finding in watch_map(history, site.target_map)}
        others = max(others, len(found.keys() - {code}))
        if code in found and found[code].kind == "moved-target":
            return Noticed(sightings, *_error(found[code], shift_mm), others)
    return Noticed(None, None, None, others)


def _error(finding: Finding, shift_mm: np.ndarray) -> tuple[float, float]:
    assert finding.displacement_m is not None and finding.covariance_m2 is not None
    error_m = finding.displacement_m - 1e-3 * shift_mm
    chi2 = float(error_m @ np.linalg.solve(finding.covariance_m2, error_m))
    return 1e3 * float(np.linalg.norm(error_m)), float(np.sqrt(chi2 / len(error_m)))


def false_alarms(seed: int, count: int) -> Counter[str]:
    """Alerts, by kind, of a site where nothing was moved."""
    site = WatchedSite(SiteOptions(), seed)
    raised: set[tuple[str, int | None]] = set()
    history: list[WatchedSnapshot] = []
    for number, snapshot in enumerate(islice(site.snapshots(), count), start=1):
        history.append(snapshot)
        if number % ASKED_EVERY == 0:
            raised |= {(finding.kind, finding.code) for finding in watch_map(history, site.target_map)}
    return Counter(kind for kind, _ in raised)


def _rows(sites: int) -> Iterator[Sequence[str]]:
    for moved_mm in DISPLACEMENTS_MM:
        noticed = [notice(seed, moved_mm) for seed in range(sites)]
        named = [item for item in noticed if item.sightings is not None]
        counts = [item.sightings for item in named if item.sightings is not None]
        errors_mm = [item.error_mm for item in named if item.error_mm is not None]
        sigmas = [item.sigmas for item in named if item.sigmas is not None]
        yield (
            f"{moved_mm} mm",
            f"{len(named)} of {sites}",
            f"{np.median(counts):.0f}" if counts else "-",
            f"{max(counts)}" if counts else "-",
            f"{np.median(errors_mm):.1f} mm" if errors_mm else "-",
            f"{np.sqrt(np.mean(np.square(sigmas))):.2f}" if sigmas else "-",
            f"{sum(item.others for item in noticed)}",
        )


def cost(count: int) -> Sequence[str]:
    """What evidence costs a snapshot, and a look at a site's newest 500: medians of CPU time."""
    site = WatchedSite(SiteOptions(misread_share=0.0, bad_share=0.0), seed=1)
    resected_s: list[float] = []
    told_s: list[float] = []
    sizes: list[float] = []
    while len(told_s) < count:
        observations = site.observe()
        try:
            begun_s = time.process_time()
            resection = resect(observations, site.target_map, site.calibrated)
        except NotLocated:
            continue
        between_s = time.process_time()
        blob = blob_of_evidence(gather_evidence(observations, site.target_map, resection))
        told_s.append(time.process_time() - between_s)
        resected_s.append(between_s - begun_s)
        sizes.append(len(blob) / len(observations))
    history = list(islice(site.snapshots(), SNAPSHOTS_WATCHED))
    begun_s = time.process_time()
    watch_map(history, site.target_map)
    looked_s = time.process_time() - begun_s
    return (
        f"{1e3 * np.median(resected_s):.2f} ms",
        f"{1e3 * np.median(told_s):.2f} ms",
        f"{np.median(sizes):.0f} bytes",
        f"{looked_s:.2f} s",
    )


def main() -> None:
    """Print all tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sites", type=int, default=20, help="sites per displacement")
    parser.add_argument("--calm-sites", type=int, default=50, help="sites where nothing is moved")
    parser.add_argument("--snapshots", type=int, default=200, help="of each of these")
    options = parser.parse_args()
    print_table(
        f"Cost on one core; a look takes {SNAPSHOTS_WATCHED} snapshots",
        ("resection", "evidence of a snapshot", "kept per target", "a look at a site"),
        [cost(options.snapshots)],
    )
    headings = (
        "moved by", f"named within {MOST_SIGHTINGS} sightings", "median sightings", "most", "median error",
        "errors in sigmas", "others named",
    )  # fmt: skip
    print_table("A moved target is named", headings, list(_rows(options.sites)))
    total = options.calm_sites * options.snapshots
    raised: Counter[str] = sum((false_alarms(seed, options.snapshots) for seed in range(options.calm_sites)), Counter())
    kinds = ("moved-target", "misfit-target", "vanished-target", "unknown-target", "map-misfit")
    print_table(
        f"False alerts in {total} snapshots of {options.calm_sites} sites where nothing was moved",
        kinds,
        [[str(raised[kind]) for kind in kinds]],
    )


if __name__ == "__main__":
    main()
