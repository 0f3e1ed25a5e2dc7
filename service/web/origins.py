"""Protection against cross-site requests: no other site may use a visitor's browser for a change.

Browsers name the sender of such a request in Sec-Fetch-Site and Origin, which a page cannot set. Programs that are not
browsers send neither, and pass.
"""

from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from service.web.problems import problem

READS = frozenset({"GET", "HEAD", "OPTIONS", "TRACE"})
"""Methods that change nothing (RFC 9110)."""
SAME_SITE = frozenset({"same-origin", "none"})
"""Values of Sec-Fetch-Site: the same origin, or a user's own action."""
FORBIDDEN = 403
FOREIGN = "This request was sent by a page of another site, so nothing was changed."


class SameSiteOnly:
    """Refuses changes requested by a page of another site."""

    def __init__(self, app: ASGIApp, public_url: str) -> None:
        self.app = app
        self.public = urlsplit(public_url).netloc.lower()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Passes reads, and requests that are not from another site."""
        is_foreign = (
            scope["type"] == "http"
            and scope["method"] not in READS
            and not sent_by_this_site(Headers(scope=scope), self.public)
        )
        await (problem(FORBIDDEN, FOREIGN) if is_foreign else self.app)(scope, receive, send)


def sent_by_this_site(headers: Headers, public: str) -> bool:
    """Whether every header with the sender names this service, by its Host or its public name."""
    allowed = {headers.get("host", "").lower(), public} - {""}
    return all(site in SAME_SITE for site in headers.getlist("sec-fetch-site")) and all(
        _place(origin) in allowed for origin in headers.getlist("origin")
    )


def _place(origin: str) -> str:
    """Host and port of an origin; empty for `null` and for an invalid one."""
    try:
        return urlsplit(origin).netloc.lower()
    except ValueError:
        return ""
