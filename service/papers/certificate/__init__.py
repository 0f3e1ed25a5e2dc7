"""The certificate of a session, on paper, for signature."""

from dataclasses import dataclass

from service.languages.language import Language
from service.papers.certificate.drawings import Drawing, histories_of, residuals_of
from service.papers.certificate.words import Certificate, SignatureLine, certificate, lines_of
from service.papers.certified import CertifiedSession
from service.papers.records import UNSIGNED, Issue, Signed
from service.papers.typeset import typeset


@dataclass(frozen=True)
class DrawnCertificate:
    """The contents of a certificate with its charts."""

    words: Certificate
    histories: tuple[Drawing, ...]
    residuals: tuple[Drawing, ...]
    signatures: tuple[SignatureLine, ...]
    sealed_by: str
    """Owner of the electronic seal of the file; empty where it has none."""


def certificate_pdf(
    found: CertifiedSession, issue: Issue, signed: Signed = UNSIGNED, language: Language = Language.ENGLISH
) -> bytes:
    """The certificate as PDF; its date is the date of issue, so one issue always gives the same bytes."""
    return typeset("certificate.typ", drawn_certificate(found, issue, signed, language), issue.issued_at, language)


def drawn_certificate(
    found: CertifiedSession, issue: Issue, signed: Signed = UNSIGNED, language: Language = Language.ENGLISH
) -> DrawnCertificate:
    """The data for the typesetter, with charts in a language."""
    return DrawnCertificate(
        certificate(found, issue),
        histories_of(found, language),
        residuals_of(found, language),
        lines_of(signed),
        signed.sealed_by,
    )
