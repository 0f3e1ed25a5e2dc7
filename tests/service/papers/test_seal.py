"""An approved certificate carries a seal that others check with their own tools, and one changed byte is noticed."""

import base64
import io
import re
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor
from copy import deepcopy
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path

import pytest
import typst
from asn1crypto import pem, x509
from cryptography.exceptions import InvalidSignature
from cryptography.hazmat.primitives import hashes
from cryptography.hazmat.primitives.asymmetric.ec import ECDSA, EllipticCurvePublicKey
from cryptography.hazmat.primitives.asymmetric.utils import encode_dss_signature
from cryptography.x509 import load_der_x509_certificate
from lxml import etree
from pyhanko.pdf_utils.reader import PdfFileReader
from pyhanko.sign.validation import validate_pdf_signature
from pyhanko_certvalidator import ValidationContext

from service.app import create_app
from service.errors import ConflictError, ServiceError
from service.kit.person import Role
from service.papers.sealing import Seal, seal_of
from service.settings import Settings
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.papers.documents import text_of
from tests.service.papers.laboratory import named
from tests.service.papers.schema import DCC
from tests.service.papers.test_dcc_schema import broken, needs_schemas, schema
from tests.service.papers.test_signatures import approve, paper, settings, signed, staff, storage  # noqa: F401 - fixtures
from tests.service.papers.trial_key import trial_key
from tests.service.people.staff import Staff

DS = "{http://www.w3.org/2000/09/xmldsig#}"
REPORTS = (Path(__file__).parents[3] / "docs" / "reports.md").read_text(encoding="utf-8")
C14N11 = "http://www.w3.org/2006/12/xml-c14n11"


@pytest.fixture
def key_file(tmp_path: Path) -> Path:
    """Key and certificate for trial."""
    (tmp_path / "seal.pem").write_bytes(trial_key("Laboratory North", datetime.now(UTC)))
    return tmp_path / "seal.pem"


@pytest.fixture
def approved(settings: Settings, staff: Staff, key_file: Path) -> tuple[bytes, bytes]:  # noqa: F811
    """An approved certificate, as PDF and as XML."""
    with named(settings, seal_key_file=key_file) as http:
        paper(http, staff)
        approve(http, staff)
        return paper(http, staff), paper(http, staff, "dcc")


def is_sound(pdf: bytes, key_file: Path) -> bool:
    """Verdict of pyhanko's validator, with the certificate as the only one that is trusted."""
    blocks = pem.unarmor(key_file.read_bytes(), multiple=True)
    trusted = [x509.Certificate.load(content) for kind, _, content in blocks if kind == "CERTIFICATE"]
    embedded = PdfFileReader(io.BytesIO(pdf)).embedded_signatures[0]
    with ThreadPoolExecutor(1) as apart:  # a browser test before this one may have left a loop in this thread
        status = apart.submit(validate_pdf_signature, embedded, ValidationContext(trust_roots=trusted)).result()
    return bool(status.bottom_line and status.coverage.name == "ENTIRE_FILE")


def openssl(pdf: bytes, key_file: Path, folder: Path) -> bool:
    """Verdict of openssl on the signature, cut out of the file by hand (ISO 32000-1, 12.8.1)."""
    found = pdf.rindex(b"/ByteRange")
    numbers = pdf[pdf.index(b"[", found) + 1 : pdf.index(b"]", found)].split()
    start, first, second, last = map(int, numbers)
    (folder / "data").write_bytes(pdf[start : start + first] + pdf[second : second + last])
    (folder / "cms").write_bytes(bytes.fromhex(pdf[first + 1 : second - 1].decode()))
    words = "cms -verify -binary -inform DER -purpose any -partial_chain -in cms -content data -out out -CAfile"
    done = subprocess.run(["openssl", *words.split(), key_file], cwd=folder, capture_output=True, check=False)
    return done.returncode == 0 and second + last == len(pdf)


