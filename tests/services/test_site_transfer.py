"""A site goes from one installation to another and is the same there; nothing else comes with it."""

from __future__ import annotations

import base64
import io
import json
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import piexif
import pytest
from PIL import Image

from app.errors import Conflict, NotFound, OutOfSpace, ServerFull
from app.services.backup import back_up
from app.services.backup_parts import heading_of
from app.services.site_transfer import SiteTransfers, TransferLimits
from app.services.site_transfer_export import SiteSource, export_site, site_chunks
from app.services.site_transfer_import import ImportedSite, ImportLimits, SiteTarget, import_site
from app.services.storage_budget import StorageBudget, StorageLimits
from app.storage.archive_format import BadArchive
from app.storage.archive_reader import ArchiveReader
from app.storage.archive_schema import tables_at
from app.storage.archive_site import write_site
from app.storage.archive_writer import ArchiveWriter
from app.storage.database import Database
from app.storage.ids import new_id
from app.storage.migrate import upgrade
from app.storage.photo_store import open_photo_store
from app.storage.sites import SiteRepository
from app.storage.surveys import DetectionKey, DetectionRepository, SurveyRepository
from app.storage.target_maps import TargetMapRepository
from app.storage.trajectories import TrajectoryRepository
from app.vision.photo import PhotoLimits
from tests.databases import Databases
from tests.services.backup_scene import CODES, PHOTOS, Scene, fill, jpeg, rows_of, sha256_of
from tests.storage.examples import detection, located, photo, snapshot

NOT_MOVED = (
    *("jobs", "api_keys", "audit", "kept_snapshots", "map_evidence", "alerts"),
    *("evaluations", "evaluated_systems", "evaluated_poses", "live_evaluations", "live_samples"),
)
Change = Callable[[str, list[list[Any]]], list[list[Any]]]


def quiet(_stage: str, _done: int, _total: int) -> None:
    """Nobody listens."""


@pytest.fixture(scope="module")
def scene(sqlite: Databases, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Scene]:
    """Where the site is exported from; nothing is changed there."""
    database = Database(sqlite.migrated())
    yield fill(database, tmp_path_factory.mktemp("photographs"))
    database.close()


@pytest.fixture(scope="module")
def archive(scene: Scene) -> bytes:
    return b"".join(site_chunks(SiteSource(scene.database, scene.photos, scene.site_id)))


def target_in(database: Database, folder: Path, quota_bytes: int = 0) -> SiteTarget:
    photos = open_photo_store(str(folder / "imported"))
    budget = StorageBudget(database, photos, StorageLimits(quota_bytes))
    return SiteTarget(database, photos, budget, ImportLimits(PhotoLimits(), folder))


@pytest.fixture
def target(database: Database, tmp_path: Path) -> SiteTarget:
    return target_in(database, tmp_path)


@pytest.fixture
def here(sqlite: Databases, tmp_path: Path) -> Iterator[SiteTarget]:
    """A target whose kind of database makes no difference."""
    database = Database(sqlite.migrated())
    yield target_in(database, tmp_path)
    database.close()


def imported(archive: bytes, target: SiteTarget) -> ImportedSite:
    return import_site(io.BytesIO(archive), target, quiet)


def moved_rows(database: Database) -> dict[str, list[tuple[Any, ...]]]:
    """Rows that an import brings; detections without their bytes, which are written anew."""
    rows = {name: found for name, found in rows_of(database).items() if name not in NOT_MOVED}
    for name in ("detections", "photographs", "target_maps"):
        rows[name] = [tuple(len(row) for row in rows[name])]
    return rows


def test_a_site_is_the_same_elsewhere(scene: Scene, archive: bytes, target: SiteTarget) -> None:
    result = imported(archive, target)
    assert (result.site_id, result.photographs, result.left_out) == (scene.site_id, len(PHOTOS), ())
    assert moved_rows(target.database) == moved_rows(scene.database)
    assert {target.photos.read(sha256_of(data)) for data in PHOTOS.values()} == set(PHOTOS.values())
    with target.database.writing() as session:
        assert TargetMapRepository(session).load(scene.site_id, 1).by_code.keys() == set(CODES)
        assert [photo.name for photo in SurveyRepository(session).photos(scene.survey_id)] == sorted(PHOTOS)
        kept = DetectionRepository(session).get(DetectionKey(sha256_of(PHOTOS["IMG_0.jpg"]), "default-1", "0" * 64))
        assert kept is not None and len(kept.targets) == len(detection().targets)
        walk = TrajectoryRepository(session).default(scene.site_id, "phone-1")
        assert walk.snapshot_count == 3  # and it goes on here
        TrajectoryRepository(session).record(
            walk.trajectory_id, snapshot(SiteRepository(session).get(scene.site_id), located())
        )
    assert list(target.limits.scratch.glob("import-*")) == []


