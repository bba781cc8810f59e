from __future__ import annotations

from app.storage.database import Database
from app.storage.figures import StoredFigures, stored_figures
from app.storage.jobs import JobRepository
from app.storage.surveys import SurveyRepository
from app.storage.workers import WorkerRepository
from tests.storage import examples

SHA256 = ("a" * 64, "b" * 64)


def test_an_empty_database_has_nothing(database: Database) -> None:
    with database.reading() as session:
        figures = stored_figures(session)
    assert figures == StoredFigures({}, None, 0, {}, 0, 0, 0)


def test_jobs_are_counted_by_state_and_the_oldest_that_waits_is_known(database: Database) -> None:
    site, survey_id = examples.site_with_survey(database)
    with database.writing() as session:
        jobs = JobRepository(session)
        first, second, _ = (jobs.add("build", site.site_id, survey_id, {}) for _ in range(3))
        jobs.cancel(first.job_id)
        figures = stored_figures(session)
    assert dict(figures.jobs) == {("build", "cancelled"): 1, ("build", "queued"): 2}
    assert figures.oldest_queued_s == second.created_s


def test_the_same_bytes_in_two_surveys_are_counted_once(database: Database) -> None:
    (_, first), (_, second) = examples.site_with_survey(database), examples.site_with_survey(database)
    with database.writing() as session:
        surveys = SurveyRepository(session)
        surveys.add_photo(first, examples.photo("a.jpg", SHA256[0]))
        surveys.add_photo(first, examples.photo("b.jpg", SHA256[1]))
        surveys.add_photo(second, examples.photo("c.jpg", SHA256[0]))
        figures = stored_figures(session)
    assert (figures.photographs, figures.stored_bytes) == (2, 2 * examples.photo().size_bytes)


def test_workers_are_counted_until_they_leave(database: Database) -> None:
    with database.writing() as session:
        workers = WorkerRepository(session)
        first, _ = (workers.add(name, name) for name in ("one/0", "two/0"))
        assert stored_figures(session).live_workers == 2
        workers.leave(first)
        assert stored_figures(session).live_workers == 1
