"""The page that Prometheus reads."""

from __future__ import annotations

from functools import partial

from fastapi import Response
from prometheus_client import CONTENT_TYPE_LATEST, generate_latest

from app.errors import TimedOut
from app.services.bounded import Bounded
from app.services.metrics_of_process import process_registry

PATIENCE_S = 8.0  # Prometheus waits ten by default


class MetricsPage:
    """All metrics of one application, its process's own among them.

    Attributes
    ----------
    registry : CollectorRegistry
        What is on the page.
    """

    def __init__(self) -> None:
        self.registry = process_registry()
        self._text = Bounded(partial(generate_latest, self.registry), PATIENCE_S)

    async def answer(self) -> Response:
        """The page in Prometheus's text format.

        Raises
        ------
        TimedOut
            When what is counted on request did not come in time.
        """
        try:
            text = await self._text.outcome()
        except TimeoutError as error:
            raise TimedOut("the metrics could not be collected in time; ask /readyz what hangs") from error
        return Response(text, media_type=CONTENT_TYPE_LATEST)
