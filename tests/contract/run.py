"""schemathesis against a running service: its command line, a configuration that knows what is stored."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from app.storage.target_maps import TargetMapRepository
from tests.api.bad_photos import encoded
from tests.api.serving import Served
from tests.contract.hooks import OWN_KEY
from tests.storage.examples import publication

CHECKOUT = Path(__file__).parents[2]
HOOKS = "tests.contract.hooks"
HALF = 0.5  # of the requests name what is stored, the others what is not
PHOTO_PX = (120, 160, 3)


@dataclass(frozen=True)
class Stored:
    """Ids that requests may name."""

    site_id: str
    survey_id: str
    job_id: str
    trajectory_id: str


def store_examples(served: Served) -> Stored:
    """A site with a map and a survey, a job that has ended, a trajectory that is closed: its events end."""
    site_id = served.new_site()
    survey_id = served.new_survey(site_id)
    with served.services.database.writing() as session:
        maps = TargetMapRepository(session)
        maps.activate(site_id, maps.publish(site_id, publication(site_id, survey_id)))
    for seed in range(2):
        noise = np.random.default_rng(seed).integers(0, 255, PHOTO_PX, np.uint8)
        assert served.put_photo(survey_id, f"{seed}.jpg", encoded(noise, "JPEG")).status_code == 201
    job_id = served.build(survey_id)["job_id"]
    trajectory_id = served.client.post("/trajectories", json={"site_id": site_id}).json()["trajectory_id"]
    assert served.client.post(f"/trajectories/{trajectory_id}/close").status_code == 200
    return Stored(site_id, survey_id, job_id, trajectory_id)


def configuration(stored: Stored, folder: Path) -> str:
    """A schemathesis.toml: what is stored is named often, and never deleted."""
    dictionaries = [f"dictionaries.{name}.values = [{json.dumps(value)}]" for name, value in vars(stored).items()]
    bindings = [f'"path.{name}" = {{ dictionary = "{name}", probability = {HALF} }}' for name in vars(stored)]
    bindings.append(f'"query.site_id" = {{ dictionary = "site_id", probability = {HALF} }}')
    return "\n".join(
        [
            f"cache.directory = {json.dumps(str(folder / 'cache'))}",
            f"hooks = {json.dumps(HOOKS)}",
            *dictionaries,
            "[[operations]]",
            'exclude-method = "DELETE"',
            "[operations.parameters]",
            *bindings,
        ]
    )


def hold_to_contract(served: Served, folder: Path, examples: int, seed: int | None) -> subprocess.CompletedProcess[str]:
    """Run all checks of all phases over all operations with the client's key; the return code is 0 when none failed."""
    config = folder / "schemathesis.toml"
    config.write_text(configuration(store_examples(served), folder))
    document = str(served.client.base_url.join("/openapi.json"))
    scope = ["--max-examples", str(examples), "--continue-on-failure", "--generation-database", "none", "--no-color"]
    # A fixed seed is for the suite, which has no time for fuzzing.
    fixed = [] if seed is None else ["--seed", str(seed), "--phases", "examples,coverage,stateful"]
    shown = ["--header", f"Authorization: {served.client.headers['Authorization']}"]
    environment = {**os.environ, OWN_KEY: served.client.get("/session").json()["key_id"]}
    run = [sys.executable, "-m", "schemathesis.cli", "--config-file", str(config), "run", document]
    return subprocess.run(
        [*run, *scope, *fixed, *shown], cwd=CHECKOUT, env=environment, capture_output=True, text=True, check=False
    )
