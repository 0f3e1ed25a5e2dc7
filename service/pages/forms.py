"""What forms share: the test of who sent one, and the kinds of text that people write into them."""

from typing import Annotated

from fastapi import Depends, Form, HTTPException, Path, Request

from service.admission import PersonOf
from service.pages.headers import sent_by_this_site

SEE_OTHER = 303
"""What a form answers, so that loading its page again sends nothing twice (RFC 9110)."""
NO_NUL = r"^[^\x00]*$"
SAYS_SOMETHING = r"^[^\x00]*\S[^\x00]*$"

Key = Annotated[str, Path(max_length=200, pattern=r"^[^\x00]+$")]
Number = Annotated[int, Path(ge=1, le=2_000_000_000)]


def _by(person: PersonOf, by: Annotated[str, Form(max_length=200, pattern=SAYS_SOMETHING)]) -> str:
    return person.signs(by)


By = Annotated[str, Depends(_by)]
"""Somebody's name: the account's, or as they wrote it where nobody signs in."""
Why = Annotated[str, Form(max_length=2000, pattern=SAYS_SOMETHING)]


def _own_form(request: Request) -> None:
    if not sent_by_this_site(request):
        raise HTTPException(403, "This form was sent by another site, so nothing was changed.")


OWN_FORM = [Depends(_own_form)]
