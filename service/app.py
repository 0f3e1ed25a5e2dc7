"""The application, assembled from all subjects."""

from collections.abc import AsyncIterator, Callable, Iterable, Iterator
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from datetime import UTC, datetime
from threading import Event, Thread

from fastapi import FastAPI
from fastapi.concurrency import run_in_threadpool

from service import all_api, all_pages
from service.flags.mail import MailServer
from service.flags.messages import Ways, deliver_until
from service.kit import limits
from service.kit.bell import Bell
from service.kit.filling import Filling
from service.kit.guard import Guard
from service.kit.metrics import Metrics
from service.opening import open_storage
from service.papers.sealing import Seal, seal_of
from service.people.admission import Gate
from service.people.provider import provider_of
from service.settings import VERSION, Settings
from service.web import guard
from service.web.application import Application
from service.web.headers import HeadAsGet
from service.web.measured import RequestLog
from service.web.turns import PasswordTurns, RegisterTurns
from service.work.job_desk import JobDesk
from service.work.loop import Worker, summarise_waiting, take_in_waiting, work_in_background
from service.work.readers import GroupReader, Reader
from service.work.watch import ask_for_missing, derive_pending, watch_fleet

DESCRIPTION = (
    "Health of redundant inertial measurement units: calibration sessions in, parameters with uncertainties, "
    "verdicts and histories out. Numbers are SI; every error is application/problem+json."
)
"""Heads the description of the API."""
LAST_WORK = 5.0
"""Seconds that a stopping service waits for the current message; the next start takes up the rest."""


def utc_now() -> datetime:
    """The clock."""
    return datetime.now(UTC)


def create_app(
    settings: Settings,
    clock: Callable[[], datetime] = utc_now,
    most: limits.Limits | None = None,
    filling: Filling | None = None,
) -> FastAPI:
    """The service on the database and the folder in the settings; the schema must be up to date. ``most``: limits
    instead of those of the settings' machine, for tests; ``filling``: sessions to store beside the first requests.
    """
    limits.use(most or limits.limits_of(settings))
    application = _application(settings, clock, {} if filling is None else {Filling: filling})
    app = FastAPI(
        title="imu-health",
        version=VERSION,
        description=DESCRIPTION,
        docs_url=None,
        redoc_url=None,
        lifespan=_at_work(application),
    )
    app.state.application = application
    all_api.mount(app)
    guard(app, settings)
    all_pages.mount(app)
    app.add_middleware(HeadAsGet)
    app.add_middleware(RequestLog, metrics=application.metrics)
    return app


def _application(settings: Settings, clock: Callable[[], datetime], optional: dict[type, object]) -> Application:
    metrics, bell = Metrics(), Bell()
    storage = open_storage(settings, metrics.count_file_fault)
    k, workers = settings.coverage_factor, settings.diagnosis_workers
    parts = optional | {
        Gate: Gate(settings, provider_of(settings)),
        Reader: Reader(storage, clock, bell, metrics, k, workers),
        GroupReader: GroupReader(storage, clock, bell, metrics, workers),
        PasswordTurns: PasswordTurns(),
        RegisterTurns: RegisterTurns(),
        JobDesk: JobDesk(clock, bell, metrics, k, workers),
    }
    seal = seal_of(settings.seal_key_file, settings.seal_password_file)
    if seal is not None:
        parts[Seal] = seal
    return Application(settings, storage, clock, bell, metrics, parts)


def _at_work(application: Application) -> Callable[[FastAPI], AbstractAsyncContextManager[None]]:
    """The lifespan of the service: work is done in the background from start to stop, and the database is closed at the
    end.
    """

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        stop = Event()
        at_once, later = (
            [Thread(target=work, args=(*args, stop), name=name, daemon=True) for name, work, args in found]
            for found in (_requested(application), _unasked(application))
        )
        fill = Thread(target=_fill, args=(application, later, stop), name="filling", daemon=True)
        for thread in (*at_once, fill):
            thread.start()
        yield
        stop.set()
        application.bell.ring()
        for thread in (fill, *at_once, *later):
            if thread.ident is not None:
                await run_in_threadpool(thread.join, LAST_WORK)
        application.storage.database.close()

    return lifespan


def _fill(application: Application, threads: Iterable[Thread], stop: Event) -> None:
    """Stores the sessions that are to be stored, and begins the work that looks at everything stored."""
    filling = application.find(Filling)
    if filling is not None:
        with Guard(application.metrics).alone("filling", ""):
            filling.run(stop)
        application.bell.ring()
    for thread in threads:
        thread.start()


Work = tuple[str, Callable[..., None], tuple[object, ...]]
"""Name, function and arguments of a thread."""


def _requested(application: Application) -> Iterator[Work]:
    """Work that people ask for: it waits for nothing."""
    ways = _ways(application.settings)
    for number in range(application.settings.diagnosis_workers):
        yield f"diagnoses {number}", work_in_background, (_worker(application),)
    if application.settings.diagnosis_workers:
        yield "uploads", take_in_waiting, (_worker(application),)
    else:
        yield "summaries", summarise_waiting, (_worker(application),)
    if ways.hosts or ways.mail.is_there:
        yield "outbox", deliver_until, (application.storage, ways, application.clock, application.metrics)


def _unasked(application: Application) -> Iterator[Work]:
    """Work that looks at everything stored for what is missing."""
    storage, clock, metrics = application.storage, application.clock, application.metrics
    if application.settings.diagnosis_workers:
        yield "missing diagnoses", ask_for_missing, (storage, clock, metrics, application.bell)
    yield "pending derivations", derive_pending, (storage, application.settings.coverage_factor, clock, metrics)
    yield "fleet", watch_fleet, (storage, clock, metrics)


def _ways(settings: Settings) -> Ways:
    mail = MailServer(settings.mail_host, settings.mail_port, settings.mail_from, settings.mail_security)
    return Ways(settings.webhook_hosts, mail)


def _worker(application: Application) -> Worker:
    settings, storage, filling = application.settings, application.storage, application.find(Filling)
    return Worker(settings, storage, application.clock, application.metrics, application.bell, filling)
