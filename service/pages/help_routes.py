"""The addresses of what explains the service: help, the reference of its API, its settings."""

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse

from service.dependencies import SettingsOf
from service.pages.help import help_page
from service.pages.reference import reference_page
from service.pages.render import render
from service.pages.settings import settings_page

router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)


@router.get("/help")
def show_help(request: Request) -> HTMLResponse:
    """What to do when, and what the words mean."""
    return render(request, "help.html", help_page())


@router.get("/api-reference")
def show_reference(request: Request) -> HTMLResponse:
    """Every call of the API."""
    return render(request, "reference.html", reference_page(request.app.openapi()))


@router.get("/settings")
def show_settings(request: Request, settings: SettingsOf) -> HTMLResponse:
    """What is in force, and where it comes from."""
    return render(request, "settings.html", settings_page(settings))
