"""No page says anything in English to who asks for Russian, but for names."""

import re
from collections.abc import Iterable, Iterator

import pytest
from lxml import html

from service.all_pages import PARTS
from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - the hook
from tests.service.made_sessions import session_bytes, session_id

RU = {"Accept-Language": "ru"}
HEADERS = {"Accept": "text/html"} | RU
RECORDED = {"operator": "Ю. Орлова", "notes": ""}
UPLOADS = (session_bytes(month=1, **RECORDED), session_bytes(seed=2, month=2, a3_moved=90.0, **RECORDED))
SESSION = session_id(UPLOADS[1])
ADDRESSES = {
    "/units/{serial:path}": "/units/BA-017",
    "/units/{serial:path}/parameters/{name}": "/units/BA-017/parameters/bias-accelerometer",
    "/sessions/{id}": f"/sessions/{SESSION}",
    "/sessions/{id}/certificate": f"/sessions/{SESSION}/certificate",
    "/sessions/{id}/diagnosis": f"/sessions/{SESSION}/diagnosis",
    "/models/{id}": "/models/1",
    "/compare": f"/compare?a={session_id(UPLOADS[0])}&b={SESSION}",
    "/stands/{name:path}": "/stands/ODG-1",
    "/unit-types/{name:path}": "/unit-types/accelerometer × 6, V",
    "/uploads/{id}": "/uploads/1",
}
"""Addresses for routes that need a name."""
NO_PAGES = ("/static/{name}", "/oidc/start", "/oidc/callback", "/sessions/{id}/outcome", "/sign-in/{secret}")
NAMES = frozenset(
    (
        *(
            "imu",
            "health",
            "nice",
            "estimator",
            "OpenAPI",
            "API",
            "OpenID",
            "PostgreSQL",
            "SQLite",
            "SQLAlchemy",
            "ILAC",
            "ISO",
        ),
        *(
            "JSON",
            "CSV",
            "PDF",
            "XLSX",
            "XML",
            "DCC",
            "SVG",
            "SHA",
            "Parquet",
            "MAT",
            "HDF",
            "PEM",
            "PKCS",
            "URL",
        ),
        *("ROS", "Kalibr", "ArduPilot", "UTC", "English", "ppm", "arcsec", "min", "KiB", "MiB", "GiB", "four", "state"),
        *(
            "viewer",
            "crew",
            "engineer",
            "admin",
            "auto",
            "large",
            "small",
            "off",
            "none",
            "groups",
            "https",
            "SMTP",
            "starttls",
            "tls",
            "postgresql",
            "sqlite",
            "rev",
        ),
        *("accelerometer", "nbsp", "Enter", "Ctrl"),
    )
)
"""Words of a Russian page that are no English: names, file formats, units, the keys of roles and rules."""
WORD = re.compile(r"(?<![\w./@:-])[A-Za-z][A-Za-z]{2,}(?![\w/@]|[.:-]\w)")
SILENT = "//script|//style|//svg|//code|//*[@lang='en']"
SPOKEN = ("aria-label", "data-label", "title", "placeholder", "alt")


def addresses() -> Iterator[str]:
    for part in PARTS:
        for route in part.router.routes:
            path = getattr(route, "path", "")
            if "GET" in getattr(route, "methods", ()) and path not in NO_PAGES:
                yield ADDRESSES.get(path, path)


def english(page: str) -> set[str]:
    """Words of a page that are Latin and no names."""
    tree = html.fromstring(page)
    for element in tree.xpath(SILENT):
        element.drop_tree()
    said = [*tree.xpath("//text()"), *(text for name in SPOKEN for text in tree.xpath(f"//@{name}"))]
    return english_in(said)


def english_in(texts: Iterable[str]) -> set[str]:
    """Words that are Latin and no names."""
    return {word for text in texts for word in WORD.findall(text) if word not in NAMES}


@pytest.mark.parametrize("address", sorted(addresses()))
def test_a_page_in_russian_says_nothing_in_english(holding: Holding, address: str) -> None:
    answer = holding(*UPLOADS, diagnosed=True).get(address, headers=HEADERS)
    assert '<html lang="ru">' in answer.text
    assert english(answer.text) == set()


def test_the_test_finds_english() -> None:
    assert english("<p title='Fit'>Годен <b lang='en'>fit</b> but <code>serve</code></p>") == {"Fit", "but"}
