"""A certificate is reviewed and then approved by somebody else, each by their password; what changes later shows."""

import re
from collections.abc import Iterator
from typing import Any

import httpx
import pytest
from lxml import etree
from sqlalchemy import text
from sqlalchemy.exc import DatabaseError

from service.kit.person import Role
from service.people.changes import add_account
from service.settings import Settings
from service.storage import Storage
from service.storage.audit import Audit
from service.storage.engine import open_engine
from tests.conftest import SettingsFilled
from tests.databases import ENGINES
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_sessions import FAILED, session_id
from tests.service.papers.documents import text_of
from tests.service.papers.laboratory import LABORATORY, named
from tests.service.papers.schema import DCC
from tests.service.papers.test_dcc_schema import broken, needs_schemas, schema
from tests.service.people.staff import NOW, PASSWORD, Staff, staffed, with_password
from tests.stock import stores

ID = session_id(FAILED[-1])
OWN = f"/api/v1/sessions/{ID}"
both = pytest.mark.parametrize("databases", ENGINES, indirect=True)
"""Runs on both engines, for behaviour that statements to a database decide."""


def issued(settings: Settings) -> None:
    """A session out of tolerance, and its certificate."""
    with named(settings) as client:
        for content in FAILED:
            client.post("/api/v1/sessions", content=content).raise_for_status()
        client.get(f"{OWN}/certificate").raise_for_status()


@pytest.fixture
def settings(settings_filled: SettingsFilled) -> Settings:
    """Settings of a laboratory that issued a certificate."""
    return settings_filled(issued)


@pytest.fixture
def storage(settings: Settings) -> Iterator[Storage]:
    with stores(settings) as found:
        yield found


@pytest.fixture
def staff(storage: Storage) -> Staff:
    """One of every role, with passwords."""
    return staffed(storage, signing=("crew", "engineer", "admin"))


@pytest.fixture
def http(settings: Settings, staff: Staff) -> Iterator[httpx.Client]:
    """HTTP to it."""
    with named(settings) as client:
        yield client


def signed(http: httpx.Client, staff: Staff, role: Role, meaning: str, **changes: str) -> httpx.Response:
    """The answer to somebody who signs the latest certificate."""
    body = {"number": f"{ID}-0-1", "meaning": meaning, "password": PASSWORD} | changes
    return http.post(f"{OWN}/certificate/signatures", json=body, headers=staff.headers(role))


def listed(http: httpx.Client, staff: Staff) -> dict[str, Any]:
    found: dict[str, Any] = http.get(f"{OWN}/certificates", headers=staff.headers(Role.VIEWER)).json()
    return found


def paper(http: httpx.Client, staff: Staff, format: str = "pdf") -> bytes:
    answer = http.get(f"{OWN}/certificate?format={format}", headers=staff.headers(Role.CREW))
    assert answer.status_code == 200, answer.text
    return answer.content


def approve(http: httpx.Client, staff: Staff) -> None:
    for role, meaning in ((Role.ENGINEER, "reviewed"), (Role.ADMIN, "approved")):
        assert signed(http, staff, role, meaning).status_code == 201


@both
def test_two_people_sign_and_their_names_are_printed(http: httpx.Client, staff: Staff) -> None:
    assert "Reviewed by: name, signature, date" in text_of(paper(http, staff))
    approve(http, staff)
    words = text_of(paper(http, staff))
    assert "Reviewed by Engineer (engineer)" in words
    assert "Approved by Admin (admin)" in words
    assert "I release this certificate in the name of the laboratory." in words
    [issue] = listed(http, staff)["certificates"]
    assert [(s["meaning"], s["login"]) for s in issue["signatures"]] == [
        ("reviewed", "engineer"),
        ("approved", "admin"),
    ]
    assert {s["content_hash"] for s in issue["signatures"]} == {issue["content_hash"]}


@needs_schemas
def test_the_xml_names_them_and_stays_valid(http: httpx.Client, staff: Staff) -> None:
    approve(http, staff)
    content = paper(http, staff, "dcc")
    roles = etree.fromstring(content).findall(f".//{DCC}respPerson/{DCC}role")
    assert [role.text for role in roles] == ["operator", "reviewer", "approver"]
    assert content.count(b"mainSigner>true<") == 1
    assert schema().validate(etree.fromstring(content)), schema().error_log
    assert broken(content) == []


