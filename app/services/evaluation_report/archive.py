"""The report's archive: pages, numbers, and a result for the tool evo of each system."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Iterable, Mapping

from app.services.evaluation_report.evo_result import evo_files, file_name
from app.services.evaluation_report.material import ReportMaterial
from app.trajectories.evaluation_record import record_of_difference, record_of_evaluation


def archive_of(material: ReportMaterial, pages: Mapping[str, bytes]) -> bytes:
    """A zip file of pages, ``evaluation.json`` and evo's results: at the top of one system's, else a file each."""
    results = {
        name: evo_files(material.reference_name, name, evaluation) for name, evaluation in material.evaluations.items()
    }
    if len(results) == 1:
        (evo,) = results.values()
    else:
        files = _unlike(results)
        evo = {f"evo/{file}.zip": _zipped(results[name]) for name, file in files.items()}
    return _zipped({**evo, **pages, "evaluation.json": _record(material)})


def _unlike(names: Iterable[str]) -> dict[str, str]:
    """File names of systems, numbered where two would be one, also to file systems that know no capitals."""
    files: dict[str, str] = {}
    taken: set[str] = set()
    for name in names:
        file, number = file_name(name), 1
        while file.lower() in taken:
            number += 1
            file = f"{file_name(name)}-{number}"
        taken.add(file.lower())
        files[name] = file
    return files


def _record(material: ReportMaterial) -> bytes:
    record = {
        "title": material.title,
        "reference": material.reference_name,
        "evaluations": {name: record_of_evaluation(found) for name, found in material.evaluations.items()},
        "differences": [record_of_difference(difference) for difference in material.differences],
    }
    return json.dumps(record, indent=1).encode()


def _zipped(files: Mapping[str, bytes]) -> bytes:
    """The same bytes for the same files, whenever they are packed."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
    return out.getvalue()
