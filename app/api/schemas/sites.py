"""Sites, control points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, Literal

from pydantic import AliasChoices, BaseModel, ConfigDict, Field, model_validator

from app.api.schemas.common import Body, Finite, Listing, Truth, numbers_of, time_of
from app.api.schemas.texts import NAME, Text
from app.geometry.control import ControlPoint
from app.services.control_points import ControlLimits
from app.services.sites import NewSite, SiteChange
from app.storage.paging import Page
from app.storage.records import GeoAnchor, Keep, KeepingPolicy, Site
from app.targets.digits import CODE_COUNT
from app.targets.family import FAMILY_NAMES
from app.targets.layout import DEFAULT_U_M

FamilyName = Literal["golay", "hamming", "parity", "full"]
assert FamilyName.__args__ == FAMILY_NAMES  # type: ignore[attr-defined]


class GeoAnchorBody(Body):
    """Where the site frame's origin stands on the Earth (WGS 84), and how it is turned."""

    latitude_deg: Annotated[Finite, Field(ge=-90, le=90, validation_alias=AliasChoices("latitude_deg", "lat"))]
    longitude_deg: Annotated[Finite, Field(ge=-180, le=180, validation_alias=AliasChoices("longitude_deg", "lon"))]
    height_m: Annotated[Finite, Field(ge=-12_000, le=100_000, description="Above the ellipsoid.")] = 0.0
    azimuth_deg: Annotated[
        Finite, Field(ge=-360, le=360, description="Direction of the site's Y axis, clockwise from true north.")
    ] = 0.0

    def to_domain(self) -> GeoAnchor:
        """The anchor as services know it."""
        return GeoAnchor(self.latitude_deg, self.longitude_deg, self.height_m, self.azimuth_deg)


KEEPS: dict[bool | str, Keep] = {False: Keep.NONE, True: Keep.ALL, "failures": Keep.FAILURES}
KEPT: dict[Keep, bool | Literal["failures"]] = {Keep.NONE: False, Keep.ALL: True, Keep.FAILURES: "failures"}
LONGEST_RETENTION_S = 1e9  # thirty years; null is for ever
KeepSnapshots = Annotated[
    Truth | Literal["failures"],
    Field(description="Whether the pictures of snapshots are kept: none, all, or those that were not located."),
]
Retention = Annotated[
    Finite,
    Field(gt=0, le=LONGEST_RETENTION_S, description="Kept pictures are removed so long after they came; null: never."),
]


class NewSiteBody(Body):
    """A site to be made."""

    name: Text
    code_family: FamilyName = "golay"
    plate_u_m: Annotated[
        Finite, Field(ge=0.001, le=1.0, description="Module of the printed plates: a plate's side is 13 of it.")
    ] = DEFAULT_U_M
    geo_anchor: GeoAnchorBody | None = None
    keep_snapshots: KeepSnapshots = False
    snapshot_retention_s: Retention | None = None

    def to_domain(self) -> NewSite:
        """The site as services know it."""
        anchor = None if self.geo_anchor is None else self.geo_anchor.to_domain()
        keeping = KeepingPolicy(KEEPS[self.keep_snapshots], self.snapshot_retention_s)
        return NewSite(self.name, self.code_family, self.plate_u_m, anchor, keeping)


class SiteChangeBody(Body):
    """What of a site shall change; code family and plate size never do."""

    model_config = ConfigDict(json_schema_extra={"minProperties": 1})

    name: Text | None = None
    geo_anchor: GeoAnchorBody | None = None
    keep_snapshots: KeepSnapshots | None = None
    snapshot_retention_s: Retention | None = None

    def to_domain(self) -> SiteChange:
        """The change as services know it; ``geo_anchor: null`` removes the anchor, and so it is with the retention."""
        return SiteChange(
            name=self.name,
            set_anchor="geo_anchor" in self.model_fields_set,
            geo_anchor=None if self.geo_anchor is None else self.geo_anchor.to_domain(),
            keep=None if self.keep_snapshots is None else KEEPS[self.keep_snapshots],
            set_retention="snapshot_retention_s" in self.model_fields_set,
            retention_s=self.snapshot_retention_s,
        )

    @model_validator(mode="after")
    def _changes_something(self) -> SiteChangeBody:
        if not self.model_fields_set:
            raise ValueError("names nothing to change: give name, geo_anchor, keep_snapshots or snapshot_retention_s")
        return self


