"""Uploads that bring their unit's dates at once; those of a running service leave them to the processes beside it."""

from functools import partial

from service.uploads.receive import upload

upload_and_date = partial(upload, is_dated_later=False)
