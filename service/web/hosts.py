"""Which name a request may call this service by.

A page of another site can have its own name resolve to this machine (DNS rebinding). Its browser then takes the
service for that site, but goes on naming it in Host. Such a name is refused before anything is read, so that it
stands in no link, feed or label either. An address in digits cannot be rebound.
"""

import re
from dataclasses import dataclass
from ipaddress import IPv4Address, IPv6Address, ip_address
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from service.settings import Settings
from service.web.problems import problem

HOST = re.compile(r"(\[[0-9A-Fa-f:.]+\]|[A-Za-z0-9._-]+)(?::[0-9]{1,5})?")
"""A name or an address, and perhaps a port (RFC 9110 without what no browser sends)."""
LOOPBACK = ("localhost", "127.0.0.1", "[::1]")
"""Names of this machine for itself: no other site can have them."""
ANY = "*"
MISDIRECTED = 421
UNKNOWN = (
    "This service is not known under the name in the request's Host header, so nothing was read. Whoever runs it can "
    "allow the name with IMU_HEALTH_ALLOWED_HOSTS."
)
"""Does not repeat the name."""


@dataclass(frozen=True)
class Hosts:
    """The names that requests may use."""

    names: frozenset[str]
    """Lower case; one with a port allows that port only."""
    any_address: bool = False
    """Whether any address in digits will do."""

    def allow(self, host: str, own: str | None) -> bool:
        """Whether a Host header is one of the names, or the address ``own`` that the connection came in on."""
        found = HOST.fullmatch(host)
        if found is None:
            return False
        name = found[1].lower()
        if ANY in self.names or name in self.names or host.lower() in self.names:
            return True
        address = _address(name)
        return address is not None and (self.any_address or address == _address(own or ""))


def hosts_of(settings: Settings) -> Hosts:
    """This machine's own names, the public one and those that the operator allows.

    A service that others reach and that was told none of its names takes any address in digits, but no other name.
    """
    public = urlsplit(settings.public_url).hostname
    named = {*settings.allowed_hosts, *((f"[{public}]" if ":" in public else public,) if public else ())}
    any_address = not named and not settings.is_local
    return Hosts(frozenset(name.lower() for name in (*LOOPBACK, *named)), any_address)


def _address(text: str) -> IPv4Address | IPv6Address | None:
    try:
        address = ip_address(text.strip("[]"))
    except ValueError:
        return None
    return getattr(address, "ipv4_mapped", None) or address


class OwnHostOnly:
    """Refuses requests for any other name."""

    def __init__(self, app: ASGIApp, hosts: Hosts, public_url: str) -> None:
        self.app = app
        self.hosts = hosts
        self.public = urlsplit(public_url)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Passes what names this service; HTTP/1.0 need not name anything, and then nothing is repeated."""
        own = (scope.get("server") or (None,))[0]
        foreign = scope["type"] != "lifespan" and not all(
            self.hosts.allow(host, own) for host in Headers(scope=scope).getlist("host")
        )
        if foreign:
            await problem(MISDIRECTED, UNKNOWN)(scope, receive, send)
        else:
            await self.app(self._as_known(scope), receive, send)

    def _as_known(self, scope: Scope) -> Scope:
        """Under its public name the service is reached as that says: links keep the https of a proxy before it."""
        if scope["type"] == "lifespan" or Headers(scope=scope).get("host", "").lower() != self.public.netloc.lower():
            return scope
        scope["scheme"] = self.public.scheme
        return scope
