"""The role that each route needs. Every route is listed once; an unlisted route is closed to everybody, so that no new
route is open by oversight."""

from collections.abc import Iterable, Mapping

from service.kit.person import Role
from service.sessions.records import MARKS
from service.web.headers import API

UNIT, SESSION = f"{API}/units/{{serial:path}}", f"{API}/sessions/{{id}}"
MARKED = "\n".join(f"POST /sessions/{{id}}/{word}\nPUT {SESSION}/{word}" for word in MARKS)
"""Routes that set or remove the yes-or-no marks of a session."""
Route = tuple[str, str]
"""Method and path as in the route table."""

PUBLIC = """
GET /healthz
GET /readyz
GET /static/{name}
GET /sign-in
POST /sign-in
GET /sign-in/{secret}
POST /sign-in/{secret}
POST /sign-out
GET /oidc/start
GET /oidc/callback
"""
"""Routes open without signing in."""

VIEWER = f"""
GET /
GET /units/{{serial:path}}
GET /units/{{serial:path}}/parameters/{{name}}
GET /sessions
GET /compare
GET /sessions/{{id}}
GET /sessions/{{id}}/diagnosis
GET /sessions/{{id}}/certificate
GET /flags
GET /unit-types
GET /unit-types/{{name:path}}
GET /stands
GET /stands/{{name:path}}
GET /models/{{id}}
GET /plan
GET /jobs
GET /jobs/{{id}}
GET /jobs/{{id}}/outcome
POST /jobs/report
POST /jobs/{{id}}/cancel
GET /help
GET /api-reference
GET /account
POST /account/password
POST /account/tokens
POST /account/tokens/{{id}}/revoke
GET {API}/sessions
GET {SESSION}
GET {SESSION}/calibration
GET {SESSION}/noise
GET {SESSION}/file
GET {SESSION}/states
GET {SESSION}/notes
GET {SESSION}/attachments
GET {UNIT}/attachments
GET {API}/attachments/{{id}}/file
GET {SESSION}/certificates
GET {SESSION}/certificates/{{number}}
GET {SESSION}/correction
GET {SESSION}/export
GET {SESSION}/diagnosis
GET {API}/units
GET {UNIT}
GET {UNIT}/diagnosis
GET {UNIT}/history
GET {UNIT}/flags
GET {UNIT}/outlook
GET {UNIT}/derivation
GET {UNIT}/notes
GET {UNIT}/found-and-left
GET {UNIT}/usable
GET {UNIT}/label.pdf
GET {UNIT}/label.svg
GET {UNIT}/status.pdf
GET {UNIT}/customer
GET {UNIT}/register
GET {API}/register
GET /register
GET /due
GET {API}/fleet/due
GET {API}/unit-types
GET {API}/unit-types/{{name:path}}/proposal
GET {API}/unit-types/{{name:path}}
GET {API}/unit-types/{{name:path}}/diagnosis
GET {API}/models
GET {API}/models/{{id}}
GET {API}/plan
GET {API}/session-template
GET {API}/stands
GET {API}/stands/{{name:path}}/certificates
GET {API}/stands/{{name:path}}/resting-certificates
GET {API}/stands/{{name:path}}/diagnosis
GET {API}/flags
GET {API}/feeds/due.ics
GET {API}/fleet
GET {API}/fleet/report
GET {API}/jobs
GET {API}/jobs/failed
GET {API}/jobs/{{id}}
GET {API}/jobs/{{id}}/file
POST {API}/jobs/report
POST {API}/jobs/{{id}}/cancel
GET {API}/me
GET {API}/tokens
POST {API}/tokens
DELETE {API}/tokens/{{id}}
"""

