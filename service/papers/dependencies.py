"""Dependency of routes: the desk for certificates."""

from typing import Annotated

from fastapi import Depends, Request

from service.languages.language import asked
from service.papers.certified import laboratory_of
from service.papers.changes import SigningRules
from service.papers.desk import Desk
from service.papers.sealing import Seal
from service.people.dependencies import StorageOf
from service.web.application import application_of
from service.work.readers import Reader


def _desk(request: Request, storage: StorageOf) -> Desk:
    application = application_of(request)
    laboratory = laboratory_of(application.settings)
    return Desk(
        storage,
        application.part(Reader).made,
        laboratory,
        SigningRules(application.settings.four_eyes),
        application.find(Seal),
        asked(request.scope),
    )


DeskOf = Annotated[Desk, Depends(_desk)]
"""Desk for issuing and signing certificates."""