def test_the_file_and_the_stream_hold_the_same(scene: Scene, archive: bytes, tmp_path: Path) -> None:
    manifest = export_site(SiteSource(scene.database, scene.photos, scene.site_id), tmp_path / "s.zip", quiet)
    with ArchiveReader(io.BytesIO(archive)) as streamed:
        streamed.verify(quiet)
        assert (streamed.manifest.tables, streamed.manifest.photographs) == (manifest.tables, manifest.photographs)


def test_only_this_site_is_in_it(scene: Scene, archive: bytes, here: SiteTarget) -> None:
    other = target_in(here.database, here.limits.scratch)
    imported(archive, other)
    with here.database.writing() as session:
        SiteRepository(session).add("another", "golay", 0.01, None)
    again = b"".join(site_chunks(SiteSource(here.database, here.photos, scene.site_id)))
    with ArchiveReader(io.BytesIO(again)) as reader:
        assert {table.name: table.rows for table in reader.manifest.tables}["sites"] == 1


def test_a_site_that_does_not_exist(scene: Scene, tmp_path: Path) -> None:
    source = SiteSource(scene.database, scene.photos, new_id())
    with pytest.raises(NotFound):
        next(site_chunks(source))
    with pytest.raises(NotFound):
        export_site(source, tmp_path / "s.zip", quiet)
    assert list(tmp_path.iterdir()) == []


def test_twice_is_a_conflict_and_as_new_a_second_site(scene: Scene, archive: bytes, target: SiteTarget) -> None:
    imported(archive, target)
    before = rows_of(target.database)
    with pytest.raises(Conflict, match="as-new"):
        imported(archive, target)
    assert rows_of(target.database) == before
    second = imported(archive, replace(target, as_new=True)).site_id
    assert second != scene.site_id
    after = rows_of(target.database)
    assert all(row in after[name] for name, rows in before.items() for row in rows)
    assert len(after["snapshots"]) == 2 * len(before["snapshots"])
    assert len(after["detections"]) == len(before["detections"])  # of the same photographs
    with target.database.writing() as session:
        walks = [TrajectoryRepository(session).default(site_id, "phone-1") for site_id in (scene.site_id, second)]
        assert [walk.snapshot_count for walk in walks] == [3, 3]
        assert walks[0].trajectory_id != walks[1].trajectory_id
        assert TargetMapRepository(session).load(second, 1).by_code.keys() == set(CODES)


def test_new_ids_sort_as_the_old_ones_did(archive: bytes, here: SiteTarget) -> None:
    imported(archive, replace(here, as_new=True))
    with ArchiveReader(io.BytesIO(archive)) as reader:
        old = [json.loads(line) for line in reader.lines("snapshots")]
    new = rows_of(here.database)["snapshots"]
    assert [row[0] for row in old] != [row[0] for row in new]
    assert [row[0][:18] for row in old] == [row[0][:18] for row in new]


def test_a_part_that_is_here_under_another_site(archive: bytes, scene: Scene, here: SiteTarget) -> None:
    def under_another_id(_table: str, rows: list[list[Any]]) -> list[list[Any]]:
        return [[other if value == scene.site_id else value for value in row] for row in rows]

    other = new_id()
    imported(archive, here)
    before = rows_of(here.database)
    with pytest.raises(Conflict, match="under another site"):
        imported(changed(archive, under_another_id), here)
    assert rows_of(here.database) == before


def test_detections_that_are_here_stay(archive: bytes, here: SiteTarget) -> None:
    key = DetectionKey(sha256_of(PHOTOS["IMG_0.jpg"]), "default-1", "0" * 64)
    mine = replace(detection(), targets=())
    with here.database.writing() as session:
        DetectionRepository(session).put(key, mine)
    imported(archive, here)
    with here.database.reading() as session:
        kept = DetectionRepository(session).get(key)
    assert kept is not None and kept.targets == ()


def test_a_quota_holds_for_imports(archive: bytes, here: SiteTarget) -> None:
    tight = target_in(here.database, here.limits.scratch, quota_bytes=100)
    with pytest.raises(OutOfSpace):
        imported(archive, tight)