def test_the_signature_stands_in_the_audit_trail(http: httpx.Client, staff: Staff, storage: Storage) -> None:
    signed(http, staff, Role.ENGINEER, "reviewed")
    with storage.database.reading() as store:
        line = Audit(store).page(1)[0]
        assert Audit(store).check().broken is None
    assert (line.action, line.subject, line.who, line.account) == (
        "sign certificate", f"{ID}-0-1", "Engineer", "engineer, token bench",
    )  # fmt: skip
    assert line.details["meaning"] == "reviewed"


def test_who_reviewed_may_not_approve(http: httpx.Client, staff: Staff) -> None:
    signed(http, staff, Role.ENGINEER, "reviewed")
    answer = signed(http, staff, Role.ENGINEER, "approved")
    assert (answer.status_code, "another person must approve it" in answer.text) == (409, True)


def test_a_laboratory_of_one_may_say_so(settings: Settings, staff: Staff) -> None:
    with named(settings, four_eyes=False) as http:
        paper(http, staff)
        codes = [signed(http, staff, Role.ENGINEER, m).status_code for m in ("reviewed", "approved")]
    assert codes == [201, 201]


@pytest.mark.parametrize(
    ("role", "changes", "status", "words"),
    [
        (Role.ENGINEER, {"password": "a guess of many"}, 401, "password is wrong"),
        (Role.ENGINEER, {"number": "another"}, 409, "is not the latest"),
        (Role.ENGINEER, {"meaning": "approved"}, 409, "must be reviewed before"),
        (Role.CREW, {}, 403, "needs the role engineer"),
    ],
)
def test_what_may_not_be_signed(
    http: httpx.Client, staff: Staff, role: Role, changes: dict[str, str], status: int, words: str
) -> None:
    answer = signed(http, staff, role, changes.pop("meaning", "reviewed"), **changes)
    assert (answer.status_code, words in answer.text) == (status, True), answer.text
    assert listed(http, staff)["certificates"][0]["signatures"] == []


def test_a_password_cannot_be_guessed_by_signing(http: httpx.Client, staff: Staff) -> None:
    codes = [signed(http, staff, Role.ENGINEER, "reviewed", password=f"guess {k}").status_code for k in range(6)]
    assert codes == [401] * 5 + [429]


def test_without_an_account_nobody_signs(settings: Settings) -> None:
    with named(settings) as http:
        body = {"number": f"{ID}-0-1", "meaning": "reviewed", "password": PASSWORD}
        answer = http.post(f"{OWN}/certificate/signatures", json=body)
    assert (answer.status_code, "Signing requires an account" in answer.text) == (409, True)


def test_what_changes_after_the_signature_is_noticed(http: httpx.Client, staff: Staff) -> None:
    approve(http, staff)
    before = paper(http, staff)
    assert (listed(http, staff)["is_current"], listed(http, staff)["concerns"]) == (True, [])
    customer = {"name": "Somebody else", "address": "Elsewhere"}
    http.put("/api/v1/units/BA-017/customer", json=customer, headers=staff.headers(Role.CREW)).raise_for_status()
    found = listed(http, staff)
    assert found["is_current"] is False
    assert "have changed since it was approved" in found["concerns"][0]
    assert signed(http, staff, Role.ENGINEER, "reviewed").status_code == 409
    assert f"No. {ID}-0-2" in text_of(paper(http, staff))
    assert listed(http, staff)["certificates"][1]["signatures"] == []
    kept = http.get(f"{OWN}/certificates/{ID}-0-1", headers=staff.headers(Role.VIEWER))
    assert kept.content == before


def test_a_session_that_is_withdrawn_is_noticed(http: httpx.Client, staff: Staff) -> None:
    approve(http, staff)
    body = {"why": "wrong unit", "by": "x"}
    http.post(f"{OWN}/withdraw", json=body, headers=staff.headers(Role.ENGINEER)).raise_for_status()
    assert "no longer counts" in listed(http, staff)["concerns"][0]


def tampered(settings: Settings, table: str, change: str) -> None:
    """Changes a table as somebody would who may do everything to the database."""
    engine = open_engine(settings.database)
    with engine.begin() as connection:
        if connection.dialect.name == "postgresql":
            connection.execute(text(f"DROP TRIGGER {table}_append_only ON {table}"))
        else:
            connection.execute(text(f"DROP TRIGGER {table}_no_update"))
        connection.execute(text(f"UPDATE {table} SET {change}"))
    engine.dispose()