class GeoAnchorAnswer(BaseModel):
    """The anchor of a site."""

    latitude_deg: float
    longitude_deg: float
    height_m: float
    azimuth_deg: float


class SiteAnswer(BaseModel):
    """A site."""

    site_id: str
    name: str
    code_family: str
    plate_u_m: float
    geo_anchor: GeoAnchorAnswer | None
    map_version: int | None = Field(description="The version that snapshots are located in; null before the first.")
    keep_snapshots: bool | Literal["failures"]
    snapshot_retention_s: float | None
    created_at: str

    @classmethod
    def of(cls, site: Site) -> SiteAnswer:
        """The answer for a site."""
        return cls(
            site_id=site.site_id,
            name=site.name,
            code_family=site.code_family,
            plate_u_m=site.plate_u_m,
            geo_anchor=None if site.geo_anchor is None else GeoAnchorAnswer(**vars(site.geo_anchor)),
            map_version=site.active_version,
            keep_snapshots=KEPT[site.keeping.keep],
            snapshot_retention_s=site.keeping.retention_s,
            created_at=time_of(site.created_s),
        )


class SitesAnswer(Listing):
    """A page of sites."""

    sites: list[SiteAnswer]

    @classmethod
    def of(cls, page: Page[Site]) -> SitesAnswer:
        """The answer for a page."""
        return cls(sites=[SiteAnswer.of(site) for site in page.items], next_cursor=page.next_cursor)


Metres = Annotated[Finite, Field(ge=-ControlLimits.greatest_m, le=ControlLimits.greatest_m)]


class ControlPointRow(Body):
    """A control or check point, as sent and as shown."""

    name: Annotated[
        str, Field(min_length=1, max_length=ControlLimits.greatest_name, json_schema_extra={"pattern": NAME.pattern})
    ]
    code: Annotated[int, Field(ge=0, lt=CODE_COUNT)]
    dot: Annotated[
        str,
        Field(
            pattern=r"^(?:[A-E]|r[0-3]c[0-3]|centre)$",
            description="A ... E, r0c0 ... r3c3, or centre",
            examples=["A", "r2c1", "centre"],
        ),
    ]
    x_m: Metres
    y_m: Metres
    z_m: Metres
    sigma_m: Annotated[Finite, Field(gt=0, le=ControlLimits.greatest_m)]
    role: Literal["control", "check"]

    @classmethod
    def of(cls, point: ControlPoint) -> ControlPointRow:
        """The row of a point."""
        x_m, y_m, z_m = numbers_of(point.position_m)
        return cls(
            name=point.name,
            code=point.code,
            dot=point.dot,
            x_m=x_m,
            y_m=y_m,
            z_m=z_m,
            sigma_m=point.sigma_m,
            role=point.role,
        )


class ControlPointsAnswer(BaseModel):
    """All control and check points of a site."""

    site_id: str
    control_points: list[ControlPointRow]

    @classmethod
    def of(cls, site_id: str, points: Sequence[ControlPoint]) -> ControlPointsAnswer:
        """The answer for a site's points."""
        return cls(site_id=site_id, control_points=[ControlPointRow.of(point) for point in points])


CONTROL_POINTS_BODY: dict[str, Any] = {
    "required": True,
    "content": {
        "application/json": {"schema": {"type": "array", "items": ControlPointRow.model_json_schema()}},
        "text/csv": {"schema": {"type": "string", "examples": ["name,code,dot,x_m,y_m,z_m,sigma_m,role\n"]}},
    },
}
