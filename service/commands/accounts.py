"""`imu-health user` and `token`: accounts, for people with access to the database."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from datetime import UTC, datetime, timedelta
from typing import Annotated

import typer
from rich.markup import escape
from rich.table import Table

from service.commands.console import AsLines, ListOutput, rows_of, screen, table_of
from service.commands.options import DatabaseUrl, DataFolder, settings_from
from service.commands.speech import say
from service.errors import ConflictError
from service.kit.person import COMMAND_LINE as WHO
from service.kit.person import EVERYBODY, Account, Role, Token
from service.opening import open_database
from service.people.changes import AccountChange, add_account, change_account, make_link, make_token, revoke_token
from service.people.sign_in_elsewhere import connect
from service.people.store import Accounts, Tokens
from service.settings import Settings
from service.storage import Files, Storage
from service.storage.queries import Store

user = typer.Typer(name="user", add_completion=False, no_args_is_help=True, help="Make and change accounts.")
token = typer.Typer(name="token", add_completion=False, no_args_is_help=True, help="Make and revoke tokens.")
Login = Annotated[str, typer.Argument(metavar="LOGIN", help="The account's login.", show_default=False)]
RoleOf = Annotated[Role, typer.Option("--role", help="What they may do.", show_default=False)]


@contextmanager
def _opened(settings: Settings) -> Iterator[Storage]:
    storage = Storage(open_database(settings.database), Files(settings.files))
    storage.database.require_ready()
    yield storage
    storage.database.close()


@contextmanager
def _read(settings: Settings) -> Iterator[Store]:
    with _opened(settings) as storage, storage.database.reading() as store:
        yield store


@user.command("add")
def add_user(
    login: Login,
    role: RoleOf,
    name: Annotated[str, typer.Option(help="As papers name them.", show_default="the login")] = "",
    database_url: DatabaseUrl = None,
    data_folder: DataFolder = None,
) -> None:
    """Make an account and print the link with which its owner chooses a password. The first one must be an admin."""
    settings = settings_from(database_url=database_url, data_folder=data_folder)
    with _opened(settings) as storage:
        made = add_account(storage, login, name, role, _now(), who=WHO)
        _print_link(settings, made.login, make_link(storage, made.login, _now(), WHO))


@user.command("change")
def change_user(
    login: Login,
    role: Annotated[Role | None, typer.Option(help="What they may do.", show_default="as it is")] = None,
    name: Annotated[str | None, typer.Option(help="As papers name them.", show_default="as it is")] = None,
    active: Annotated[
        bool | None, typer.Option("--active/--inactive", help="Whether they may sign in.", show_default="as it is")
    ] = None,
    subject: Annotated[
        str, typer.Option(help="As the provider knows them: they sign in there.", show_default="as it is")
    ] = "",
    link: Annotated[bool, typer.Option("--link", help="Print a link to choose another password, once.")] = False,
    database_url: DatabaseUrl = None,
    data_folder: DataFolder = None,
) -> None:
    """Give an account another role, name or password, or keep its owner out. Accounts are never deleted."""
    settings = settings_from(database_url=database_url, data_folder=data_folder)
    if subject and not settings.oidc_issuer:
        raise ConflictError("No provider is set: IMU_HEALTH_OIDC_ISSUER.")
    with _opened(settings) as storage:
        found = change_account(storage, login, AccountChange(name, role, active), _now(), who=WHO)
        if subject:
            connect(storage, login, settings.oidc_issuer, subject, _now(), who=WHO)
        if link:
            _print_link(settings, login, make_link(storage, login, _now(), WHO))
            return
    state = "may sign in" if found.is_active else "may not sign in"
    there = f" at {escape(settings.oidc_issuer)}" if subject else ""
    screen().print(f"[bold]{escape(found.login)}[/]  {escape(found.name)}  {found.role}  {state}{there}")


@user.command("list")
def list_users(
    tokens: Annotated[bool, typer.Option("--tokens", help="Their tokens instead; secrets are not kept.")] = False,
    database_url: DatabaseUrl = None,
    data_folder: DataFolder = None,
    as_json: AsLines = None,
) -> None:
    """Print every account."""
    with _read(settings_from(database_url=database_url, data_folder=data_folder)) as store:
        accounts, every = Accounts(store).every(), Tokens(store).every()
    if tokens:
        ListOutput.of(as_json).show(rows_of(every), lambda: _tokens(every))
    else:
        ListOutput.of(as_json).show(rows_of(accounts), lambda: _accounts(accounts))


def _accounts(accounts: Sequence[Account]) -> Table:
    table = table_of("login", "name", "role", "state")
    for account in accounts:
        active = "may sign in" if account.has_password else "no password yet"
        state = active if account.is_active else "may not sign in"
        table.add_row(escape(account.login), escape(account.name), account.role, state)
    return table


@token.command("add")
def add_token(
    login: Login,
    role: RoleOf,
    label: Annotated[str, typer.Option(help="What it is for.", show_default=False)],
    days: Annotated[int, typer.Option(min=1, max=366, help="How long it holds.")] = 90,
    database_url: DatabaseUrl = None,
    data_folder: DataFolder = None,
) -> None:
    """Make a token for an account and print its secret, which is not shown again."""
    with _opened(settings_from(database_url=database_url, data_folder=data_folder)) as storage:
        lifetime = timedelta(days=days)
        new_token, secret = make_token(storage, login, label, role, _now(), lifetime=lifetime, who=WHO)
    say(f"Token {new_token.id} for {new_token.login}, {new_token.role}, until {new_token.expires_at:%Y-%m-%d}:")
    typer.echo(secret)


@token.command("revoke")
def take_token(
    id: Annotated[int, typer.Argument(metavar="TOKEN", help="Number of the token.", show_default=False)],
    database_url: DatabaseUrl = None,
    data_folder: DataFolder = None,
) -> None:
    """Let nobody in with a token any more; it stays listed."""
    with _opened(settings_from(database_url=database_url, data_folder=data_folder)) as storage:
        found = revoke_token(storage, id, EVERYBODY, _now(), who=WHO)
    screen().print(f"Token {found.id} of [bold]{escape(found.login)}[/], {escape(found.label)}, is revoked.")


def _tokens(tokens: Sequence[Token]) -> Table:
    table = table_of("token", "login", "for", "role", "until", "last used", "revoked", right=("token",))
    for listed in tokens:
        days = (f"{at:%Y-%m-%d}" if at else "" for at in (listed.expires_at, listed.last_used_at, listed.revoked_at))
        table.add_row(str(listed.id), escape(listed.login), escape(listed.label), listed.role, *days)
    return table


def _print_link(settings: Settings, login: str, secret: str) -> None:
    address = settings.public_url.rstrip("/") or f"http://{settings.host}:{settings.port}"
    say(f"For {login}, to choose a password, once, within an hour:")
    typer.echo(f"{address}/sign-in/{secret}")


def _now() -> datetime:
    return datetime.now(UTC)