@both
def test_a_hash_that_was_changed_in_the_database_is_noticed(
    http: httpx.Client, staff: Staff, settings: Settings
) -> None:
    approve(http, staff)
    tampered(settings, "certificate_signatures", f"content_hash = '{'0' * 64}'")
    assert "the database was changed" in listed(http, staff)["concerns"][0]


@both
def test_an_approved_file_that_was_changed_is_not_given_out(
    http: httpx.Client, staff: Staff, settings: Settings
) -> None:
    approve(http, staff)
    tampered(settings, "certificate_files", "content = CAST('%PDF-1.7' AS BLOB)" if "sqlite" in settings.database
             else "content = '%PDF-1.7'::bytea")  # fmt: skip
    answer = http.get(f"{OWN}/certificate", headers=staff.headers(Role.CREW))
    assert (answer.status_code, "cannot be downloaded" in answer.text) == (500, True)


@both
def test_the_database_refuses_to_change_a_signature(http: httpx.Client, staff: Staff, settings: Settings) -> None:
    approve(http, staff)
    engine = open_engine(settings.database)
    for table in ("certificate_signatures", "certificate_files"):
        for statement in (f"DELETE FROM {table}", f"UPDATE {table} SET id = 7"):
            with pytest.raises(DatabaseError, match="append-only"), engine.begin() as connection:
                connection.execute(text(statement))
    engine.dispose()


def test_the_page_offers_what_comes_next_and_to_whom(http: httpx.Client, staff: Staff, storage: Storage) -> None:
    page = f"/sessions/{ID}/certificate"
    assert 'type="password"' not in http.get(page, headers=staff.headers(Role.CREW)).text
    assert "Sign: reviewed" in http.get(page, headers=staff.headers(Role.ENGINEER)).text
    body = {"number": f"{ID}-0-1", "meaning": "reviewed", "password": PASSWORD}
    assert http.post(f"{page}/signatures", data=body, headers=staff.headers(Role.ENGINEER)).status_code == 303
    assert "another person must approve" in http.get(page, headers=staff.headers(Role.ENGINEER)).text
    wrong = body | {"meaning": "approved", "password": "a guess of many"}
    again = http.post(f"{page}/signatures", data=wrong, headers=staff.headers(Role.ADMIN))
    assert (again.status_code, "password is wrong" in again.text, "Sign: approved" in again.text) == (401, True, True)
    shown = http.get(page, headers=staff.headers(Role.ADMIN)).text
    assert "Reviewed by Engineer" in shown
    assert "Sign: approved" in shown


def test_a_name_is_printed_as_text(http: httpx.Client, staff: Staff, storage: Storage) -> None:
    add_account(storage, "eve", '#panic("x") <b>Eve</b>', Role.ADMIN, NOW, who="test")
    with_password(storage, "eve")
    http.post("/sign-in", data={"login": "eve", "password": PASSWORD})
    signed(http, staff, Role.ENGINEER, "reviewed")
    token = http.get("/account").text.split('name="csrf" value="')[1][:64]
    body = {"number": f"{ID}-0-1", "meaning": "approved", "password": PASSWORD, "csrf": token}
    assert http.post(f"/sessions/{ID}/certificate/signatures", data=body).status_code == 303
    assert '#panic("x") <b>Eve</b> (eve)' in text_of(paper(http, staff))
    assert "<b>Eve</b>" not in http.get(f"/sessions/{ID}/certificate").text
    assert LABORATORY["laboratory_name"] in text_of(paper(http, staff))


def test_what_is_to_be_signed_waits_for_engineers(http: httpx.Client, staff: Staff) -> None:
    def waiting() -> list[str]:
        page = http.get("/flags", headers=staff.headers(Role.ENGINEER)).text
        return re.findall(r"Certificate \S+ is to be \w+\.", page)

    assert waiting() == []
    assert signed(http, staff, Role.ENGINEER, "reviewed").status_code == 201
    assert waiting() == [f"Certificate {ID}-0-1 is to be approved."]
    assert signed(http, staff, Role.ADMIN, "approved").status_code == 201
    assert waiting() == []
