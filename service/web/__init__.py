"""What every request passes before a route sees it: who it is for, who sent it, how large and how slow its body is.

`guard` puts the checks around an application; what they refuse has the one shape of every error.
"""

from fastapi import FastAPI

from service.kit.limits import in_force
from service.settings import Settings
from service.web.bodies import LimitedBodies, Limits
from service.web.hosts import OwnHostOnly, hosts_of
from service.web.origins import OwnSiteOnly
from service.web.room import RoomForUploads
from service.web.stopping import Door, Doorkeeper


def guard(app: FastAPI, settings: Settings) -> None:
    """Adds the checks, the innermost first."""
    app.add_middleware(RoomForUploads, folder=settings.files, least=in_force().free)
    app.add_middleware(LimitedBodies, limits=Limits(in_force().body, in_force().client))
    app.add_middleware(OwnSiteOnly, public_url=settings.public_url)
    app.state.door = Door()
    app.add_middleware(Doorkeeper, door=app.state.door)
    app.add_middleware(OwnHostOnly, hosts=hosts_of(settings), public_url=settings.public_url)


__all__ = ["guard"]
