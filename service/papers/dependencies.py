"""What routes ask for by type: the desk where certificates are issued and signed."""

from typing import Annotated

from fastapi import Depends, Request

from service.languages.language import asked
from service.papers.certified import laboratory_of
from service.papers.changes import Rules
from service.papers.desk import Desk
from service.papers.sealing import Seal
from service.people.dependencies import StorageOf
from service.web.application import application_of
from service.work.readers import Reader


def _desk(request: Request, storage: StorageOf) -> Desk:
    own = application_of(request)
    laboratory = laboratory_of(own.settings)
    return Desk(
        storage, own.part(Reader).made, laboratory, Rules(own.settings.four_eyes), own.find(Seal), asked(request.scope)
    )


DeskOf = Annotated[Desk, Depends(_desk)]
"""Where certificates are handed out and signed."""
