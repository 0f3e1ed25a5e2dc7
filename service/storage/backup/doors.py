"""What a backup brings back of who is in: browsers and links end with it, for they may have been ended since. Tokens
may have been revoked since; whoever restores says what becomes of them.
"""

from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import Connection, delete, func, inspect, select, update

from service.people.tables import AttemptRow, SignInLinkRow, SignInRow, TokenRow


@dataclass(frozen=True)
class Doors:
    """What was closed, and what stands open."""

    browsers: int = 0
    """That were signed in, and must sign in again."""
    tokens: int = 0
    """That held when the backup was made and hold by their dates."""
    revoked: bool = False
    """Whether those were revoked."""


def close_doors(connection: Connection, now: datetime, *, revoke: bool) -> Doors:
    """Ends browsers and links, and revokes tokens where that is wanted, within the transaction that restores."""
    known = set(inspect(connection).get_table_names())
    if not {"tokens", "sign_ins", "sign_in_links"} <= known:
        return Doors()
    browsers = connection.scalar(select(func.count()).select_from(SignInRow).where(SignInRow.expires_at > now)) or 0
    for row in (SignInRow, SignInLinkRow, *((AttemptRow,) if "attempts" in known else ())):
        connection.execute(delete(row))
    held = TokenRow.revoked_at.is_(None), TokenRow.expires_at > now
    tokens = connection.scalar(select(func.count()).select_from(TokenRow).where(*held)) or 0
    if revoke:
        connection.execute(update(TokenRow).where(*held).values(revoked_at=now))
    return Doors(browsers, tokens, revoke)
