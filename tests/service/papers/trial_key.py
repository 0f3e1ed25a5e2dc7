"""A self-signed key for trying seals: nobody else trusts it, and its name says so."""

from datetime import datetime, timedelta

from cryptography import x509
from cryptography.hazmat.primitives import hashes
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat
from cryptography.x509.oid import NameOID

VALIDITY = timedelta(days=90)
"""Long enough to try it, too short to rely on it."""
NAME = "TRIAL (not trusted) {laboratory}"
MAX_NAME_LENGTH = 64
"""Characters of a common name (RFC 5280, upper bound of X.520)."""


def trial_key(laboratory: str, now: datetime) -> bytes:
    """Key and certificate as one PEM file, for ninety days."""
    key = ec.generate_private_key(ec.SECP256R1())
    common_name = NAME.format(laboratory=laboratory or "no laboratory named")[:MAX_NAME_LENGTH]
    name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, common_name)])
    usage = x509.KeyUsage(
        digital_signature=True, content_commitment=True, key_encipherment=False, data_encipherment=False,
        key_agreement=False, key_cert_sign=False, crl_sign=False, encipher_only=False, decipher_only=False,
    )  # fmt: skip
    builder = x509.CertificateBuilder(name, name, key.public_key(), x509.random_serial_number(), now, now + VALIDITY)
    builder = builder.add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
    certificate = builder.add_extension(usage, critical=True).sign(key, hashes.SHA256())
    private_key = key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption())
    return private_key + certificate.public_bytes(Encoding.PEM)