def test_an_older_site_is_brought_up_to_date(sqlite: Databases, here: SiteTarget) -> None:
    old = Database(sqlite.empty())
    upgrade(old, "0003")
    site_id = new_id()
    with old.writing() as session:
        columns = "id, name, code_family, plate_u_m, last_version, created_s"
        session.connection().exec_driver_sql(
            f"INSERT INTO sites ({columns}) VALUES ('{site_id}', 'old', 'golay', 0.014, 0, 1.0)"
        )
    out = io.BytesIO()
    with old.reading() as session, ArchiveWriter(out) as writer:
        write_site(writer, session.connection(), tables_at("0003"), site_id, quiet)
        writer.finish(heading_of("site", "0003"), with_photographs=True)
    old.close()
    assert imported(out.getvalue(), here).site_id == site_id


def test_a_position_on_the_earth_does_not_come_in(archive: bytes, here: SiteTarget) -> None:
    """The bytes are other then, so what a detector saw in them is seen anew."""
    out = io.BytesIO()
    gps = {piexif.GPSIFD.GPSLatitudeRef: b"N", piexif.GPSIFD.GPSLatitude: ((48, 1), (8, 1), (0, 1))}
    Image.new("RGB", (16, 12), (9, 9, 9)).save(out, "JPEG", exif=piexif.dump({"GPS": gps}))
    placed, plain = out.getvalue(), PHOTOS["IMG_1.jpg"]
    exchanged = {sha256_of(plain): sha256_of(placed)}

    def exchange(_table: str, rows: list[list[Any]]) -> list[list[Any]]:
        return [[exchanged.get(value, value) if isinstance(value, str) else value for value in row] for row in rows]

    imported(changed(archive, exchange, {sha256_of(plain): placed}), here)
    stored = {item.name: here.photos.read(item.name) for item in here.photos.photos()}
    assert sha256_of(placed) not in stored
    assert len(stored) == len(PHOTOS)
    assert not any("GPS" in piexif.load(data) and piexif.load(data)["GPS"] for data in stored.values())
    assert len(rows_of(here.database)["detections"]) == len(PHOTOS) - 1


def changed(archive: bytes, change: Change, photos: dict[str, bytes | None] | None = None) -> bytes:
    """The archive with other rows and photographs, and digests that fit them."""
    photos = photos or {}
    out = io.BytesIO()
    with ArchiveReader(io.BytesIO(archive)) as reader, ArchiveWriter(out) as writer:
        for table in reader.manifest.tables:
            rows = change(table.name, [json.loads(line) for line in reader.lines(table.name)])
            writer.add_table(table.name, table.columns, [json.dumps(row).encode() + b"\n" for row in rows])
        for sha256 in reader.photos:
            data = photos.get(sha256, reader.photo(sha256))
            if data is not None:
                writer.add_photo(sha256_of(data), data)
        writer.finish(reader.manifest.heading, with_photographs=True)
    return out.getvalue()


def test_photographs_that_did_not_come_are_left_out(archive: bytes, scene: Scene, here: SiteTarget) -> None:
    without = changed(archive, lambda _, rows: rows, {sha256_of(PHOTOS["IMG_1.jpg"]): None})
    assert imported(without, here).left_out == ("IMG_1.jpg",)
    with here.database.reading() as session:
        assert len(SurveyRepository(session).photos(scene.survey_id)) == len(PHOTOS) - 1


def array(*values: float) -> str:
    return base64.b64encode(np.array(values, dtype="<f8").tobytes()).decode()


def setting(archive: bytes, table: str, column: str, value: Any) -> bytes:
    """The archive with one value of the first row of a table replaced."""
    with ArchiveReader(io.BytesIO(archive)) as reader:
        (columns,) = (member.columns for member in reader.manifest.tables if member.name == table)

    def change(name: str, rows: list[list[Any]]) -> list[list[Any]]:
        if name == table:
            rows[0][columns.index(column)] = value
        return rows

    return changed(archive, change)


NOBODYS = "01900000-0000-7000-8000-000000000000"  # an id of nothing; the same in every process that collects tests

