"""A Digital Calibration Certificate with a seal: XAdES B-B (ETSI EN 319 132-1), enveloped, as its last element."""

from cryptography.hazmat.primitives.asymmetric.rsa import RSAPrivateKey
from lxml import etree
from signxml.algorithms import DigestAlgorithm, SignatureConstructionMethod, SignatureMethod
from signxml.xades.xades import XAdESDataObjectFormat, XAdESSigner

from service.kit.printable import sealed_document
from service.papers.seal.keys import KeyPair

DESCRIPTION = "Digital Calibration Certificate"
"""Description of the signed data in the signature."""


def sealed_xml(pair: KeyPair, content: bytes) -> bytes:
    """The same document with a signature over all of it."""
    is_rsa = isinstance(pair.key, RSAPrivateKey)
    signer = XAdESSigner(
        method=SignatureConstructionMethod.enveloped,
        signature_algorithm=SignatureMethod.RSA_SHA256 if is_rsa else SignatureMethod.ECDSA_SHA256,
        digest_algorithm=DigestAlgorithm.SHA256,
        data_object_format=XAdESDataObjectFormat(Description=DESCRIPTION, MimeType="text/xml"),
    )
    signed = signer.sign(etree.fromstring(content), key=pair.key, cert=[pair.certificate, *pair.chain])
    return sealed_document(signed)
