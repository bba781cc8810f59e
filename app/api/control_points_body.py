"""Control points come as a JSON list or as CSV; both become rows by column name."""

from __future__ import annotations

import asyncio
import json

from fastapi import HTTPException, Request

from app.errors import InvalidControlPoints
from app.services.control_points import Records, records_of_csv

CSV_TYPES = ("text/csv", "text/plain", "application/csv")
JSON_TYPES = ("application/json", "")


async def control_records(request: Request) -> Records:
    """Rows of the request's body.

    Raises
    ------
    InvalidControlPoints
        For a body that is not what its content type says.
    HTTPException
        415 for any other content type.
    """
    media_type = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if media_type not in (*CSV_TYPES, *JSON_TYPES):
        raise HTTPException(415, f"control points come as application/json or text/csv, not as {media_type}")
    try:
        text = (await request.body()).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InvalidControlPoints("the control points are not UTF-8 text; save the file as UTF-8") from error
    return await asyncio.to_thread(records_of_csv if media_type in CSV_TYPES else _records_of_json, text)


def _records_of_json(text: str) -> Records:
    try:
        records = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InvalidControlPoints(
            f"the control points are no JSON ({error}); send a list of rows, or CSV as text/csv"
        ) from error
    if not isinstance(records, list) or not all(isinstance(record, dict) for record in records):
        raise InvalidControlPoints("control points are a JSON list of rows: [{name, code, dot, x_m, ...}, ...]")
    return records