SEEN = {"targets": [], "rejected": [], "timing_ms": []}
FIT = {"sigma0": 1.0, "redundancy": 3, "rms_residual_px": 0.1, "camera_source": "survey", "ambiguity_ratio": None}
UNSOUND: list[tuple[str, str, Any]] = [
    ("sites", "id", "not-an-id"),
    ("sites", "id", "../../etc/passwd"),
    ("sites", "name", "x" * 201),
    ("sites", "name", "\u0007"),
    ("sites", "code_family", "of my own"),
    ("sites", "plate_u_m", 0.0),
    ("sites", "plate_u_m", "nan"),
    ("sites", "created_s", 1e300),
    ("sites", "active_version", 7),
    ("sites", "geo_anchor", {"latitude_deg": "48", "longitude_deg": 11.0}),
    ("sites", "geo_anchor", {"latitude_deg": 480.0, "longitude_deg": 11.0}),
    ("sites", "geo_anchor", ["48", "11"]),
    ("control_points", "site_id", NOBODYS),
    ("control_points", "dot", "Z"),
    ("control_points", "code", 390),
    ("control_points", "sigma_m", -1.0),
    ("print_batches", "codes", [390]),
    ("print_batches", "bar_across_mm", 0.0),
    ("surveys", "site_id", NOBODYS),
    ("photographs", "survey_id", NOBODYS),
    ("photographs", "name", "../../etc/passwd"),
    ("photographs", "sha256", "../" * 21 + "x"),
    ("photographs", "sha256", "0" * 64),
    ("detections", "sha256", "0" * 64),
    ("detections", "record", base64.b64encode(b"no arrays").decode()),
    ("target_maps", "site_id", NOBODYS),
    ("target_maps", "version", 0),
    ("target_maps", "target_count", 99),
    ("target_maps", "base_version", 5),
    ("target_maps", "code_family", "full"),
    ("target_maps", "u_m", -1.0),
    ("target_maps", "datum_origin", array(1.0)),
    ("target_maps", "datum_covariance", array(*range(49))),
    ("target_maps", "report", ["no", "object"]),
    ("mapped_targets", "map_id", NOBODYS),
    ("mapped_targets", "code", 390),
    ("mapped_targets", "rotation", array(2.0, 0, 0, 0, 1, 0, 0, 0, 1)),
    ("mapped_targets", "rotation", array(1.0, 0, 0, 0, 1, 0, 0, 0, -1)),
    ("mapped_targets", "position_m", array(1.0, float("nan"), 0.0)),
    ("mapped_targets", "dots_m", "AAAA"),
    ("mapped_targets", "rays", -1),
    ("map_photos", "covariance", array(*[-1.0] * 36)),
    ("cameras", "site_id", None),
    ("cameras", "source", "invented"),
    ("cameras", "identity", {"make": 5, "model": "", "width_px": 1280, "height_px": 720}),
    ("cameras", "identity", {"make": "a"}),
    ("cameras", "intrinsics", array(*[0.0] * 9)),
    ("trajectories", "snapshot_count", 2),
    ("trajectories", "failures", {"too-few-dots": "many"}),
    ("trajectories", "first_s", -1.0),
    ("snapshots", "trajectory_id", NOBODYS),
    ("snapshots", "ordinal", 9),
    ("snapshots", "site_id", NOBODYS),
    ("snapshots", "seen", {}),
    ("snapshots", "seen", {**SEEN, **FIT, "targets": [{"code": "389", "corrected": 0, "rms_px": 1.0, "used": True}]}),
    ("snapshots", "seen", {**SEEN, **FIT, "sigma0": "one"}),
    ("snapshots", "seen", {**SEEN, **FIT, "timing_ms": [[1, 2, 3]]}),
    ("trajectories", "imported_count", 3),
    ("trajectories", "source", {"format": "tum"}),
    ("imported_poses", "trajectory_id", NOBODYS),
    ("imported_poses", "ordinal", 2),
    ("imported_poses", "pose_count", 49),
    ("imported_poses", "greatest_x_m", 99.0),
    ("imported_poses", "times_s", array(*[1.0] * 50)),
    ("imported_poses", "orientations_xyzw", None),
    ("imported_poses", "orientations_xyzw", array(*[2.0] * 200)),
]


@pytest.fixture(scope="module")
def shared(sqlite: Databases, tmp_path_factory: pytest.TempPathFactory) -> Iterator[SiteTarget]:
    """One target for all that is refused: it stays empty."""
    database = Database(sqlite.migrated())
    yield target_in(database, tmp_path_factory.mktemp("refused"))
    database.close()


@pytest.mark.parametrize(("table", "column", "value"), UNSOUND)
def test_what_no_installation_would_have_written_is_refused(
    archive: bytes, shared: SiteTarget, table: str, column: str, value: Any
) -> None:
    with pytest.raises(BadArchive):
        imported(setting(archive, table, column, value), shared)
    assert not any(rows_of(shared.database).values())
    assert list(shared.photos.photos()) == []
    assert list(shared.limits.scratch.glob("import-*")) == []


def test_what_is_changed_in_these_tests_is_all_that_is_wrong(archive: bytes, here: SiteTarget) -> None:
    """The way that unsound archives are made makes sound ones too."""
    imported(setting(archive, "sites", "name", "another name"), here)


