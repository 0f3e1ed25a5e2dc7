"""Host names under which requests may reach this service.

A page of another site can have its own name resolve to this machine (DNS rebinding). Its browser then takes the service
for that site, but still names it in Host. Such a name is refused before anything is read, so that it appears in no
link, feed or label either. A numeric address cannot be rebound.
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
"""Loopback names: no other site can have them."""
ANY = "*"
MISDIRECTED = 421
UNKNOWN = (
    "This service is not known under the name in the request's Host header, so nothing was read. Whoever runs it can "
    "allow the name with IMU_HEALTH_ALLOWED_HOSTS."
)
"""Does not repeat the name."""


@dataclass(frozen=True)
class Hosts:
    """Allowed host names."""

    names: frozenset[str]
    """Lower case; one with a port allows that port only."""
    any_address: bool = False
    """Whether any numeric address is allowed."""

    def allow(self, host: str, local_address: str | None) -> bool:
        """Whether a Host header is one of the names, or the address on which the connection arrived."""
        match_host = HOST.fullmatch(host)
        if match_host is None:
            return False
        name = match_host[1].lower()
        if ANY in self.names or name in self.names or host.lower() in self.names:
            return True
        address = _address(name)
        return address is not None and (self.any_address or address == _address(local_address or ""))


def hosts_of(settings: Settings) -> Hosts:
    """The names of this machine, the public one and those that the operator allows.

    A service that others can reach and that has no configured name allows any numeric address, but no other name.
    """
    public = urlsplit(settings.public_url).hostname
    configured = {*settings.allowed_hosts, *((f"[{public}]" if ":" in public else public,) if public else ())}
    any_address = not configured and not settings.is_local
    return Hosts(frozenset(name.lower() for name in (*LOOPBACK, *configured)), any_address)


def _address(text: str) -> IPv4Address | IPv6Address | None:
    try:
        address = ip_address(text.strip("[]"))
    except ValueError:
        return None
    return getattr(address, "ipv4_mapped", None) or address


class AllowedHostsOnly:
    """Refuses requests for any other name."""

    def __init__(self, app: ASGIApp, hosts: Hosts, public_url: str) -> None:
        self.app = app
        self.hosts = hosts
        self.public = urlsplit(public_url)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Passes requests for this service; HTTP/1.0 need not send Host."""
        local_address = (scope.get("server") or (None,))[0]
        is_foreign = scope["type"] != "lifespan" and not all(
            self.hosts.allow(host, local_address) for host in Headers(scope=scope).getlist("host")
        )
        if is_foreign:
            await problem(MISDIRECTED, UNKNOWN)(scope, receive, send)
        else:
            await self.app(self._with_public_scheme(scope), receive, send)

    def _with_public_scheme(self, scope: Scope) -> Scope:
        if scope["type"] == "lifespan" or Headers(scope=scope).get("host", "").lower() != self.public.netloc.lower():
            return scope
        scope["scheme"] = self.public.scheme
        return scope
