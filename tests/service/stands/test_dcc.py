"""A stand's own Digital Calibration Certificate is read. The document is written by hand, after PTB's schema."""

import os
from datetime import date
from io import BytesIO
from pathlib import Path

import httpx
import polars as pl
import pytest
from lxml import etree

from estimator.reading.setting import ARCSEC
from service.errors import RefusedError
from service.stands.dcc import read_dcc
from service.stands.records import StandCertificate

SCHEMAS = Path(os.environ.get("IMU_HEALTH_SCHEMAS", Path(__file__).resolve().parents[4] / "shared" / "schema"))
EXPANDED = (
    "<si:measurementUncertaintyUnivariate><si:expandedMU><si:valueExpandedMU>{u}</si:valueExpandedMU>"
    "<si:coverageFactor>2</si:coverageFactor><si:coverageProbability>0.95</si:coverageProbability>"
    "</si:expandedMU></si:measurementUncertaintyUnivariate>"
)
END = (
    '<dcc:statements><dcc:statement refType="basic_recalibration"><dcc:name><dcc:content>Valid until</dcc:content>'
    "</dcc:name>{end}</dcc:statement></dcc:statements>"
)
CONTACT = "<dcc:name><dcc:content>{name}</dcc:content></dcc:name>"
PLACE = "<dcc:location><dcc:countryCode>DE</dcc:countryCode></dcc:location>"


def quantity(name: str, unit: str, u: str, refers: str = "basic_measuredValue") -> str:
    real = f"<si:real><si:value>0.1</si:value><si:unit>{unit}</si:unit>{EXPANDED.format(u=u)}</si:real>"
    return f'<dcc:quantity refType="{refers}">{CONTACT.format(name=name)}{real}</dcc:quantity>'


ALPHA = quantity("Elevation of the axis", r"\arcsecond", "1.0", "basic_measuredValue stand_alpha")
BETA = quantity("beta", r"\micro\radian", "2.0")
OTHER = quantity("Temperature", r"\degreecelsius", "0.2")


