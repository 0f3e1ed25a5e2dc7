"""Services that hold something already: each is filled once, over HTTP or by a function, and copied for every test that
asks for it."""

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from uuid import uuid4

from service.app import create_app
from service.opening import open_database
from service.settings import Settings
from service.storage import Files, Storage
from tests.databases import Databases
from tests.serving import http_client

Uploads = tuple[bytes, ...]
"""Session files in the order in which they are uploaded."""
Fill = Callable[[Settings], object]
"""Stores something in the service of these settings."""


@contextmanager
def stores(settings: Settings) -> Iterator[Storage]:
    """The stores of a service, without the service."""
    database = open_database(settings.database)
    yield Storage(database, Files(settings.files))
    database.close()


class Stock:
    """Filled services of one engine, each made of the one that lacks its last upload."""

    def __init__(self, databases: Databases, folder: Path) -> None:
        self._databases, self._folder = databases, folder
        self._filled: dict[object, Settings] = {}

    @contextmanager
    def holding(self, *uploads: bytes, diagnosed: bool = False) -> Iterator[Settings]:
        """Settings of a new service that holds the uploads, which diagnoses what is read; its database is dropped at
        the end. ``diagnosed``: each was read before the next came."""
        settings = self._copy(uploads, diagnosed)
        yield settings
        self._databases.drop(settings.database)

    @contextmanager
    def filled(self, fill: Fill) -> Iterator[Settings]:
        """Settings of a new service that a function has filled."""
        if fill not in self._filled:
            settings = self._copy((), diagnosed=False)
            fill(settings)
            self._filled[fill] = settings
        settings = self._copied(self._filled[fill])
        yield settings
        self._databases.drop(settings.database)

    def _copy(self, uploads: Uploads, diagnosed: bool) -> Settings:
        if not uploads:
            return self._settings(self._databases.migrated())
        return self._copied(self._original(uploads, diagnosed))

    def _copied(self, original: Settings) -> Settings:
        copy = self._settings(self._databases.copied(original.database))
        if original.files.exists():
            shutil.copytree(original.files, copy.files)
        return copy

    def _original(self, uploads: Uploads, diagnosed: bool) -> Settings:
        if (uploads, diagnosed) not in self._filled:
            settings = self._copy(uploads[:-1], diagnosed)
            with http_client(create_app(settings)) as client:
                answer = client.post("/api/v1/sessions", content=uploads[-1]).raise_for_status()
                if diagnosed:
                    client.get(f"/api/v1/sessions/{answer.json()['id']}/diagnosis").raise_for_status()
            self._filled[uploads, diagnosed] = settings
        return self._filled[uploads, diagnosed]

    def _settings(self, url: str) -> Settings:
        return Settings(database_url=url, data_folder=self._folder / uuid4().hex)
