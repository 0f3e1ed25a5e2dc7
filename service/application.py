"""What is joined at the start and every request can reach, as ``app.state.application``."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import datetime
from functools import cached_property

from fastapi import Request

from service.background.bell import Bell
from service.background.job_desk import JobDesk
from service.background.read_diagnosis import Reader
from service.background.read_group import GroupReader
from service.errors import BusyError
from service.identity.elsewhere import Provider
from service.metrics import Metrics
from service.reports.sealing import Seal
from service.settings import Settings
from service.storage import Storage

SMALL_BODY = 1024 * 1024
"""Bytes of an upload that needs no place: a session of positions has a hundredth."""


class Places:
    """Of large uploads: each holds its bytes in memory. Used by the event loop alone, so it needs no lock."""

    def __init__(self) -> None:
        self._taken = 0

    @contextmanager
    def one_for(self, length: str, most: int) -> Iterator[None]:
        """A place for an upload of this announced length, until it is worked on; BusyError where all are taken."""
        if length.isdecimal() and int(length) <= SMALL_BODY:
            yield
            return
        if self._taken >= most:
            raise BusyError("Too many large files are being received; nothing of this one was stored. Send it again.")
        self._taken += 1
        try:
            yield
        finally:
            self._taken -= 1


class Gate:
    """Whether everybody may do everything: on this machine alone, until the first account is made."""

    def __init__(self, settings: Settings) -> None:
        self._settings, self._has_accounts = settings, False

    @property
    def may_be_open(self) -> bool:
        """Whether there are times at which nobody needs to sign in."""
        return self._settings.sign_in == "off" or (self._settings.sign_in == "auto" and self._settings.is_local)

    def is_open(self, storage: Storage) -> bool:
        """Asks the database until there is an account; accounts are never deleted."""
        if not self.may_be_open or self._settings.sign_in == "off":
            return self.may_be_open
        if not self._has_accounts:
            with storage.database.reading() as store:
                self._has_accounts = store.accounts.any()
        return not self._has_accounts


@dataclass(frozen=True)
class Application:
    """What `create_app` joins."""

    settings: Settings
    storage: Storage
    clock: Callable[[], datetime]
    gate: Gate
    seal: Seal | None = None
    provider: Provider | None = None
    bell: Bell = field(default_factory=Bell)
    metrics: Metrics = field(default_factory=Metrics)
    places: Places = field(default_factory=Places)

    @cached_property
    def diagnoses(self) -> Reader:
        """The diagnoses of sessions, for whoever reads them."""
        own = self.settings
        return Reader(self.storage, self.clock, self.bell, self.metrics, own.coverage_factor, own.diagnosis_workers)

    @cached_property
    def groups(self) -> GroupReader:
        """What groups of sessions show, for whoever reads it."""
        return GroupReader(self.storage, self.clock, self.bell, self.metrics, self.settings.diagnosis_workers)

    @cached_property
    def jobs(self) -> JobDesk:
        """Where long work is asked for."""
        own = self.settings
        return JobDesk(self.clock, self.bell, self.metrics, own.coverage_factor, own.diagnosis_workers)


def application_of(request: Request) -> Application:
    """The application that a request came to."""
    application: Application = request.app.state.application
    return application
