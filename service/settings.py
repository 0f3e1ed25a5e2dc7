"""Settings by the operator, from environment variables that start with IMU_HEALTH_."""

import os
from collections.abc import Mapping
from enum import StrEnum
from importlib.metadata import version
from ipaddress import IPv4Network, IPv6Network, ip_address
from pathlib import Path
from typing import Annotated, Any, Literal
from urllib.parse import urlsplit

from platformdirs import user_data_dir
from pydantic import Field, field_validator, model_validator
from pydantic_settings import BaseSettings, NoDecode, SettingsConfigDict

from service.errors import ServiceError

VERSION = version("imu-health")
"""Version of the program."""


def default_data_folder() -> Path:
    """The platform's folder for the data of programs."""
    return Path(user_data_dir("imu-health", appauthor=False))


def cores_left() -> int:
    """One core answers requests. Two processes at least work beside them, at low priority: beside a long piece, such as
    a group of a quarter of a minute, a short one that somebody waits for is done.
    """
    return max(2, (os.cpu_count() or 1) - 1)


PREFIX = "IMU_HEALTH_"
"""Begins the variables."""
RETIRED = {
    "DATABASE_SECONDS": ("DATABASE_LOCK_SECONDS", "DATABASE_STATEMENT_SECONDS", "DATABASE_CONNECT_SECONDS"),
    "MACHINE": (
        "MAX_UPLOAD_BYTES", "MAX_LOG_BYTES", "JOB_UPLOAD_BYTES", "MAX_ATTACHMENT_BYTES", "MAX_BODY_BYTES",
        "MIN_FREE_BYTES", "MAX_ROWS", "MAX_COLUMNS", "MAX_CELLS", "MAX_LOG_CELLS", "MAX_NESTING", "MAX_UNPACKED_BYTES",
        "MAX_READ_SECONDS", "MAX_READ_BYTES", "READS_AT_ONCE", "UPLOADS_IN_FLIGHT", "WORK_SECONDS",
        "CLIENT_SECONDS", "MAX_CONNECTIONS",
    ),
    "DIAGNOSIS_WORKERS": ("DIAGNOSIS_NICENESS",),
    "OIDC_ISSUER": ("OIDC_NAME",),
    "OIDC_ROLES": ("OIDC_NEW_ACCOUNTS",),
}  # fmt: skip
"""Variables of earlier versions, under their successor: whoever set one relied on it."""


def retired(environment: Mapping[str, str]) -> dict[str, str]:
    """Variables that are set and no longer read, each with its replacement."""
    new_of = {f"{PREFIX}{old}": f"{PREFIX}{new}" for new, gone in RETIRED.items() for old in gone}
    return {name: new_of[name] for name in sorted(map(str.upper, environment)) if name in new_of}


class Origin(StrEnum):
    """Source of a setting's value."""

    DEFAULT = "default"
    ENVIRONMENT = "environment"
    START = "start"
    """An option of the command that started the service."""


