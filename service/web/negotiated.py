"""Which form of an answer a request asks for, by its address or by the header `Accept`."""

from collections.abc import Mapping

from fastapi import Request

FORMS = {
    "application/json": "json",
    "text/csv": "csv",
    "application/vnd.apache.parquet": "parquet",
    "application/vnd.apache.arrow.stream": "arrow",
}
"""Media types of tables and what the parameter `format` calls them; the first one is for whoever names none."""


def wanted_form(request: Request, named: str | None, forms: Mapping[str, str] = FORMS) -> str:
    """What the address names, else what the header likes best, else the first form."""
    if named is not None:
        return named
    liked = _liked(request.headers.get("accept", ""))
    offered = {media: max((liked[kind] for kind in _covering(media) if kind in liked), default=0.0) for media in forms}
    best = max(offered, key=offered.__getitem__)
    return forms[best]


def _covering(media: str) -> tuple[str, str, str]:
    return media, f"{media.partition('/')[0]}/*", "*/*"


def _liked(header: str) -> dict[str, float]:
    """Media types with their weights (RFC 9110, 12.5.1); one whose weight is no number is passed over."""
    found = {}
    for part in header.split(","):
        media, _, rest = part.partition(";")
        weight = rest.strip().removeprefix("q=") or "1"
        if weight.replace(".", "", 1).isdecimal():
            found[media.strip().lower()] = float(weight)
    return found
