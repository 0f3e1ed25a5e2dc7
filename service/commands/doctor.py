"""`imu-health doctor`: checks the needs of the service on this machine, and advises where something is missing."""

import difflib
import os
import platform
import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from datetime import UTC, datetime, timedelta
from enum import StrEnum
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path
from typing import Annotated

import typer
from packaging.requirements import Requirement
from pydantic import ValidationError
from rich.markup import escape

from estimator.message import joined, say
from service.commands.console import print_json, screen
from service.commands.options import DatabaseUrl, DataFolder
from service.commands.speech import FAILED, translated
from service.errors import ServiceError
from service.kit.limits import limits_of
from service.opening import open_database
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.settings import PREFIX, VERSION, Settings, retired
from service.storage import Database
from service.storage.audit import Audit
from service.storage.engine import shown_url
from service.storage.folders import require_writable, space_at
from service.web.hosts import hosts_of

OTHER_VARIABLES = ("IMU_HEALTH_SERVER", "IMU_HEALTH_TOKEN", "IMU_HEALTH_PICTURES")
"""Variables that are read by commands and tests, not by the service."""
CLOCK_TOLERANCE = timedelta(seconds=5)
"""More than a busy machine takes to answer; due dates and tokens are kept to the second."""
SQLITE = "sqlite:///"


class CheckState(StrEnum):
    """Result of a check."""

    OK = "ok"
    WARN = "warn"
    """The service works; somebody should know."""
    FAIL = "fail"
    """Something does not work until it is corrected."""


MARKS = {CheckState.OK: say("ok"), CheckState.WARN: say("warn"), CheckState.FAIL: say("fail")}
COLOURS = {CheckState.OK: "green", CheckState.WARN: "yellow", CheckState.FAIL: "red"}


@dataclass(frozen=True)
class DoctorCheck:
    """One line."""

    what: str
    state: CheckState
    text: str
    remedy: str = ""
    """Advice; empty where nothing is needed."""


def program() -> Iterator[DoctorCheck]:
    """Python, this program, and its libraries."""
    yield DoctorCheck("python", CheckState.OK, f"{platform.python_version()}, {sys.executable}, imu-health {VERSION}")
    extras: dict[str, list[str]] = {}
    missing = []
    for requirement in map(Requirement, requires("imu-health") or ()):
        extra = re.search(r"extra == [\"']([\w-]+)[\"']", str(requirement.marker or ""))
        if extra is None or extra[1] != "test":
            fault = _fault_of_library(requirement)
            if fault and extra is None:
                missing.append(fault)
            elif fault and extra is not None:
                extras.setdefault(extra[1], []).append(fault)
    if missing:
        yield DoctorCheck(
            "libraries", CheckState.FAIL, joined("; ", missing), say("Install again: pip install -r requirements.lock")
        )
    else:
        yield DoctorCheck("libraries", CheckState.OK, say("all there, none too old"))
    for name, faults in extras.items():
        text = say("not installed ({faults}); needed only for what it adds", faults=joined("; ", faults))
        yield DoctorCheck(say("extra {name}", name=name), CheckState.OK, text)


def _fault_of_library(requirement: Requirement) -> str:
    """The reason why a library does not fit; empty where it does."""
    try:
        installed = version(requirement.name)
    except PackageNotFoundError:
        return say("{name} is missing", name=requirement.name)
    if requirement.specifier.contains(installed, prereleases=True):
        return ""
    wanted = requirement.specifier
    return say("{name} is {installed}, not {wanted}", name=requirement.name, installed=installed, wanted=wanted)


