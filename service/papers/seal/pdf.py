"""A PDF with a seal: PAdES B-B (ETSI EN 319 142-1), certified so that no later change is allowed."""

import io
from concurrent.futures import ThreadPoolExecutor

from asn1crypto.keys import PrivateKeyInfo
from asn1crypto.x509 import Certificate
from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat
from pyhanko.pdf_utils.incremental_writer import IncrementalPdfFileWriter
from pyhanko.sign.fields import MDPPerm, SigSeedSubFilter
from pyhanko.sign.signers import PdfSignatureMetadata, SimpleSigner, sign_pdf
from pyhanko_certvalidator.registry import SimpleCertificateStore

from service.papers.seal.keys import KeyPair

FIELD = "Seal"
"""Form field of the signature, which is not drawn."""
REASON = "Approved calibration certificate"


def sealed_pdf(pair: KeyPair, content: bytes) -> bytes:
    """The document with a signature appended; no byte before it is changed."""
    meta = PdfSignatureMetadata(
        field_name=FIELD,
        reason=REASON,
        md_algorithm="sha256",
        subfilter=SigSeedSubFilter.PADES,
        certify=True,
        docmdp_permissions=MDPPerm.NO_CHANGES,
    )
    out = io.BytesIO()
    with ThreadPoolExecutor(1) as apart:  # the library runs a loop of its own, which no thread that has one may
        apart.submit(sign_pdf, IncrementalPdfFileWriter(io.BytesIO(content)), meta, _signer(pair), output=out).result()
    return out.getvalue()


def _signer(pair: KeyPair) -> SimpleSigner:
    """The key pair as pyhanko's signer."""
    key = pair.key.private_bytes(Encoding.DER, PrivateFormat.PKCS8, NoEncryption())
    certificates = (Certificate.load(item.public_bytes(Encoding.DER)) for item in (pair.certificate, *pair.chain))
    certificate, *chain = certificates
    store = SimpleCertificateStore()  # type: ignore[no-untyped-call]
    store.register_multiple(chain)
    return SimpleSigner(certificate, PrivateKeyInfo.load(key), store)
