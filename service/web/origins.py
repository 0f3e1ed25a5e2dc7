"""Whether what changes something was sent by one of our own pages: no other site may use a visitor's browser for it.

Browsers name the sender of such a request in Sec-Fetch-Site and Origin; a page cannot write them. Programs that are
no browsers send neither, and pass.
"""

from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from service.web.problems import problem

READS = frozenset({"GET", "HEAD", "OPTIONS", "TRACE"})
"""Methods that change nothing (RFC 9110)."""
OWN = frozenset({"same-origin", "none"})
"""Of Sec-Fetch-Site: a page of ours, or the person's own doing."""
FORBIDDEN = 403
FOREIGN = "This request was sent by a page of another site, so nothing was changed."


class OwnSiteOnly:
    """Refuses changes that a page of another site asks for."""

    def __init__(self, app: ASGIApp, public_url: str) -> None:
        self.app = app
        self.public = urlsplit(public_url).netloc.lower()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Passes reads, what our pages send and what no page sends."""
        foreign = (
            scope["type"] == "http"
            and scope["method"] not in READS
            and not sent_by_this_site(Headers(scope=scope), self.public)
        )
        await (problem(FORBIDDEN, FOREIGN) if foreign else self.app)(scope, receive, send)


def sent_by_this_site(headers: Headers, public: str) -> bool:
    """Whether every header that names the sender names this service, as it was called or as it is known publicly."""
    own = {headers.get("host", "").lower(), public} - {""}
    return all(site in OWN for site in headers.getlist("sec-fetch-site")) and all(
        _place(origin) in own for origin in headers.getlist("origin")
    )


def _place(origin: str) -> str:
    """Host and port of an origin; empty for `null` and for what is none."""
    try:
        return urlsplit(origin).netloc.lower()
    except ValueError:
        return ""
