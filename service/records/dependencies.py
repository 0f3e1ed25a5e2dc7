"""Dependencies of routes that change records."""

from typing import Annotated

from fastapi import Depends, Request

from service.people.admission import PersonOf
from service.people.dependencies import CREW, StorageOf
from service.records.reception import Reception
from service.web.application import application_of
from service.web.turns import register_turn


def _reception(request: Request, storage: StorageOf, person: PersonOf) -> Reception:
    application = application_of(request)
    k, later = application.settings.coverage_factor, application.settings.diagnosis_workers > 0
    return Reception(storage, k, application.metrics, application.bell.ring, person.signs(CREW), is_dated_later=later)


RegisterTurn = Annotated[None, Depends(register_turn, scope="function")]
"""A turn at entering a register, once it is received; BusyError where too many wait for one."""
ReceptionOf = Annotated[Reception, Depends(_reception)]
"""Receiver of uploads and of changes of records."""