def test_an_approved_pdf_says_whose_seal_it_has_and_is_checked_by_two_tools(
    approved: tuple[bytes, bytes], key_file: Path, tmp_path: Path
) -> None:
    pdf, _ = approved
    assert is_sound(pdf, key_file)
    assert openssl(pdf, key_file, tmp_path)
    assert "carries the electronic seal of CN=TRIAL (not trusted) Laboratory North" in text_of(pdf)


def test_one_changed_byte_of_a_pdf_is_noticed(key_file: Path, tmp_path: Path) -> None:
    pdf = sealed(key_file).pdf(typst.compile(b"= Calibration certificate", format="pdf"))
    assert (is_sound(pdf, key_file), openssl(pdf, key_file, tmp_path)) == (True, True)
    place = pdf.index(b"stream\n") + 40
    changed = pdf[:place] + bytes([pdf[place] ^ 1]) + pdf[place + 1 :]
    assert (is_sound(changed, key_file), openssl(changed, key_file, tmp_path)) == (False, False)
    assert not is_sound(pdf, _other(tmp_path))


def sealed(key_file: Path) -> Seal:
    """The seal of a key."""
    found = seal_of(key_file, None)
    assert found is not None
    return found


def _other(folder: Path) -> Path:
    """Somebody else's key."""
    (folder / "other.pem").write_bytes(trial_key("Somebody", datetime.now(UTC)))
    return folder / "other.pem"


def digest_of(element: etree._Element) -> str:
    """Digest of the element as canonical XML 1.1; here no node differs from 1.0, which lxml writes."""
    return base64.b64encode(sha256(etree.tostring(element, method="c14n")).digest()).decode()


def is_signed(content: bytes) -> bool:
    """Whether it is signed by the XML signature recommendation, step by step, without the library that signed."""
    root = etree.fromstring(content)
    [signature] = root.findall(f"{DS}Signature")
    info = signature.find(f"{DS}SignedInfo")
    bare = deepcopy(root)
    bare.remove(bare.find(f"{DS}Signature"))
    by_id = {f"#{e.get('Id')}": e for e in signature.iter() if isinstance(e.tag, str) and e.get("Id")}
    for reference in info.findall(f"{DS}Reference"):
        target = bare if reference.get("URI") == "" else by_id[reference.get("URI")]
        if digest_of(target) != reference.findtext(f"{DS}DigestValue"):
            return False
    return _holds(signature, etree.tostring(info, method="c14n"))