class Settings(BaseSettings):
    """Settings of the service; every one has a default that works on a laptop."""

    model_config = SettingsConfigDict(env_prefix=PREFIX, frozen=True)

    data_folder: Path = Field(
        default_factory=default_data_folder,
        description="Folder of uploaded files, and of the SQLite database unless database_url is set.",
    )
    database_url: str | None = Field(
        default=None,
        description="SQLAlchemy URL: sqlite:///path or postgresql://user:password@host/name. "
        "Default: the file imu-health.sqlite in data_folder.",
    )
    database_seconds: float = Field(
        default=10.0,
        gt=0,
        le=600,
        description="Longest wait for a lock of the database, s; PostgreSQL has three times that for a statement and "
        "half of it for a connection.",
    )
    host: str = Field(default="127.0.0.1", description="Address to listen on.")
    port: int = Field(default=8000, ge=0, le=65535, description="Port to listen on.")
    sign_in: Literal["auto", "required", "off"] = Field(
        default="auto",
        description="Who must sign in. auto: nobody while the service listens on this machine only and there is no "
        "account yet; everybody otherwise. off: nobody, whoever reaches the address.",
    )
    trusted_proxies: Annotated[tuple[IPv4Network | IPv6Network, ...], NoDecode] = Field(
        default=(),
        description="Addresses or networks of proxies, separated by commas, whose X-Forwarded-For and "
        "X-Forwarded-Proto say where a request came from and how: 10.0.0.5, 172.16.0.0/12.",
    )
    metrics_token: str = Field(
        default="",
        pattern="^([!-~]{16,})?$",
        repr=False,
        description="Bearer token that opens /metrics and nothing else, 16 characters or more.",
    )
    oidc_issuer: str = Field(
        default="",
        pattern=r"^(https?://[^\s?#]+)?$",
        max_length=500,
        description="OpenID provider for signing in, its issuer address: https://login.example.org.",
    )
    oidc_client_id: str = Field(default="", max_length=500, description="Client ID of this service at the provider.")
    oidc_client_secret_file: Path | None = Field(default=None, description="File with the secret of that client.")
    oidc_hosts: Annotated[tuple[str, ...], NoDecode] = Field(
        default=(), description="More hosts that the provider's own description may name, separated by commas."
    )
    oidc_role_claim: str = Field(
        default="", max_length=200, description="Claim that gives roles, such as groups; none: an admin gives them."
    )
    oidc_roles: Annotated[tuple[tuple[str, Literal["viewer", "crew", "engineer", "admin"]], ...], NoDecode] = Field(
        default=(),
        description="Role of each value of that claim: imu-crew=crew,imu-leads=engineer. *=viewer gives that role to "
        "everybody whom the provider knows; without a role there is no account unless an admin makes it.",
    )
    allowed_hosts: Annotated[tuple[str, ...], NoDecode] = Field(
        default=(),
        description="Host names that the service answers to, beside this machine's own and that of public_url, "
        "separated by commas: imu.example.org, or imu.example.org:8443 for that port only; * allows any.",
    )
    machine: Literal["small", "large"] = Field(
        default="small",
        description="What files may hold and cost. small: 64 MiB, raw logs 2 GiB, for 2 GB of memory; large: four "
        "times as much in four times the memory and time, for 8 GB.",
    )
    stop_seconds: float = Field(
        default=30.0,
        ge=0,
        le=3600,
        description="Longest time for requests in progress to finish when the service stops, s.",
    )
    diagnosis_workers: int = Field(
        default_factory=cores_left,
        ge=0,
        le=256,
        description="Processes that make diagnoses and outlooks beside the requests. 0: a diagnosis is made when "
        "somebody reads it, an outlook with the upload, summaries of the fleet by the service itself.",
    )
    coverage_factor: float = Field(
        default=2.0, gt=0, le=5, description="k: expanded uncertainty and guard band are k times the standard one."
    )

    webhook_hosts: Annotated[tuple[str, ...], NoDecode] = Field(
        default=(),
        description="Hosts that webhooks may call, separated by commas: example.org, or 10.0.0.5:8443 with a port.",
    )

    mail_host: str = Field(
        default="",
        pattern=r"^[!-~]*$",
        max_length=300,
        description="Mail server (SMTP) that sends messages; empty: no e-mail.",
    )
    mail_port: int = Field(default=25, ge=1, le=65535, description="Its port: 25, 587 with starttls, 465 with tls.")
    mail_from: str = Field(
        default="", pattern=r"^([!-?A-~]+@[!-?A-~]+)?$", max_length=300, description="Sender of these messages."
    )
    mail_security: Literal["none", "starttls", "tls"] = Field(
        default="starttls", description="How the connection to it is encrypted; its certificate is checked."
    )

    laboratory_name: str = Field(default="", max_length=200, description="Who calibrates, as certificates name it.")
    laboratory_address: str = Field(default="", max_length=2000, description="Its address.")
    laboratory_country: str = Field(
        default="", pattern="^([A-Z]{2})?$", description="Its country, ISO 3166-1: two capital letters, such as JP."
    )
    laboratory_place: str = Field(
        default="", max_length=2000, description="Where it measures, if that is not at its address."
    )
    four_eyes: bool = Field(
        default=True, description="Whether a certificate must be approved by another person than its reviewer."
    )
    seal_key_file: Path | None = Field(
        default=None,
        description="Key and certificate of the laboratory's electronic seal, PEM or PKCS#12; approved certificates "
        "carry it.",
    )
    seal_password_file: Path | None = Field(default=None, description="File with the password of that key.")
    public_url: str = Field(
        default="",
        pattern=r"^(https?://\S+)?$",
        description="Address under which people reach the pages, for labels; default: that of the request.",
    )

    @model_validator(mode="before")
    @classmethod
    def _none_retired(cls, given: Any) -> Any:
        if gone := retired(os.environ):
            old, new = ", ".join(gone), ", ".join(sorted(set(gone.values())))
            raise ServiceError("No longer read: {old}. Unset it, and use {new} instead.", old=old, new=new)
        return given

    @field_validator("oidc_roles", mode="before")
    @classmethod
    def _pairs(cls, given: object) -> object:
        if not isinstance(given, str):
            return given
        pairs = (part.rpartition("=") for part in given.split(",") if part.strip())
        return tuple((value.strip(), role.strip()) for value, _, role in pairs)

    @field_validator("webhook_hosts", "allowed_hosts", "oidc_hosts", "trusted_proxies", mode="before")
    @classmethod
    def _split(cls, given: object) -> object:
        return tuple(filter(None, (h.strip() for h in given.split(",")))) if isinstance(given, str) else given

    @field_validator("public_url")
    @classmethod
    def _with_a_host(cls, given: str) -> str:
        if given and not urlsplit(given).hostname:
            raise ValueError("names no host")
        return given

    @property
    def is_local(self) -> bool:
        """Whether only programs on this machine reach the service."""
        try:
            return ip_address(self.host).is_loopback
        except ValueError:
            return self.host == "localhost"

    @property
    def database(self) -> str:
        """The database's URL."""
        return self.database_url or f"sqlite:///{self.data_folder / 'imu-health.sqlite'}"

    @property
    def files(self) -> Path:
        """The folder of uploaded bytes."""
        return self.data_folder / "files"

    def origin_of(self, name: str) -> Origin:
        """The source of a setting's value; an option of the command line comes before the environment."""
        if name not in self.model_fields_set:
            return Origin.DEFAULT
        surroundings = Settings()
        is_set = name in surroundings.model_fields_set
        same = getattr(surroundings, name) == getattr(self, name)
        return Origin.ENVIRONMENT if is_set and same else Origin.START
