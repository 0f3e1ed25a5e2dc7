"""A Digital Calibration Certificate with a seal: XAdES B-B (ETSI EN 319 132-1), enveloped, as its last element."""

from base64 import b64decode
from datetime import datetime

from cryptography.hazmat.primitives.asymmetric.rsa import RSAPrivateKey
from cryptography.x509 import load_der_x509_certificate, load_pem_x509_certificate
from lxml import etree
from signxml.algorithms import DigestAlgorithm, SignatureConstructionMethod, SignatureMethod
from signxml.exceptions import InvalidInput, InvalidSignature
from signxml.xades.xades import XAdESDataObjectFormat, XAdESSignatureConfiguration, XAdESSigner, XAdESVerifier

from service.kit.printable import sealed_document
from service.papers.seal.keys import KeyPair

DESCRIPTION = "Digital Calibration Certificate"
"""Description of the signed data in the signature."""


def sealed_xml(pair: KeyPair, content: bytes) -> bytes:
    """The document with a signature over all of it."""
    is_rsa = isinstance(pair.key, RSAPrivateKey)
    signer = XAdESSigner(
        method=SignatureConstructionMethod.enveloped,
        signature_algorithm=SignatureMethod.RSA_SHA256 if is_rsa else SignatureMethod.ECDSA_SHA256,
        digest_algorithm=DigestAlgorithm.SHA256,
        data_object_format=XAdESDataObjectFormat(Description=DESCRIPTION, MimeType="text/xml"),
    )
    signed = signer.sign(etree.fromstring(content), key=pair.key, cert=[pair.certificate, *pair.chain])
    return sealed_document(signed)


DS, XADES = "{http://www.w3.org/2000/09/xmldsig#}", "{http://uri.etsi.org/01903/v1.3.2#}"


def owner_of_seal(content: bytes, trusted: bytes | None) -> str:
    """The subject of the certificate of a document's seal; ValueError in words where the seal does not hold.

    ``trusted``: the certificate in PEM that the seal must be of; None takes the one that came with the document.
    """
    root = etree.fromstring(content)
    try:
        enclosed = b64decode(root.findtext(f"{DS}Signature/{DS}KeyInfo/{DS}X509Data/{DS}X509Certificate", ""))
        certificate = load_der_x509_certificate(enclosed) if trusted is None else load_pem_x509_certificate(trusted)
        at = datetime.fromisoformat(root.findtext(f".//{XADES}SigningTime", ""))
        config = XAdESSignatureConfiguration(location="./", verification_time=at)
        signed = XAdESVerifier().verify(content, x509_cert=certificate, expect_config=config)
    except (InvalidInput, InvalidSignature, etree.LxmlError) as fault:
        raise ValueError(str(fault)) from fault
    if not any(part.signed_xml is not None and part.signed_xml.tag == root.tag for part in signed):
        raise ValueError("it is not a seal of the whole document")
    return certificate.subject.rfc4514_string()
