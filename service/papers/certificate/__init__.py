"""The certificate of a session, on paper: what a technician signs."""

from dataclasses import dataclass

from service.languages.language import Language
from service.papers.certificate.drawings import Drawing, histories_of, residuals_of
from service.papers.certificate.words import UNSIGNED, Certificate, SignatureLine, Signed, certificate, lines_of
from service.papers.certified import CertifiedSession
from service.papers.records import Issue
from service.papers.typeset import typeset


@dataclass(frozen=True)
class DrawnCertificate:
    """The words with their charts."""

    words: Certificate
    histories: tuple[Drawing, ...]
    residuals: tuple[Drawing, ...]
    signatures: tuple[SignatureLine, ...]
    sealed_by: str
    """Whose electronic seal the file carries; empty where it has none."""


def certificate_pdf(
    found: CertifiedSession, issue: Issue, signed: Signed = UNSIGNED, language: Language = Language.ENGLISH
) -> bytes:
    """The certificate as PDF; it carries the date of issue, so that one issue gives the same bytes every time."""
    return typeset("certificate.typ", drawn_certificate(found, issue, signed, language), issue.issued_at, language)


def drawn_certificate(
    found: CertifiedSession, issue: Issue, signed: Signed = UNSIGNED, language: Language = Language.ENGLISH
) -> DrawnCertificate:
    """All that the typesetter is given, its drawings in a language."""
    return DrawnCertificate(
        certificate(found, issue),
        histories_of(found, language),
        residuals_of(found, language),
        lines_of(signed),
        signed.sealed_by,
    )
