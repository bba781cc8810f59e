"""The OpenAPI document is a promise: schemathesis calls the running service with what fits it and what does not."""

from __future__ import annotations

import os
from pathlib import Path

from app.settings import Settings
from tests.api.guarding import ADMIN_SECRET
from tests.api.serving import serve
from tests.contract.run import hold_to_contract

# `make contract` asks for many, each time others.
EXAMPLES = os.environ.get("SCATTERMARK_CONTRACT_EXAMPLES")
FEW = 4
SEED = 20_260_501


def test_every_answer_is_one_that_the_document_promises(tmp_path: Path) -> None:
    settings = Settings(
        data_dir=tmp_path / "data",
        locate_workers=1,
        build_workers=1,
        require_keys=True,
        bootstrap_key=ADMIN_SECRET,
        key_rate_per_s=100_000.0,
    )
    with serve(settings) as served:
        served.client.headers["Authorization"] = f"Bearer {ADMIN_SECRET}"
        examples, seed = (int(EXAMPLES), None) if EXAMPLES else (FEW, SEED)
        run = hold_to_contract(served, tmp_path, examples, seed)
        assert run.returncode == 0, run.stdout + run.stderr
        assert served.client.get("/readyz").status_code == 200