def variables(environment: Mapping[str, str]) -> Iterator[DoctorCheck]:
    """Unknown variables of the environment, most often misspelt."""
    known = {*(f"{PREFIX}{name.upper()}" for name in Settings.model_fields), *OTHER_VARIABLES}
    known |= retired(environment).keys()  # a failure of its own, with what stands in their place
    unknown = sorted(name for name in environment if name.upper().startswith(PREFIX) and name.upper() not in known)
    for name in unknown:
        similar = difflib.get_close_matches(name.upper(), known, 1)
        remedy = say("Remove it, or look its name up on the page of settings.")
        if similar:
            remedy = say("Did you mean {similar}?", similar=similar[0])
        yield DoctorCheck("settings", CheckState.WARN, say("{name} is no setting and has no effect", name=name), remedy)
    if not unknown:
        yield DoctorCheck("settings", CheckState.OK, say("every variable is known"))


def contradictions(settings: Settings) -> Iterator[DoctorCheck]:
    """Contradictory settings."""
    if settings.sign_in == "off" and not settings.is_local:
        text = say("nobody has to sign in, and {host} can be reached from other machines", host=settings.host)
        yield DoctorCheck("sign-in", CheckState.WARN, text, say("Set IMU_HEALTH_SIGN_IN=required."))
    if hosts_of(settings).any_address:
        yield DoctorCheck("address", CheckState.WARN, say("the service answers to IP addresses only"),
                      say("Set its name in IMU_HEALTH_PUBLIC_URL or IMU_HEALTH_ALLOWED_HOSTS."))  # fmt: skip
    if settings.oidc_issuer and not settings.oidc_client_id:
        yield DoctorCheck("sign-in elsewhere", CheckState.FAIL,
                    say("an OpenID provider is set, but no client ID"),
                      say("Set IMU_HEALTH_OIDC_CLIENT_ID."))  # fmt: skip
    for name in ("oidc_client_secret_file", "seal_key_file", "seal_password_file"):
        path: Path | None = getattr(settings, name)
        if path is not None and not os.access(path, os.R_OK):
            yield DoctorCheck(
                "secrets",
                CheckState.FAIL,
                say("{path} cannot be read", path=path),
                say("Correct {name}, or the file.", name=f"{PREFIX}{name.upper()}"),
            )
    if settings.seal_password_file and not settings.seal_key_file:
        yield DoctorCheck("seal", CheckState.WARN, say("a password of the seal's key is set, but no key"),
                      say("Set IMU_HEALTH_SEAL_KEY_FILE."))  # fmt: skip


def folders(settings: Settings) -> Iterator[DoctorCheck]:
    """Whether uploads can be stored, and the free space."""
    try:
        require_writable(settings.files)
    except ServiceError as fault:
        yield DoctorCheck("folder", CheckState.FAIL, str(fault))
        return
    yield DoctorCheck("folder", CheckState.OK, say("{folder} can be written", folder=settings.files))
    space = space_at(settings.files, limits_of(settings).free)
    free = say("{free} GiB free", free=f"{space.free / 2**30:.1f}")
    if space.too_little:
        yield DoctorCheck("disk", CheckState.FAIL, space.too_little, say("Make room, or move the data folder."))
    elif space.free < 4 * space.least:
        text = say("{free}; uploads stop at {least} MiB", free=free, least=f"{space.least / 2**20:.0f}")
        yield DoctorCheck("disk", CheckState.WARN, text, say("Make room soon."))
    else:
        yield DoctorCheck("disk", CheckState.OK, free)


def database(settings: Settings, now: datetime) -> Iterator[DoctorCheck]:
    """Whether the database answers, has the newest migration, and agrees about the time."""
    where = shown_url(settings.database)
    if settings.database.startswith(SQLITE) and not Path(settings.database.removeprefix(SQLITE)).exists():
        yield DoctorCheck(
            "database",
            CheckState.WARN,
            say("{where} is not there yet", where=where),
            say("`imu-health serve` makes it."),
        )
        return
    opened = open_database(settings.database)
    try:
        opened.require_ready()
        yield DoctorCheck("database", CheckState.OK, say("{where} answers and is at the newest migration", where=where))
        yield from _clock(opened, now)
        yield from _waiting(opened, settings)
    except ServiceError as fault:
        yield DoctorCheck(
            "database", CheckState.FAIL, say("{where}: {fault}", where=where, fault=str(fault)), _remedy(str(fault))
        )
    finally:
        opened.close()


