"""What schemathesis must know that an OpenAPI document cannot say: rules that refuse requests which fit the schema.

A refusal is let pass only when its problem names one of these rules; any other refused request that fits is a failure.
"""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from typing import Any

import numpy as np
import schemathesis
from hypothesis import strategies

from tests.api.bad_photos import encoded

ARCHIVE = "application/zip"
OWN_KEY = "SCATTERMARK_CONTRACT_KEY_ID"


@dataclass(frozen=True)
class Rule:
    """A rule of some operations.

    Attributes
    ----------
    operations : str
        Pattern of ``METHOD /path`` as the document writes them.
    kinds : tuple of str
        Last part of the problem's type.
    fields : tuple of str
        Patterns of where the problem says the fault lies; none when the kind says enough.
    """

    operations: str
    kinds: tuple[str, ...]
    fields: tuple[str, ...] = ()

    def names(self, operation: str, problem: dict[str, Any]) -> bool:
        """Whether it is this rule that the problem names."""
        if not re.fullmatch(self.operations, operation) or problem["type"].rpartition("/")[2] not in self.kinds:
            return False
        blamed = {problem.get("field"), *(item["field"] for item in problem.get("errors", ()))} - {None}
        return not self.fields or (bool(blamed) and all(re.fullmatch("|".join(self.fields), name) for name in blamed))


RULES = (
    # Any bytes fit `format: binary`; only a decoder knows a photograph.
    Rule("(POST|PUT) /surveys/.*/images.*", ("bad-photo", "unsupported-photo", "photo-too-large")),
    Rule("POST /locate", ("bad-photo", "unsupported-photo", "photo-too-large")),
    Rule("POST /cameras/calibrations", ("bad-photo", "unsupported-photo", "photo-too-large")),
    # Whether a picture shows targets of the site's map is the question itself.
    Rule("POST /locate", ("not-located",)),
    # Letters of any script: the patterns that all tools of OpenAPI agree on know ASCII only.
    Rule("(POST|PUT) /surveys/.*/images.*", ("invalid-input",), ("filename",)),
    # Some more photographs than one: how many the words say. A form's number is a text.
    Rule("POST /cameras/calibrations", ("invalid-input",), ("filename", "images", "body.readout_s", "survey_id")),
    # No pattern knows the calendar, and none compares two parameters.
    Rule("GET /trajectories.*", ("invalid-input",), ("from", "to", "bbox")),
    Rule("POST /locate", ("invalid-input",), ("captured_at",)),
    Rule("DELETE /sites/.*/snapshots", ("invalid-input",), ("before", "device_id")),  # one of them must be there
    # A form's field is a text; what JSON it must hold is said in words. A raw body has its fields in the query, where
    # the document cannot ask for them, since a form has them elsewhere.
    Rule("POST /locate", ("invalid-input",), ("body.camera", "query.camera", "query.site_id")),
    # A time to come, a digest of these very bytes, an archive.
    Rule("POST /keys", ("invalid-input",), ("expires_at",)),
    Rule("PUT /surveys/.*/images.*", ("invalid-input",), ("Content-Digest",)),
    Rule("PUT /surveys/.*/images.*", ("digest-mismatch",)),
    Rule("POST /sites/import", ("bad-archive",)),
    # Any bytes fit a file; only a reader knows a trajectory. Its fields are a form's, or a raw body's in the query.
    Rule("POST /trajectories/import", ("unreadable-trajectory",)),
    Rule("POST /trajectories/import", ("invalid-input",), ("query.site_id", "times", "body.time_unit", "body.format")),
    # One system at least, none twice, none of them the reference; times that increase; one of two parameters.
    Rule("POST /evaluations", ("invalid-input",), ("estimate_ids",)),
    Rule("GET /trajectories/.*/smoothed", ("invalid-input",), ("rate_hz", "times", "from", "to")),
    # Walls that enclose something, a phone wholly described, a grid of not too many places and not of none.
    Rule(
        "GET /sites/.*/coverage",
        ("invalid-input",),
        ("outline", "walls", "area", "width_px", "camera_id", "suggest", "step_m"),
    ),
    # A quaternion of unit length.
    Rule("POST /evaluations/live/.*/samples", ("invalid-input",)),
    # Systems named once each, of what is there; a quaternion has the length 1.
    Rule("POST /evaluations", ("invalid-input",), ("estimate_ids?", "reference_id")),
    Rule("POST /evaluations/live/.*", ("invalid-input",), (r"body\.samples\.\d+\.orientation",)),
    # Text in one of six formats, and times of poses that go forward.
    Rule("POST /trajectories/import", ("unreadable-trajectory",)),
    Rule("POST /trajectories/import", ("invalid-input",), ("times", "query.site_id")),  # as with snapshots
    # Which codes a family holds; a plate that fits its paper; what to print, said in one way.
    Rule("GET /targets/.*", ("invalid-input",), ("codes", "count", "u_mm")),
    # Only what an answer named before: the cursor of a page, the id of an event.
    Rule("GET .*", ("invalid-input",), ("cursor", "Last-Event-ID")),
    # Codes of the site's family, each dot once, within the photograph.
    Rule("PUT /surveys/.*/marks", ("invalid-input",), (r"marks\.\d+\.(code|dot|x_px|y_px)",)),
    # Names and codes of this survey and this site; codes of the site's family; points that can carry a datum.
    Rule("POST /surveys/.*/build", ("invalid-input",), ("exclude.images", "exclude.codes", "exclude.control_points")),
    # Which codes a family holds, and that a target is printed once, no schema says.
    Rule("PUT /sites/.*/print-batches", ("invalid-input",), ("print_batches",)),
    Rule("(POST /surveys/.*/build)|(PUT /sites/.*/control-points)", ("invalid-control-points",)),
)


NOISE = np.random.default_rng(1).integers(0, 255, (48, 64, 3), np.uint8)
PHOTOGRAPHS = {f"image/{kind.lower()}": encoded(NOISE, kind) for kind in ("JPEG", "PNG", "WEBP")}

# Half of the bytes sent as images are images: else no upload would get past the decoder.
for media_type in (*PHOTOGRAPHS, "application/octet-stream"):
    schemathesis.openapi.media_type(media_type, strategies.sampled_from([*PHOTOGRAPHS.values()]) | strategies.binary())


schemathesis.openapi.media_type(ARCHIVE, strategies.binary())


@schemathesis.serializer(ARCHIVE)
def serialize_archive(_context: schemathesis.SerializationContext, value: bytes) -> bytes:
    """An archive is its bytes."""
    return value


@schemathesis.hook
def filter_case(context: schemathesis.HookContext, case: schemathesis.Case) -> bool:  # noqa: ARG001 - its signature
    """Revoke any key but the one that the calls are made with."""
    return case.method != "DELETE" or (case.path_parameters or {}).get("key_id") != os.environ[OWN_KEY]


@schemathesis.hook
def filter_failure(
    context: schemathesis.HookContext,  # noqa: ARG001 - its signature
    failure: Exception,
    case: schemathesis.Case,
    response: schemathesis.Response,
) -> bool:
    """Keep a failure, unless it is a refusal that one of the rules explains."""
    if type(failure).__name__ != "RejectedPositiveData":
        return True
    operation = f"{case.method} {case.path}"
    problem = response.json()
    return not any(rule.names(operation, problem) for rule in RULES)
