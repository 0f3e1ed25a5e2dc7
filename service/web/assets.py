"""Style, scripts and the Vega bundle, served locally: named by content and cached by the browser for a year."""

import gzip
from dataclasses import dataclass
from functools import lru_cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path

from fastapi import APIRouter, HTTPException, Request, Response

from service.kit.libraries import vl_convert

STATIC = Path(__file__).parent / "static"
KINDS = {".css": "text/css; charset=utf-8", ".js": "text/javascript; charset=utf-8", ".svg": "image/svg+xml"}
VEGA = f"vega-{version('vl-convert-python')}.js"
"""The bundle is made by the installed vl-convert, whose version therefore names it."""

router = APIRouter(include_in_schema=False)


@dataclass(frozen=True)
class Asset:
    """One file for the browser, compressed once."""

    kind: str
    plain: bytes
    packed: bytes


@lru_cache
def _files() -> dict[str, Path]:
    """Public name of every static file: its name with the hash of its content."""
    files = sorted(path for path in STATIC.iterdir() if path.suffix in KINDS)
    return {f"{p.stem}-{sha256(p.read_bytes()).hexdigest()[:12]}{p.suffix}": p for p in files}


@lru_cache
def _asset(name: str) -> Asset:
    if name == VEGA:
        return _packed(KINDS[".js"], vl_convert.javascript_bundle("window.vegaEmbed = vegaEmbed;").encode())
    path = _files()[name]
    return _packed(KINDS[path.suffix], path.read_bytes())


def _packed(kind: str, plain: bytes) -> Asset:
    return Asset(kind, plain, gzip.compress(plain, 9, mtime=0))


def asset_url(name: str) -> str:
    """The address of a static file; ``vega.js`` is the bundle that draws charts."""
    if name == "vega.js":
        return f"/static/{VEGA}"
    public = {path.name: public for public, path in _files().items()}
    return f"/static/{public[name]}"


@router.get("/static/{name}")
def static(name: str, request: Request) -> Response:
    """A static file, named by its content."""
    if name != VEGA and name not in _files():
        raise HTTPException(404, "There is no such file.")
    asset = _asset(name)
    packed = "gzip" in request.headers.get("accept-encoding", "")
    headers = {"Cache-Control": "public, max-age=31536000, immutable", "Vary": "Accept-Encoding"}
    if packed:
        headers["Content-Encoding"] = "gzip"
    return Response(asset.packed if packed else asset.plain, media_type=asset.kind, headers=headers)
