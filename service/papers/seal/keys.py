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
"""What NIST SP 800-57 asks of keys until 2030."""
UNREADABLE = "The key of the seal, {file}, cannot be used: {fault}."
Key = RSAPrivateKey | EllipticCurvePrivateKey


@dataclass(frozen=True)
class KeyPair:
    """What seals, and what tells others whose seal it is."""

    key: Key
    certificate: x509.Certificate
    chain: tuple[x509.Certificate, ...]
    """Of those who vouch for it, as far as the file holds them."""

    @property
    def subject(self) -> str:
        """Whose it is, in one line."""
        return self.certificate.subject.rfc4514_string()


def read_key(file: Path, password_file: Path | None) -> KeyPair:
    """The key of a file; ServiceError where it is none, or too weak, or of another certificate."""
    try:
        content = file.read_bytes()
        password = None if password_file is None else password_file.read_bytes().rstrip(b"\r\n")
        pair = _from_pem(content, password) if PEM in content else _from_pkcs12(content, password)
    except (OSError, ValueError, TypeError) as fault:
        raise ServiceError(say(UNREADABLE, file=file, fault=fault)) from fault
    fault_found = _fault_of(pair)
    if fault_found:
        raise ServiceError(say(UNREADABLE, file=file, fault=fault_found))
    return pair


def require_valid(pair: KeyPair, now: datetime) -> None:
    """ConflictError outside of the time for which the certificate was made."""
    since, until = pair.certificate.not_valid_before_utc, pair.certificate.not_valid_after_utc
    if not since <= now <= until:
        raise ConflictError(
            say(
                "The certificate of the laboratory's seal holds from {start} to {end}: whoever runs "
                "the service must set a valid one. Nothing was signed.",
                start=f"{since:%Y-%m-%d}",
                end=f"{until:%Y-%m-%d}",
            )
        )


def _from_pem(content: bytes, password: bytes | None) -> KeyPair:
    key = load_pem_private_key(content, password)
    own, *chain = x509.load_pem_x509_certificates(content)
    return KeyPair(_usable(key), own, tuple(chain))


def _from_pkcs12(content: bytes, password: bytes | None) -> KeyPair:
    key, own, chain = pkcs12.load_key_and_certificates(content, password)
    if own is None:
        raise ValueError("it holds no certificate")
    return KeyPair(_usable(key), own, tuple(chain))


def _usable(key: object) -> Key:
    if isinstance(key, RSAPrivateKey | EllipticCurvePrivateKey):
        return key
    raise ValueError("it holds no RSA key and none of an elliptic curve")


def _fault_of(pair: KeyPair) -> str:
    """What is wrong with it; empty where nothing is."""
    own, shown = pair.key.public_key(), pair.certificate.public_key()
    plain = Encoding.DER, PublicFormat.SubjectPublicKeyInfo
    if own.public_bytes(*plain) != shown.public_bytes(*plain):
        return "its certificate, which must be the first one, is of another key"
    fewest = FEWEST_RSA_BITS if isinstance(pair.key, RSAPrivateKey) else FEWEST_CURVE_BITS
    if pair.key.key_size < fewest:
        return say("it has {key_size} bits; {fewest} are needed", key_size=pair.key.key_size, fewest=fewest)
    return ""