def _holds(signature: etree._Element, signed: bytes) -> bool:
    raw = base64.b64decode(signature.findtext(f"{DS}SignatureValue"))
    certificate = base64.b64decode(signature.findtext(f".//{DS}X509Certificate"))
    key = load_der_x509_certificate(certificate).public_key()
    assert isinstance(key, EllipticCurvePublicKey)
    halves = (int.from_bytes(half) for half in (raw[: len(raw) // 2], raw[len(raw) // 2 :]))
    try:
        key.verify(encode_dss_signature(*halves), signed, ECDSA(hashes.SHA256()))
    except InvalidSignature:
        return False
    return True


@needs_schemas
def test_an_approved_xml_is_signed_as_the_recommendation_says_and_valid(approved: tuple[bytes, bytes]) -> None:
    """PTB's rules take the standard's own empty elements of a signature for faults, so they see it without."""
    root = etree.fromstring(approved[1])
    assert is_signed(approved[1])
    assert root.findtext(f".//{DCC}cryptElectronicSeal") == "true"
    assert schema().validate(root), schema().error_log
    root.remove(root.find(f"{DS}Signature"))
    assert broken(etree.tostring(root)) == []


@pytest.mark.parametrize(("said", "other"), [(b">pass<", b">fail<"), (b"BA-017", b"BA-018"), (b" <b>", b"<b>")])
def test_one_changed_word_of_an_xml_is_noticed(key_file: Path, said: bytes, other: bytes) -> None:
    dcc = sealed(key_file).xml(b'<a xmlns="https://ptb.de/dcc"> <b>pass</b><c d="BA-017"/></a>')
    assert C14N11.encode() in dcc
    assert is_signed(dcc)
    assert said in dcc
    assert not is_signed(dcc.replace(said, other, 1))


# The seal is verified above by a Python package; this verifies it by an independent program, with the command that the
# page gives. The program comes with the system and not with pip, so a machine may lack it.
@pytest.mark.skipif(shutil.which("xmlsec1") is None, reason="needs xmlsec1: apt-get install xmlsec1")
@pytest.mark.parametrize(("written", "holds"), [(b">pass<", True), (b">fail<", False)])
def test_xmlsec1_checks_an_xml_as_the_page_says(key_file: Path, tmp_path: Path, written: bytes, holds: bool) -> None:
    dcc = sealed(key_file).xml(b'<a xmlns="https://ptb.de/dcc"><b>pass</b></a>').replace(b">pass<", written)
    (tmp_path / "certificate.xml").write_bytes(dcc)
    _, certificate = key_file.read_text().split("-----BEGIN CERTIFICATE")
    (tmp_path / "seal-certificate.pem").write_text(f"-----BEGIN CERTIFICATE{certificate}")
    [command] = re.findall(r"^xmlsec1 .*$", REPORTS, flags=re.MULTILINE)
    assert (subprocess.run(command.split(), cwd=tmp_path, capture_output=True).returncode == 0) is holds


def test_the_same_bytes_are_handed_out_again(settings: Settings, staff: Staff, key_file: Path) -> None:  # noqa: F811
    with named(settings, seal_key_file=key_file) as http:
        paper(http, staff)
        approve(http, staff)
        assert paper(http, staff) == paper(http, staff)
    with named(settings) as without_a_key:
        assert is_sound(paper(without_a_key, staff), key_file)


def test_an_expired_seal_signs_nothing(settings: Settings, staff: Staff, tmp_path: Path) -> None:  # noqa: F811
    (tmp_path / "old.pem").write_bytes(trial_key("", datetime(2020, 1, 1, tzinfo=UTC)))
    with named(settings, seal_key_file=tmp_path / "old.pem") as http:
        paper(http, staff)
        assert signed(http, staff, Role.ENGINEER, "reviewed").status_code == 201
        answer = signed(http, staff, Role.ADMIN, "approved")
    assert (answer.status_code, "must set a valid one" in answer.text) == (409, True)


@pytest.mark.parametrize("content", [b"", b"no key", b"-----BEGIN PRIVATE KEY-----\nAAAA\n-----END PRIVATE KEY-----\n"])
def test_a_key_that_is_none_is_said_at_the_start(settings: Settings, tmp_path: Path, content: bytes) -> None:  # noqa: F811
    (tmp_path / "key.pem").write_bytes(content)
    with pytest.raises(ServiceError, match="cannot be used"):
        create_app(settings.model_copy(update={"seal_key_file": tmp_path / "key.pem"}))


def test_a_certificate_of_another_key_is_refused(key_file: Path, tmp_path: Path) -> None:
    key = key_file.read_bytes().split(b"-----BEGIN CERTIFICATE")[0]
    other = b"-----BEGIN CERTIFICATE" + _other(tmp_path).read_bytes().split(b"-----BEGIN CERTIFICATE")[1]
    key_file.write_bytes(key + other)
    with pytest.raises(ServiceError, match="of another key"):
        seal_of(key_file, None)


def test_a_pkcs12_file_with_a_password_seals_too(key_file: Path, tmp_path: Path) -> None:
    words = f"pkcs12 -export -in {key_file} -out seal.p12 -passout pass:secret"
    subprocess.run(["openssl", *words.split()], cwd=tmp_path, check=True, capture_output=True)
    (tmp_path / "password").write_text("secret\n")
    seal = seal_of(tmp_path / "seal.p12", tmp_path / "password")
    assert seal is not None
    assert seal.subject == "CN=TRIAL (not trusted) Laboratory North"
    with pytest.raises(ConflictError):
        seal.require_valid(datetime(2020, 1, 1, tzinfo=UTC))
    with pytest.raises(ServiceError, match="cannot be used"):
        seal_of(tmp_path / "seal.p12", None)
