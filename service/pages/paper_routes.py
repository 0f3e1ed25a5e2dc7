"""The address of what papers name of a unit: for whom it is calibrated."""

from typing import Annotated
from urllib.parse import quote

from fastapi import APIRouter, Form
from fastapi.responses import RedirectResponse

from service.dependencies import Now, StorageOf
from service.flows.set_customer import set_customer
from service.pages.forms import NO_NUL, SEE_OTHER, By, Key
from service.records.paper import Customer

router = APIRouter(include_in_schema=False)


@router.post("/units/{serial:path}/customer")
def change_customer(
    serial: Key,
    by: By,
    storage: StorageOf,
    now: Now,
    *,
    name: Annotated[str, Form(max_length=200, pattern=NO_NUL)] = "",
    address: Annotated[str, Form(max_length=2000, pattern=NO_NUL)] = "",
) -> RedirectResponse:
    """Records for whom the unit is calibrated."""
    set_customer(storage, serial, Customer(name.strip(), address.strip()), now, who=by)
    return RedirectResponse(f"/units/{quote(serial)}#papers", SEE_OTHER)
