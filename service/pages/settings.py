"""The page of settings: what is in force, and where it comes from. Secrets are never shown."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from estimator.message import joined, say
from service.settings import PREFIX, VERSION, Origin, Settings
from service.storage.engine import shown_url

HIDDEN = "set, not shown"
NONE = "none"
ORIGINS = {
    Origin.DEFAULT: "default",
    Origin.ENVIRONMENT: "environment",
    Origin.START: "option at the start",
}
FILES = "_file"
"""End of the names of settings that say where a secret lies: the place is shown, what lies there is not."""


@dataclass(frozen=True)
class SettingRow:
    """One setting."""

    variable: str
    value: str
    origin: str
    is_default: bool
    text: str


@dataclass(frozen=True)
class SettingsPage:
    """Everything the page of settings shows."""

    version: str
    rows: tuple[SettingRow, ...]
    """What somebody set first, then by name."""


def settings_page(settings: Settings) -> SettingsPage:
    """The page of the settings in force."""
    rows = (_row(settings, name) for name in Settings.model_fields)
    return SettingsPage(VERSION, tuple(sorted(rows, key=lambda row: (row.is_default, row.variable))))


def _row(settings: Settings, name: str) -> SettingRow:
    field, origin = Settings.model_fields[name], settings.origin_of(name)
    value = getattr(settings, name)
    is_secret = not field.repr
    return SettingRow(
        variable=f"{PREFIX}{name.upper()}",
        value=(HIDDEN if value else NONE) if is_secret else _value(settings, name, value),
        origin=say("{origins}, from a file", origins=ORIGINS[origin])
        if name.endswith(FILES) and value
        else ORIGINS[origin],
        is_default=origin is Origin.DEFAULT,
        text=field.description or "",
    )


def _value(settings: Settings, name: str, value: Any) -> str:
    if name == "database_url":
        return shown_url(settings.database)
    return _plain(value)


def _plain(value: Any) -> str:
    """As people write it."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if value is None or value == "" or value == ():
        return NONE
    if isinstance(value, tuple):
        return joined(", ", ("=".join(one) if isinstance(one, tuple) else str(one) for one in value))
    if isinstance(value, Mapping | Path):
        return str(value)
    return (
        f"{value:,}"
        if isinstance(value, int) and value > 9999
        else f"{value:g}"
        if isinstance(value, float)
        else str(value)
    )
