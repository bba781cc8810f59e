"""Jobs over HTTP: listed and tried again. Their way through the workers is told in test_survey_story."""

from __future__ import annotations

from app.storage.jobs import JobRepository
from tests.api.conftest import SurveyedRoom
from tests.api.serving import Served, assert_problem, room_photos


def waiting_job(served: Served) -> tuple[str, str]:
    """A site, and a job of it that nobody takes."""
    site_id = served.new_site()
    survey_id = served.new_survey(site_id)
    with served.services.database.writing() as session:
        job = JobRepository(session).add("build", site_id, survey_id, {})
        JobRepository(session).fail(job.run, {"slug": "survey-failed", "detail": "no overlap", "fields": {}})
    return site_id, job.job_id


def test_jobs_are_listed_newest_first_by_site_and_state(served: Served) -> None:
    site_id, failed = waiting_job(served)
    other_site, other = waiting_job(served)

    def ids(**query: str) -> list[str]:
        answer = served.client.get("/jobs", params=query)
        assert answer.status_code == 200, answer.text
        return [job["job_id"] for job in answer.json()["jobs"]]

    assert ids(limit="2") == [other, failed]
    assert ids(site_id=site_id) == [failed]
    assert ids(site_id=site_id, state="failed") == [failed]
    assert ids(site_id=other_site, state="running") == []
    first = served.client.get("/jobs", params={"limit": "1"}).json()
    assert ids(limit="1", cursor=first["next_cursor"]) == [failed]
    assert_problem(served.client.get("/jobs", params={"state": "asleep"}), 422, "invalid-input")


def test_a_job_that_failed_is_tried_again_with_what_was_detected(served: Served) -> None:
    survey_id = served.new_survey(served.new_site())
    for name, data in list(room_photos("survey").items())[::8]:  # too far apart: they share no target
        assert served.put_photo(survey_id, name, data).status_code == 201
    job = served.build(survey_id)
    assert job["state"] == "failed", job
    again = served.client.post(f"/jobs/{job['job_id']}/retry")
    assert again.status_code == 202, again.text
    assert (again.json()["job_id"], again.json()["state"], again.json()["error"]) == (job["job_id"], "queued", None)
    repeated = served.wait(job["job_id"])
    assert (repeated["state"], repeated["error"]) == ("failed", job["error"])


def test_what_has_succeeded_is_not_tried_again(served: Served, room: SurveyedRoom) -> None:
    assert_problem(served.client.post("/jobs/nowhere/retry"), 404, "not-found")
    refused = assert_problem(served.client.post(f"/jobs/{room.job['job_id']}/retry"), 409, "conflict")
    assert "start a new build" in refused["detail"]
