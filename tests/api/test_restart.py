"""The server killed in the middle of a build: after a restart the books are in order and the build can be repeated."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import httpx

from app.settings import Settings
from tests.api.serving import Served, room_photos, serve

START_S = 60.0
FEW = ("IMG_0000.jpg", "IMG_0001.jpg", "IMG_0013.jpg", "IMG_0015.jpg", "IMG_0011.jpg", "IMG_0003.jpg")


def test_a_killed_server_leaves_a_failed_job_and_nothing_half_written(tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path, locate_workers=1, build_workers=1)
    photos = room_photos("survey")
    environment = {**os.environ, "SCATTERMARK_LOCATE_WORKERS": "1", "SCATTERMARK_BUILD_WORKERS": "1"}
    command = [sys.executable, "-m", "app.cli", "serve", "--port", "0", "--data-dir", str(tmp_path)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
    try:
        assert process.stdout is not None
        url = process.stdout.readline().split()[-1]
        with httpx.Client(base_url=url, timeout=START_S) as client:
            doomed = Served(client, settings, None)  # type: ignore[arg-type]
            site_id = doomed.new_site()
            survey_id = doomed.new_survey(site_id)
            for name in FEW:
                assert doomed.put_photo(survey_id, name, photos[name]).status_code == 201
            job_id = client.post(f"/surveys/{survey_id}/build").json()["job_id"]
            while client.get(f"/jobs/{job_id}").json()["state"] == "queued":
                time.sleep(0.01)
    finally:
        os.kill(process.pid, signal.SIGKILL)
        process.communicate()
    with serve(settings) as served:
        job = served.client.get(f"/jobs/{job_id}").json()
        assert (job["state"], job["error"]["type"].rsplit("/", 1)[1]) == ("failed", "build-interrupted")
        assert "start the build again" in job["error"]["detail"]
        assert served.client.get(f"/sites/{site_id}/maps").json()["maps"] == []
        assert served.build(survey_id)["state"] == "succeeded"
