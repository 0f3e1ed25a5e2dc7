"""Uploads are refused while there is still some space, so that the database never meets a full disk."""

from pathlib import Path

from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from service.kit.log import log
from service.storage.folders import space_at
from service.web.bodies import UPLOADS
from service.web.problems import problem

FULL = 507


class RoomForUploads:
    """Checks the disk before an upload is read."""

    def __init__(self, app: ASGIApp, folder: Path, least: int) -> None:
        self.app = app
        self.folder, self.least = folder, least

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Passes everything but uploads without enough space."""
        if scope["type"] != "http" or scope["method"] != "POST" or scope["path"] not in UPLOADS:
            await self.app(scope, receive, send)
            return
        announced = int(Headers(scope=scope).get("content-length", "0"))
        space = await run_in_threadpool(space_at, self.folder, self.least + announced)
        if space.too_little is None:
            await self.app(scope, receive, send)
            return
        log.warning("upload refused for want of room", free=space.free, least=space.least)
        await problem(FULL, space.too_little)(scope, receive, send)
