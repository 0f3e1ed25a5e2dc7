"""Checks that every request passes before a route sees it: host, origin, size and speed of its body.

`guard` adds them to an application; refusals have the one shape of every error.
"""

from fastapi import FastAPI

from service.kit.limits import in_force
from service.settings import Settings
from service.web.bodies import BodyLimits, LimitedBodies, RoomForUploads
from service.web.hosts import AllowedHostsOnly, hosts_of
from service.web.origins import SameSiteOnly
from service.web.stopping import GracefulStop, RequestGate


def guard(app: FastAPI, settings: Settings) -> None:
    """Adds the checks, the innermost first."""
    app.add_middleware(RoomForUploads, folder=settings.files, least=in_force().free)
    app.add_middleware(LimitedBodies, limits=BodyLimits(in_force().body, in_force().client))
    app.add_middleware(SameSiteOnly, public_url=settings.public_url)
    app.state.gate = RequestGate()
    app.add_middleware(GracefulStop, gate=app.state.gate)
    app.add_middleware(AllowedHostsOnly, hosts=hosts_of(settings), public_url=settings.public_url)


__all__ = ["guard"]
