"""The addresses of the pages: each route asks the flows and renders a frozen context."""

from typing import Annotated

from fastapi import APIRouter, HTTPException, Query, Request, UploadFile
from fastapi.responses import HTMLResponse

from service.dependencies import Moment, Reading, Stores, TheSettings
from service.errors import RefusedError
from service.flows.fleet import fleet_overview
from service.flows.fleet_condition import fleet_condition
from service.flows.history import unit_history
from service.flows.session_report import session_report
from service.flows.unit_report import unit_report
from service.flows.upload import upload
from service.pages.fleet import PAGE_SIZE, FleetView, fleet_page
from service.pages.headers import sent_by_this_site
from service.pages.render import render
from service.pages.session import session_page
from service.pages.unit import unit_page
from service.pages.upload import Outcome, upload_page
from service.records import Verdict

HISTORY_LIMIT = 100_000

router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)
