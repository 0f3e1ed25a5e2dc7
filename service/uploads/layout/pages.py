"""The address of the page of a table of one's own layout: looked at, corrected, looked at again, confirmed."""

from dataclasses import replace

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse, RedirectResponse

from estimator.errors import Problem
from service.errors import RefusedError
from service.ingest.layout.mapping import ASKED_ANEW
from service.kit.arriving_files import held
from service.people.dependencies import SEE_OTHER
from service.planning.pattern import type_names
from service.records.dependencies import ReceptionOf
from service.storage import Storage
from service.storage.aside import drop_aside
from service.uploads.layout.form import LayoutForm, LayoutFormOf, carried, corrected, filled_in
from service.uploads.layout.page import layout_page
from service.uploads.preview import Preview, facts_of, preview
from service.uploads.receive import receive_mapped
from service.web.dependencies import Now
from service.web.render import render

NO_FILE = "The table is missing from the form or no longer stored: upload it again."
STORE, CHECK = "store", "check"
"""Buttons of the form that keep the session; a check moves no date."""

router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)


@router.post("/upload/layout")
def show_layout(request: Request, form: LayoutFormOf, reception: ReceptionOf, now: Now) -> Response:
    """The page, with what was corrected; or, confirmed and without a fault, the stored session."""
    if not form.file.content:
        raise RefusedError(NO_FILE, (Problem("file", "is missing from the form"),))
    files, found = reception.storage.files, _found(reception.storage, form)
    back = carried(files, form.owner, form.file, now)
    with reception.storage.database.reading() as store:
        types = type_names(store)
    page = layout_page(back, found, form, types)
    done = form.fields.get("do")
    if done in (STORE, CHECK) and page.can_store and found.mapping == form.mapping:
        try:
            receipt = receive_mapped(reception, replace(form.file, is_check=done == CHECK), found.mapping, now)
        except RefusedError as fault:
            failed = Preview(**{**vars(found), "problems": fault.problems, "session": None})
            return render(request, "layout.html", layout_page(back, failed, form, types), fault.status)
        drop_aside(files, form.owner, back.aside)
        return RedirectResponse(f"/sessions/{receipt.id}", SEE_OTHER)
    return render(request, "layout.html", page)


def _found(storage: Storage, form: LayoutForm) -> Preview:
    """The preview under the corrected mapping, with the facts of another unit or type where one was chosen."""
    mapping = corrected(form)
    if mapping is not None and (form.is_other_type or form.is_other_unit):
        facts, session = facts_of(storage, form.unit, form.like), mapping["session"]
        own = {key: session[key] for key in ASKED_ANEW if key in session}
        if form.is_other_type and facts:
            mapping = {**mapping, "session": {**facts, **own}}
        else:
            mapping = {**mapping, "session": filled_in(session, facts)}
    name, content = form.file.filename, held(form.file.content)
    return preview(storage, content, name, mapping=mapping, unit=form.unit, unit_type=form.like)
