"""The story once more with photographs in an object store: uploaded, built from, located, kept, purged."""

from __future__ import annotations

import hashlib
from pathlib import Path

from app.settings import Settings
from tests.api.serving import room_control_points, room_photos, serve
from tests.object_stores import S3Server


def test_from_an_empty_bucket_to_a_kept_picture(s3: S3Server, tmp_path: Path, snapshot: bytes) -> None:
    settings = Settings(data_dir=tmp_path, photographs_url=s3.new_url(), locate_workers=1, build_workers=2)
    with serve(settings) as served:
        site_id = served.new_site(keep_snapshots=True)
        served.put_control_points(site_id, room_control_points())
        survey_id = served.new_survey(site_id)
        sent = room_photos("survey")
        for name, data in sent.items():
            assert served.put_photo(survey_id, name, data).status_code == 201
            assert served.put_photo(survey_id, name, data).status_code == 200
        job = served.build(survey_id)
        assert job["state"] == "succeeded", job
        located = served.locate(site_id, snapshot)
        assert located.status_code == 200, located.text
        picture = served.client.get(f"/poses/{located.json()['pose_id']}/image")
        assert (picture.status_code, picture.content) == (200, snapshot)
        assert served.client.get("/readyz").json()["checks"]["photographs"] == "ok"
        usage = served.client.get("/storage").json()
        assert usage["used_bytes"] == sum(map(len, sent.values())) + len(snapshot)
        photos = served.services.intake.store
        digests = {hashlib.sha256(data).hexdigest() for data in (*sent.values(), snapshot)}
        assert {item.name for item in photos.photos()} == digests
    assert not (tmp_path / "photographs").exists()
