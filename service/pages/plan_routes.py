"""The address of the planning page: a form by GET, so that a plan can be linked to."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse

from service.dependencies import StorageOf
from service.pages.plan import plan_page
from service.pages.render import render
from service.planning.question import PlanQuestion
from service.views.plan import plan, plannable_types

router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)


@router.get("/plan")
def show_plan(request: Request, question: Annotated[PlanQuestion, Query()], storage: StorageOf) -> HTMLResponse:
    """What a session would tell before it is measured."""
    asked, found = plan(storage, question)
    return render(request, "plan.html", plan_page(asked, found, plannable_types(storage)))
