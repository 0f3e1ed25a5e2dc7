"""What forms share: what one answers, and the kinds of text that people write into them."""

from typing import Annotated

from fastapi import Depends, Form, Path

from service.people.admission import PersonOf
from service.web.fields import NO_NUL

SEE_OTHER = 303
"""What a form answers, so that loading its page again sends nothing twice (RFC 9110)."""
SAYS_SOMETHING = r"^[^\x00]*\S[^\x00]*$"

Key = Annotated[str, Path(max_length=200, pattern=r"^[^\x00]+$")]
Number = Annotated[int, Path(ge=1, le=2_000_000_000)]


def _by(person: PersonOf, by: Annotated[str, Form(max_length=200, pattern=SAYS_SOMETHING)]) -> str:
    return person.signs(by)


By = Annotated[str, Depends(_by)]
"""Somebody's name: the account's, or as they wrote it where nobody signs in."""
Perhaps = Annotated[str, Form(max_length=2000, pattern=NO_NUL)]
"""What may be said and need not."""
Why = Annotated[str, Form(max_length=2000, pattern=SAYS_SOMETHING)]