@pytest.mark.parametrize(
    "photos",
    [
        {sha256_of(PHOTOS["IMG_0.jpg"]): jpeg(77)},  # belongs to no survey
        {sha256_of(PHOTOS["IMG_0.jpg"]): b"no photograph"},
    ],
)
def test_photographs_that_cannot_be_taken(archive: bytes, shared: SiteTarget, photos: dict[str, bytes | None]) -> None:
    (old, data), *_ = photos.items()
    assert data is not None
    named = sha256_of(data) if data == b"no photograph" else old

    def rename(_table: str, rows: list[list[Any]]) -> list[list[Any]]:
        return [[named if value == old else value for value in row] for row in rows]

    with pytest.raises(BadArchive, match="photograph"):
        imported(changed(archive, rename, photos), shared)
    assert list(shared.photos.photos()) == []


def test_two_sites_or_none(archive: bytes, shared: SiteTarget) -> None:
    def doubled(table: str, rows: list[list[Any]]) -> list[list[Any]]:
        return [*rows, [new_id(), *rows[0][1:]]] if table == "sites" else rows

    with pytest.raises(BadArchive, match="holds 2"):
        imported(changed(archive, doubled), shared)
    nothing = dict.fromkeys((sha256_of(data) for data in PHOTOS.values()), None)
    with pytest.raises(BadArchive, match="holds 0"):
        imported(changed(archive, lambda _table, _rows: [], nothing), shared)


def test_a_bomb_in_an_archive_and_one_in_a_detection(archive: bytes, shared: SiteTarget) -> None:
    small = replace(shared, limits=replace(shared.limits, max_unpacked_bytes=1000))
    with pytest.raises(BadArchive, match="unpacks to"):
        imported(archive, small)
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as npz:
        npz.writestr("size_px.npy", bytes(2**26 + 1))
    bomb = base64.b64encode(out.getvalue()).decode()
    with pytest.raises(BadArchive, match="a detection that unpacks"):
        imported(setting(archive, "detections", "record", bomb), shared)


def test_an_import_that_is_interrupted_leaves_nothing(archive: bytes, here: SiteTarget) -> None:
    def interrupt(stage: str, done: int, total: int) -> None:
        if (stage, done) == ("tables", total):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        import_site(io.BytesIO(archive), here, interrupt)
    assert not any(rows_of(here.database).values())
    assert list(here.photos.photos()) == []


def test_a_whole_installation_is_no_site(scene: Scene, here: SiteTarget, tmp_path: Path) -> None:
    back_up(scene.database, scene.photos, tmp_path / "b.zip", quiet)
    with pytest.raises(BadArchive, match="scattermark restore"):
        imported((tmp_path / "b.zip").read_bytes(), here)


def test_a_photograph_that_is_in_use_outlives_an_import_that_fails(archive: bytes, here: SiteTarget) -> None:
    """Another site's upload may have the same bytes."""
    used = sha256_of(PHOTOS["IMG_0.jpg"])
    with here.database.writing() as session:
        site_id = SiteRepository(session).add("another", "golay", 0.01, None).site_id
        survey_id = SurveyRepository(session).add(site_id, "", None).survey_id
        SurveyRepository(session).add_photo(survey_id, photo("mine.jpg", used))
    with pytest.raises(BadArchive):
        imported(setting(archive, "snapshots", "seen", {}), here)
    assert [item.name for item in here.photos.photos()] == [used]


def test_a_photograph_that_a_purge_takes_meanwhile_is_put_back(archive: bytes, here: SiteTarget) -> None:
    taken = sha256_of(PHOTOS["IMG_0.jpg"])

    def purge(stage: str, done: int, total: int) -> None:
        if (stage, done) == ("tables", total):
            here.photos.delete(taken)

    import_site(io.BytesIO(archive), here, purge)
    assert here.photos.read(taken) == PHOTOS["IMG_0.jpg"]


def test_few_transfers_at_a_time(scene: Scene, here: SiteTarget) -> None:
    transfers = SiteTransfers(scene.database, scene.photos, here.budget, TransferLimits(here.limits, at_once=1))
    reading = transfers.export(scene.site_id)
    with pytest.raises(ServerFull) as refusal:
        transfers.export(scene.site_id)
    assert refusal.value.fields["retry_after_s"] > 0
    with ArchiveReader(io.BytesIO(b"".join(reading))) as whole:  # which frees the place
        whole.verify(quiet)
    assert b"".join(transfers.export(scene.site_id))
