"""The key of a seal with its certificate: one PEM file with both, or a PKCS#12 file."""

from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from cryptography import x509
from cryptography.hazmat.primitives.asymmetric.ec import EllipticCurvePrivateKey
from cryptography.hazmat.primitives.asymmetric.rsa import RSAPrivateKey
from cryptography.hazmat.primitives.serialization import Encoding, PublicFormat, load_pem_private_key, pkcs12

from estimator.message import say
from service.errors import ConflictError, ServiceError

PEM = b"-----BEGIN "
FEWEST_RSA_BITS, FEWEST_CURVE_BITS = 2048, 256
"""Minimum by NIST SP 800-57 until 2030."""
UNREADABLE = "The key of the seal, {file}, cannot be used: {fault}."
Key = RSAPrivateKey | EllipticCurvePrivateKey


@dataclass(frozen=True)
class KeyPair:
    """The key of a seal, and its certificates."""

    key: Key
    certificate: x509.Certificate
    chain: tuple[x509.Certificate, ...]
    """Certificates of its issuers, as far as the file holds them."""

    @property
    def subject(self) -> str:
        """Owner, in one line."""
        return self.certificate.subject.rfc4514_string()


def read_key(file: Path, password_file: Path | None) -> KeyPair:
    """The key in a file; ServiceError for a missing or weak key, or one of another certificate."""
    try:
        content = file.read_bytes()
        password = None if password_file is None else password_file.read_bytes().rstrip(b"\r\n")
        pair = _from_pem(content, password) if PEM in content else _from_pkcs12(content, password)
    except (OSError, ValueError, TypeError) as fault:
        raise ServiceError(UNREADABLE, file=file, fault=fault) from fault
    weakness = _fault_of(pair)
    if weakness:
        raise ServiceError(UNREADABLE, file=file, fault=weakness)
    return pair


def require_valid(pair: KeyPair, now: datetime) -> None:
    """ConflictError outside of the validity of the certificate."""
    start, end = pair.certificate.not_valid_before_utc, pair.certificate.not_valid_after_utc
    if not start <= now <= end:
        raise ConflictError(
            "The certificate of the laboratory's seal holds from {start} to {end}: whoever runs "
            "the service must set a valid one. Nothing was signed.",
            start=f"{start:%Y-%m-%d}",
            end=f"{end:%Y-%m-%d}",
        )


def _from_pem(content: bytes, password: bytes | None) -> KeyPair:
    key = load_pem_private_key(content, password)
    certificate, *chain = x509.load_pem_x509_certificates(content)
    return KeyPair(_usable(key), certificate, tuple(chain))


def _from_pkcs12(content: bytes, password: bytes | None) -> KeyPair:
    key, certificate, chain = pkcs12.load_key_and_certificates(content, password)
    if certificate is None:
        raise ValueError("it holds no certificate")
    return KeyPair(_usable(key), certificate, tuple(chain))


def _usable(key: object) -> Key:
    if isinstance(key, RSAPrivateKey | EllipticCurvePrivateKey):
        return key
    raise ValueError("it holds no RSA key and none of an elliptic curve")


def _fault_of(pair: KeyPair) -> str:
    """The fault of a key pair in words; empty where there is none."""
    public_key, certified_key = pair.key.public_key(), pair.certificate.public_key()
    encoding = Encoding.DER, PublicFormat.SubjectPublicKeyInfo
    if public_key.public_bytes(*encoding) != certified_key.public_bytes(*encoding):
        return "its certificate, which must be the first one, is of another key"
    minimum = FEWEST_RSA_BITS if isinstance(pair.key, RSAPrivateKey) else FEWEST_CURVE_BITS
    if pair.key.key_size < minimum:
        return say("it has {key_size} bits; {fewest} are needed", key_size=pair.key.key_size, fewest=minimum)
    return ""
