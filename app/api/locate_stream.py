"""Snapshots over a WebSocket: a frame per binary message in, one answer per frame out.

Frames are numbered from 0 in the order they come; each answer (what ``POST /locate`` answers, or a problem) names its
``frame``. One frame is worked on at a time and only the newest waits: an older one that waits is answered at once with
the problem ``frame-dropped``, so answers may come in another order than their frames.

What the address says (``site_id``, ``device_id``, ``trajectory_id``, ``camera_id``, ``camera``, the clock's offset)
holds for all frames. A text message before a frame, a JSON object with any of these but the site, or ``captured_at``
and ``snapshot_id``, holds for that frame alone; when it cannot be read, the frame is answered with the problem.

Memory is bounded: a message has at most 16 MiB (a larger one ends the stream with 1009), at most one frame is in work
and one waits, and who does not read its answers is not read from. When the client leaves, the frame in work is still
recorded.
"""

from __future__ import annotations

import asyncio
import json
import logging
from dataclasses import dataclass
from typing import Any

from fastapi import WebSocket
from fastapi.exceptions import RequestValidationError
from starlette.websockets import WebSocketDisconnect

from app.api.admission import admitted
from app.api.credentials import answered_subprotocol
from app.api.locate_body import checked_parameters
from app.api.problems import fault_problem, identified, invalid_problem, known_problem
from app.api.schemas.locate import LocateAnswer
from app.errors import FrameDropped, InvalidInput, NotAuthenticated, ScattermarkError
from app.services.locate import Locator
from app.services.newest_first import NewestFirst
from app.services.principal import Principal

log = logging.getLogger(__name__)

OF_ONE_FRAME = ("snapshot_id", "captured_at")  # fields that would be wrong for all others
# Whoever runs the server gives these to it; a larger message ends the stream with 1009, message too big.
FRAME_BYTES = 16 * 2**20  # twice what a phone's camera makes of 12 megapixels at its best quality
MESSAGES_AHEAD = 2  # of one client, that are received before they are read
WORDS_BYTES = 2**14  # of a text message; the longest that is right has about 2 kB
DROPPED = "a newer frame came before there was time for this one; send fewer frames, or smaller ones"
POLICY_VIOLATION = 1008  # RFC 6455, 7.4.1


@dataclass(frozen=True)
class Frame:
    """A frame, its number, and what the client said of it."""

    number: int
    photo: bytes
    words: str | None


async def answer_stream(websocket: WebSocket, principal: Principal, locator: Locator) -> None:
    """Answer a client's frames, once its address is found right.

    Raises
    ------
    NotFound, Conflict, InvalidInput, RequestValidationError
        Before the socket is accepted; the handshake is answered with the problem.
    """
    fields = dict(websocket.query_params)
    if named := [name for name in OF_ONE_FRAME if name in fields]:
        raise InvalidInput(f"{' and '.join(named)} cannot hold for all frames; send a text message before each frame")
    parameters = checked_parameters(fields, "query")
    principal.site(parameters.site_id)
    await locator.check(parameters.to_domain(b""))
    await FrameStream(websocket, locator, fields).run()


class FrameStream:
    """One client's frames; the address was found right and the socket is not accepted yet.

    Parameters
    ----------
    websocket : WebSocket
    locator : Locator
    fields : dict of str
        What the address says of all frames.
    """

    def __init__(self, websocket: WebSocket, locator: Locator, fields: dict[str, str]) -> None:
        self._websocket = websocket
        self._locator = locator
        self._fields = fields
        self._waiting: NewestFirst[Frame] = NewestFirst()
        self._sending = asyncio.Lock()

    async def run(self) -> None:
        """Answer frames until the client leaves or the server closes."""
        await self._websocket.accept(subprotocol=answered_subprotocol(self._websocket))
        answering = asyncio.create_task(self._answer_all())
        try:
            await self._read_all()
        finally:
            self._waiting.end()
            await answering

    async def _read_all(self) -> None:
        count, words = 0, None
        while (message := await self._websocket.receive())["type"] == "websocket.receive":
            if message.get("bytes") is None:
                words = str(message.get("text"))
                continue
            displaced = self._waiting.put(Frame(count, message["bytes"], words))
            count, words = count + 1, None
            if displaced is not None:
                dropped = FrameDropped(
                    "a newer frame came before there was time for this one; send fewer or smaller ones"
                )
                await self._send(displaced, known_problem(dropped))

    async def _answer_all(self) -> None:
        while (frame := await self._waiting.get()) is not None:
            try:
                await self._send(frame, await self._answer(frame))
            except NotAuthenticated as error:
                await self._hang_up(frame, error)

    async def _answer(self, frame: Frame) -> dict[str, Any]:
        try:
            principal = await admitted(self._websocket)  # each frame counts, and a key may have been revoked
            parameters = checked_parameters({**self._fields, **_words_of(frame)}, "frame")
            principal.site(parameters.site_id)
            snapshot = await self._locator.locate(parameters.to_domain(frame.photo))
            return LocateAnswer.of(snapshot).model_dump(mode="json")
        except NotAuthenticated:
            raise
        except ScattermarkError as error:
            return identified(known_problem(error))
        except RequestValidationError as error:
            return identified(invalid_problem(error))
        except Exception:
            log.exception("unexpected error")
            return identified(fault_problem())

    async def _send(self, frame: Frame, answer: dict[str, Any]) -> None:
        """Answer a frame; a client that has left does not hear it."""
        async with self._sending:
            try:
                await self._websocket.send_text(json.dumps({"frame": frame.number, **answer}, separators=(",", ":")))
            except (WebSocketDisconnect, RuntimeError):  # the latter when it was closed before, by either side
                log.debug("the client left before frame %d was answered", frame.number)

    async def _hang_up(self, frame: Frame, error: NotAuthenticated) -> None:
        await self._send(frame, known_problem(error))
        async with self._sending:
            await self._websocket.close(POLICY_VIOLATION, "the key opens nothing any more")
        self._waiting.end()


def _words_of(frame: Frame) -> dict[str, str]:
    """What the client said of this frame alone."""
    if frame.words is None:
        return {}
    try:
        said = json.loads(frame.words) if len(frame.words) <= WORDS_BYTES else None
    except (ValueError, RecursionError):
        said = None
    if not isinstance(said, dict) or "site_id" in said:
        raise InvalidInput(
            f"the text before a frame is a JSON object of at most {WORDS_BYTES} bytes with fields such as captured_at "
            "and snapshot_id, and without site_id, which the address names"
        )
    return {name: value if isinstance(value, str) else json.dumps(value) for name, value in said.items()}