CREW = f"""
GET /upload
GET /uploads
GET /uploads/{{id}}
GET /sessions/{{id}}/outcome
POST /upload
POST /upload/layout
POST /units/{{serial:path}}/services
POST /services/{{id}}/withdraw
POST /units/{{serial:path}}/notes
POST /units/{{serial:path}}/customer
POST /units/{{serial:path}}/moves
POST /register
POST /notes/{{id}}/withdraw
POST /sessions/{{id}}/notes
POST /attachments
POST /attachments/{{id}}/withdraw
POST /sessions/{{id}}/stage
{MARKED}
POST {API}/sessions
POST {API}/layouts/preview
GET {API}/uploads
GET {API}/uploads/{{id}}
POST {API}/plan/missing
POST {API}/plan/ready
PUT {SESSION}/stage
GET {SESSION}/certificate
GET {API}/certificates
POST {UNIT}/services
POST {UNIT}/services/preview
POST {API}/services/{{id}}/withdraw
POST {UNIT}/notes
PUT {UNIT}/lot
PUT {UNIT}/customer
PUT {UNIT}/register
POST {UNIT}/moves
POST {API}/notes/{{id}}/withdraw
POST {SESSION}/notes
POST {API}/attachments
POST {API}/attachments/{{id}}/withdraw
"""

ENGINEER = f"""
POST /sessions/{{id}}/diagnosis/accept
POST /sessions/{{id}}/diagnosis/withdraw/{{revision}}
POST /jobs/recalibration
POST /jobs/failed/retry
POST /groups/accept
POST /models/{{id}}/withdraw
POST /flags/acknowledge
POST /flags/resolve
POST /flags/assign
POST /flags/{{id}}/acknowledge
POST /flags/{{id}}/resolve
POST /flags/{{id}}/assign
POST /sessions/{{id}}/withdraw
POST /sessions/{{id}}/certificate/signatures
POST /sessions/{{id}}/accept
POST /sessions/{{id}}/correct
POST /sessions/{{id}}/stand
POST /sessions/{{id}}/reference
POST /register/import
POST /units/{{serial:path}}/retire
POST /units/{{serial:path}}/return
POST /units/{{serial:path}}/type
POST /stands/{{name:path}}/certificates
POST /stands/{{name:path}}/certificate-document
POST /unit-types/{{name:path}}/tolerances
POST /unit-types/{{name:path}}/laws
POST /unit-types/{{name:path}}/tolerances/preview
POST {SESSION}/withdraw
POST {SESSION}/certificate/signatures
POST {SESSION}/accept
POST {SESSION}/correct
POST {SESSION}/supersede
POST {SESSION}/diagnosis/accept
POST {UNIT}/reference
POST {UNIT}/retire
POST {UNIT}/return
POST {API}/register
POST {UNIT}/recalibrate
POST {API}/jobs/recalibration
POST {API}/jobs/failed/retry
POST {UNIT}/diagnosis/accept
POST {API}/unit-types/{{name:path}}/diagnosis/accept
POST {API}/stands/{{name:path}}/diagnosis/accept
POST {API}/models/{{id}}/withdraw
POST {API}/flags/{{id}}/acknowledge
POST {API}/flags/{{id}}/resolve
POST {API}/flags/{{id}}/assign
POST {API}/flags/assign
PUT {UNIT}/type
PUT {API}/unit-types/{{name:path}}
PUT {API}/unit-types/{{name:path}}/temperature-laws
POST {API}/unit-types/{{name:path}}/preview
PUT {API}/stands/{{name:path}}/certificate
PUT {API}/stands/{{name:path}}/certificate-document
"""

ADMIN = f"""
GET /metrics
GET /accounts
POST /accounts
POST /accounts/{{login}}
POST /accounts/{{login}}/link
GET /audit
GET /settings
GET {API}/accounts
POST {API}/accounts
PUT {API}/accounts/{{login}}
POST {API}/accounts/{{login}}/link
GET {API}/audit
GET {API}/audit/check
GET {API}/webhooks
POST {API}/webhooks
GET {API}/webhooks/{{id}}/deliveries
DELETE {API}/webhooks/{{id}}
"""
METRICS: Route = ("GET", "/metrics")
"""Route of the metrics, also open to a token of its own."""


def _routes(text: str) -> Iterable[Route]:
    for line in text.split("\n"):
        if line:
            method, _, path = line.partition(" ")
            yield method, path


NEEDED: Mapping[Route, Role | None] = {
    **dict.fromkeys(_routes(PUBLIC)),
    **dict.fromkeys(_routes(VIEWER), Role.VIEWER),
    **dict.fromkeys(_routes(CREW), Role.CREW),
    **dict.fromkeys(_routes(ENGINEER), Role.ENGINEER),
    **dict.fromkeys(_routes(ADMIN), Role.ADMIN),
}
"""Lowest role for every route; None for public ones."""
