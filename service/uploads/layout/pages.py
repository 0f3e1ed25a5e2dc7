"""The route of the page of a table of custom layout: shown, corrected, confirmed."""

from dataclasses import replace

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse, RedirectResponse

from estimator.errors import Problem
from estimator.json_object import Json
from service.errors import BusyError, RefusedError
from service.ingest.layout.mapping import PER_FILE_FIELDS
from service.kit.arriving_files import where
from service.kit.limits import in_force
from service.people.admission import PersonOf
from service.people.dependencies import SEE_OTHER
from service.planning.pattern import type_names
from service.records.dependencies import ReceptionOf
from service.sessions.records import MARKS, marks_said
from service.storage import Storage
from service.storage.aside import drop_aside
from service.uploads.layout.form import LayoutForm, LayoutFormOf, carried, corrected, faults_of, filled_in
from service.uploads.layout.page import layout_page
from service.uploads.preview import Preview, facts_of, preview
from service.uploads.receive import receive_mapped
from service.uploads.take_in import is_long
from service.web.dependencies import Now
from service.web.render import render
from service.work.dependencies import JobDeskOf

NO_FILE = "The table is missing from the form or no longer stored: upload it again."
STORE = "store"
"""The button of the form that stores the session; others carry the name of a mark that it gets too."""

router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)


@router.post("/upload/layout")
def show_layout(
    request: Request, form: LayoutFormOf, reception: ReceptionOf, now: Now, desk: JobDeskOf, person: PersonOf
) -> Response:
    """The page with the corrections; or, once confirmed without a fault, the stored session, or the job that reads a
    long file."""
    if not len(form.file.content):
        raise RefusedError(NO_FILE, (Problem("file", "is missing from the form"),))
    files, preview_shown = reception.storage.files, _preview(reception.storage, form)
    carried_file = carried(files, form.owner, form.file, now)
    with reception.storage.database.reading() as store:
        types = type_names(store)
    page = layout_page(carried_file, preview_shown, form, types)
    action = form.fields.get("do")
    if action in (STORE, *MARKS) and page.can_store and preview_shown.mapping == form.mapping:
        file = replace(form.file, **marks_said((action,)))
        long = replace(file, mapping=preview_shown.mapping)
        try:
            if is_long(reception.storage, long, in_force().later):
                return RedirectResponse(f"/jobs/{desk.take_in(reception, long, person).id}", SEE_OTHER)
            receipt = receive_mapped(reception, file, preview_shown.mapping, now)
        except RefusedError as fault:
            failed = replace(preview_shown, problems=fault.problems, session=None)
            return render(request, "layout.html", layout_page(carried_file, failed, form, types), fault.status)
        except BusyError as fault:
            page = replace(page, problems=(Problem("file", fault.detail),))
            return render(request, "layout.html", page, fault.status)
        drop_aside(files, form.owner, carried_file.aside)
        return RedirectResponse(f"/sessions/{receipt.id}", SEE_OTHER)
    return render(request, "layout.html", page)


def _preview(storage: Storage, form: LayoutForm) -> Preview:
    """The preview under the corrected mapping; where that reads no table, with the columns as they were before."""
    faults = faults_of(form)
    try:
        shown = _shown(storage, form)
    except RefusedError as fault:
        if form.mapping is None:
            raise
        kept = {key: text for key, text in form.fields.items() if not key.startswith(("table.", "as."))}
        shown, faults = _shown(storage, replace(form, fields=kept)), (*faults, *fault.problems)
    return replace(shown, problems=(*faults, *shown.problems), session=None) if faults else shown


def _shown(storage: Storage, form: LayoutForm) -> Preview:
    name, content, mapping = form.file.filename, where(form.file.content), _with_facts(storage, form)
    return preview(storage, content, name, mapping=mapping, unit=form.unit, unit_type=form.like)


def _with_facts(storage: Storage, form: LayoutForm) -> Json | None:
    """The corrected mapping, with the facts of another unit or type where chosen."""
    mapping = corrected(form)
    if mapping is None or not (form.is_other_type or form.is_other_unit):
        return mapping
    facts, session = facts_of(storage, form.unit, form.like), mapping["session"]
    stated = {key: session[key] for key in PER_FILE_FIELDS if key in session}
    if form.is_other_type and facts:
        return {**mapping, "session": {**facts, **stated}}
    return {**mapping, "session": filled_in(session, facts)}
