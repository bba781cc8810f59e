"""The material of a published map's report, read from the database."""

from __future__ import annotations

from collections.abc import Mapping
from hashlib import sha256
from typing import Any

from sqlalchemy.orm import Session

from app.errors import Conflict
from app.photogrammetry.read_report import report_from_json
from app.photogrammetry.report import AdjustmentReport
from app.services.build_options import Exclusion
from app.services.maps import PublishedMap, csv_of_map, published_map
from app.services.reporting.software import this_software
from app.services.survey_report.material import Extended, Fingerprint, Heading, ReportMaterial
from app.storage.records import MapVersion
from app.storage.surveys import SurveyRepository
from app.storage.target_maps import TargetMapRepository


def gather(session: Session, site_id: str, version: int | None, written_s: float) -> ReportMaterial:
    """What the report of a version tells, the active one when none is named.

    Parameters
    ----------
    written_s : float
        When the report is written, UTC.

    Raises
    ------
    NotFound, Conflict
        As ``published_map``; also when the version's record is of a release that kept less of the adjustment.
    """
    published = published_map(session, site_id, version)
    maps = TargetMapRepository(session)
    stored = maps.report(site_id, published.version)
    return ReportMaterial(
        heading=_heading(session, published, maps.version(site_id, published.version), written_s),
        report=_adjustment(stored, published),
        target_map=published.target_map,
        photos=maps.photos(site_id, published.version),
        excluded=_excluded(stored.get("excluded", {})),
        extended=_extended(stored.get("extension")),
    )


def _heading(session: Session, published: PublishedMap, version: MapVersion, written_s: float) -> Heading:
    note = "" if version.survey_id is None else SurveyRepository(session).get(version.survey_id).note
    csv = csv_of_map(published).encode()
    return Heading(
        site_name=published.site.name,
        site_id=published.site.site_id,
        survey_id=version.survey_id,
        map_version=version.version,
        survey_note=note,
        built_s=version.created_s,
        written_s=written_s,
        software=this_software(),
        fingerprint=Fingerprint(f"targets?format=csv&version={version.version}", sha256(csv).hexdigest()),
    )


def _adjustment(stored: Mapping[str, Any], published: PublishedMap) -> AdjustmentReport:
    try:
        return report_from_json(stored)
    except ValueError as error:
        raise Conflict(
            f"version {published.version} was built by a release that kept less of its adjustment, so that only "
            "format=json can tell of it; build the survey again for a report that can be signed",
            site_id=published.site.site_id,
            map_version=published.version,
        ) from error


def _excluded(record: Mapping[str, Any]) -> Exclusion:
    return Exclusion(**{name: tuple(values) for name, values in record.items()})


def _extended(record: Mapping[str, Any] | None) -> Extended | None:
    if record is None:
        return None
    return Extended(record["base_version"], tuple(record["added"]), tuple(record["moved"]))