def document(
    quantities: str = ALPHA + BETA + OTHER, end: str = "<dcc:date>2027-12-10</dcc:date>", laboratory: str = "PTB"
) -> bytes:
    """A certificate of DCC 3.3.0."""
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<dcc:digitalCalibrationCertificate xmlns:dcc="https://ptb.de/dcc" xmlns:si="https://ptb.de/si" schemaVersion="3.3.0">
<dcc:administrativeData>
<dcc:dccSoftware><dcc:software>{CONTACT.format(name="by hand")}
<dcc:release>v1</dcc:release></dcc:software></dcc:dccSoftware>
<dcc:coreData><dcc:countryCodeISO3166_1>DE</dcc:countryCodeISO3166_1><dcc:usedLangCodeISO639_1>en</dcc:usedLangCodeISO639_1>
<dcc:mandatoryLangCodeISO639_1>en</dcc:mandatoryLangCodeISO639_1>
<dcc:uniqueIdentifier>PTB 5.2-117</dcc:uniqueIdentifier>
<dcc:beginPerformanceDate>2025-12-01</dcc:beginPerformanceDate><dcc:endPerformanceDate>2025-12-03</dcc:endPerformanceDate>
<dcc:performanceLocation>laboratory</dcc:performanceLocation><dcc:issueDate>2025-12-10</dcc:issueDate></dcc:coreData>
<dcc:items><dcc:item>{CONTACT.format(name="Optical dividing head")}
<dcc:manufacturer>{CONTACT.format(name="M")}</dcc:manufacturer>
<dcc:identifications><dcc:identification><dcc:issuer>manufacturer</dcc:issuer><dcc:value>ODG-1</dcc:value></dcc:identification>
</dcc:identifications></dcc:item></dcc:items>
<dcc:calibrationLaboratory><dcc:contact>{CONTACT.format(name=laboratory)}{PLACE}</dcc:contact></dcc:calibrationLaboratory>
<dcc:respPersons><dcc:respPerson>
<dcc:person>{CONTACT.format(name="A. Person")}</dcc:person></dcc:respPerson></dcc:respPersons>
<dcc:customer>{CONTACT.format(name="C")}{PLACE}</dcc:customer>{END.format(end=end) if end else ""}
</dcc:administrativeData>
<dcc:measurementResults><dcc:measurementResult>{CONTACT.format(name="Angles")}<dcc:results><dcc:result>
{CONTACT.format(name="Errors")}<dcc:data>{quantities}</dcc:data></dcc:result></dcc:results></dcc:measurementResult>
</dcc:measurementResults>
</dcc:digitalCalibrationCertificate>""".encode()


def test_the_document_of_these_tests_keeps_to_the_schema() -> None:
    file = SCHEMAS / "dcc" / "v3.3.0" / "dcc.xsd"
    if not file.exists():
        pytest.skip(f"no schema at {file}; set IMU_HEALTH_SCHEMAS to the folder that holds dcc/v3.3.0")
    schema = etree.XMLSchema(etree.parse(file, etree.XMLParser(no_network=True)))
    assert schema.validate(etree.fromstring(document())), schema.error_log


def test_number_laboratory_days_and_uncertainties_are_read() -> None:
    read = read_dcc(document(), "S", None)
    assert read.certificate == StandCertificate("S", "PTB 5.2-117", "PTB", date(2025, 12, 10), date(2027, 12, 10))
    found = {error.name: error.sigma for error in read.errors}
    assert found == {"alpha": pytest.approx(0.5 * ARCSEC), "beta": pytest.approx(1e-6)}


@pytest.mark.parametrize(
    ("period", "until"),
    [
        ("P2Y", date(2027, 12, 10)), ("P18M", date(2027, 6, 10)),
        ("P1Y6M5D", date(2027, 6, 15)), ("P90D", date(2026, 3, 10)),
    ],
)  # fmt: skip
def test_a_period_of_validity_runs_from_the_day_of_issue(period: str, until: date) -> None:
    assert read_dcc(document(end=f"<dcc:period>{period}</dcc:period>"), "S", None).certificate.valid_until == until


def test_a_day_that_the_document_lacks_is_asked_for() -> None:
    with pytest.raises(RefusedError) as refused:
        read_dcc(document(end=""), "S", None)
    assert [problem.field for problem in refused.value.problems] == ["valid_until"]
    assert read_dcc(document(end=""), "S", date(2027, 1, 1)).certificate.valid_until == date(2027, 1, 1)


@pytest.mark.parametrize(
    ("unit", "u"), [("\\volt", "1"), ("\\arcsecond", "-1"), ("\\arcsecond", "inf"), ("\\degree", "30"), ("", "1")]
)
def test_an_uncertainty_that_cannot_be_used_is_refused_with_its_name(unit: str, u: str) -> None:
    with pytest.raises(RefusedError) as refused:
        read_dcc(document(quantity("Elevation", unit, u, "stand_alpha")), "S", None)
    assert [problem.field for problem in refused.value.problems] == ["alpha"]


def test_a_quantity_of_the_same_name_that_is_no_angle_is_another() -> None:
    assert read_dcc(document(quantity("alpha", r"\kelvin\tothe{-1}", "1e-6")), "S", None).errors == ()


@pytest.mark.parametrize(
    "content",
    [
        b"", b"no XML", b"<other/>",
        document().replace(b"?>\n", b'?>\n<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]>\n', 1),
    ],
)  # fmt: skip
def test_anything_else_is_refused(content: bytes) -> None:
    with pytest.raises(RefusedError):
        read_dcc(content, "S", None)


def test_a_laboratory_without_a_name_is_refused() -> None:
    with pytest.raises(RefusedError) as refused:
        read_dcc(document(laboratory=" "), "S", None)
    assert [problem.field for problem in refused.value.problems] == ["calibrationLaboratory"]


def test_a_document_fills_the_stand_s_certificate_its_page_and_the_next_template(flagged: httpx.Client) -> None:
    address = "/api/v1/stands/ODG-1/certificate-document"
    xml = {"Content-Type": "application/xml"}
    for _ in range(2):
        answer = flagged.put(address, params={"by": "K. Ito"}, content=document(), headers=xml)
        assert answer.status_code == 200, answer.text
    kept = flagged.get("/api/v1/stands/ODG-1/certificates").json()["certificates"]
    assert kept == [answer.json()["certificate"]]
    page = flagged.get("/stands/ODG-1").text
    assert "PTB 5.2-117" in page
    assert "±1.0 arcsec" in page
    book = flagged.get("/api/v1/session-template", params={"unit": "BA-017"}).content
    rows = dict(
        pl.read_excel(BytesIO(book), sheet_name="session", has_header=False).select("column_1", "column_2").rows()
    )
    stated = {explained: value for value, explained in rows.items()}
    assert float(stated["Error of the elevation, one sigma, arcsec."]) == pytest.approx(0.5)


def test_the_page_takes_the_document_too(flagged: httpx.Client) -> None:
    origin = str(flagged.base_url).rstrip("/")
    answer = flagged.post(
        "/stands/ODG-1/certificate-document",
        data={"by": "K. Ito", "valid_until": ""},
        files={"document": ("certificate.xml", document())},
        headers={"Origin": origin},
    )
    assert (answer.status_code, answer.headers["location"]) == (303, "/stands/ODG-1#certificates")
    assert "PTB 5.2-117" in flagged.get("/stands/ODG-1").text