def _remedy(fault: str) -> str:
    return "" if "run" in fault else say("Start it, or correct IMU_HEALTH_DATABASE_URL.")


def _clock(opened: Database, now: datetime) -> Iterator[DoctorCheck]:
    """Compares this machine's clock with the server's and with stored times."""
    remedy = say("Set the clocks of both machines, best by NTP.")
    server = opened.server_time()
    with opened.reading() as store:
        lines = Audit(store).page(1)
    if server is not None and abs(server - now) > CLOCK_TOLERANCE:
        apart = f"{abs(server - now).total_seconds():.0f}"
        yield DoctorCheck("clock", CheckState.FAIL, say("{apart} s apart from the database", apart=apart), remedy)
    elif lines and lines[0].at - now > CLOCK_TOLERANCE:
        text = say(
            "the audit trail's last line is of {at} UTC, later than this clock says",
            at=f"{lines[0].at:%Y-%m-%d %H:%M:%S}",
        )
        yield DoctorCheck("clock", CheckState.FAIL, text, remedy)
    else:
        yield DoctorCheck(
            "clock", CheckState.OK, say("{now} UTC, as the database has it", now=f"{now:%Y-%m-%d %H:%M:%S}")
        )


def _waiting(opened: Database, settings: Settings) -> Iterator[DoctorCheck]:
    """Background processes, and the work waiting for them."""
    with opened.reading() as store:
        pending = WorkQueue(store, WorkKind.DIAGNOSIS).count()
    workers, cores = settings.diagnosis_workers, os.cpu_count() or 1
    text = say("{n} in the background, {pending} diagnoses waiting", n=workers, pending=pending)
    if workers == 0:
        yield DoctorCheck(
            "workers",
            CheckState.WARN,
            text,
            say("Set IMU_HEALTH_DIAGNOSIS_WORKERS, or a diagnosis is made only when somebody opens it."),
        )
    elif workers > cores:
        too_many = say("{text}; the machine has {cores} cores", text=text, cores=cores)
        yield DoctorCheck("workers", CheckState.WARN, too_many, say("Set IMU_HEALTH_DIAGNOSIS_WORKERS to fewer."))
    else:
        yield DoctorCheck("workers", CheckState.OK, text)


def doctor(
    database_url: DatabaseUrl = None,
    data_folder: DataFolder = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, one finding a line.")] = False,
) -> None:
    """Look at everything the service needs on this machine, and say what to do; exit code 1 where something fails."""
    findings = list(_findings(database_url=database_url, data_folder=data_folder))
    for finding in findings:
        if as_json:
            print_json(asdict(finding))
        else:
            remedy = f"\n      {escape(translated(finding.remedy))}" if finding.remedy else ""
            mark = f"[{COLOURS[finding.state]}]{translated(MARKS[finding.state]):4}[/]"
            subject, text = escape(translated(finding.what)), escape(translated(finding.text))
            screen().print(f"{mark}  [bold]{subject}[/]: {text}{remedy}", soft_wrap=True)
    if any(finding.state is CheckState.FAIL for finding in findings):
        raise typer.Exit(FAILED)


def _findings(**options: object) -> Iterator[DoctorCheck]:
    yield from program()
    yield from variables(os.environ)
    try:
        settings = Settings(**{name: value for name, value in options.items() if value is not None})  # type: ignore[arg-type]
    except ServiceError as fault:
        yield DoctorCheck("settings", CheckState.FAIL, str(fault))
        return
    except ValidationError as fault:
        for error in fault.errors():
            name = "IMU_HEALTH_" + "_".join(map(str, error["loc"])).upper()
            yield DoctorCheck(
                "settings",
                CheckState.FAIL,
                say("{name}: {fault}", name=name, fault=error["msg"]),
                say("Correct it or unset it."),
            )
        return
    yield from contradictions(settings)
    yield from folders(settings)
    yield from database(settings, datetime.now(UTC))
