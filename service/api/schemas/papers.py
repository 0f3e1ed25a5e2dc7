"""What papers name: customers, certificates of stands, numbers of certificates, traceability."""

from datetime import date, datetime

from pydantic import BaseModel, ConfigDict, Field

from service.api.schemas.fields import TEXT, Day, LongText, Said, Text
from service.records.paper import TraceState
from service.records.signature import Meaning


class CustomerSchema(BaseModel):
    """For whom a unit is calibrated, as its certificates name them."""

    model_config = ConfigDict(from_attributes=True, extra="forbid")

    name: Text = Field(default="", description="Empty where it is not stated.", examples=["Aero Works Ltd"])
    address: LongText = Field(default="", description="Where they can be reached.", examples=["1 Hangar Road, Derby"])


class NewCustomer(CustomerSchema):
    """For whom a unit is calibrated, and who says so."""

    by: Text = Field(default="crew", description="Your name.")


class NewStandCertificate(BaseModel):
    """The certificate of a stand's own calibration."""

    model_config = ConfigDict(extra="forbid")

    number: Said = Field(description="As printed on it; one of a number that is there takes its place.")
    issued_by: Said = Field(description="The laboratory that calibrated the stand.")
    issued_on: Day = Field(description="From this day on it speaks for the stand.", examples=["2026-01-10"])
    valid_until: Day = Field(description="The last day on which it holds.", examples=["2027-01-10"])
    by: Said = Field(description="Your name.")


class StandCertificateSchema(BaseModel):
    """The certificate of a stand's own calibration."""

    model_config = ConfigDict(from_attributes=True)

    stand: str = Field(description="Name of the stand.")
    number: str = Field(description="As printed on it.")
    issued_by: str = Field(description="The laboratory that calibrated the stand.")
    issued_on: date = Field(description="From this day on it speaks for the stand.")
    valid_until: date = Field(description="The last day on which it holds.")


class StandCertificateList(BaseModel):
    """The certificates of one stand, oldest first."""

    certificates: list[StandCertificateSchema] = Field(description="As they were last recorded.")


class TraceabilitySchema(BaseModel):
    """What a session's numbers hang on."""

    model_config = ConfigDict(from_attributes=True)

    state: TraceState = Field(
        description="`traceable`; `interrupted`: the stand's certificate had expired at the day of measurement; "
        "`not-stated`: none that held is on record; `no-stand`."
    )
    text: str = Field(description="In one or two sentences, as on the certificate.")
    certificate: StandCertificateSchema | None = Field(
        description="Of the stand, the latest that was issued by the day of measurement."
    )


class SignatureSchema(BaseModel):
    """One signature under a certificate."""

    model_config = ConfigDict(from_attributes=True)

    certificate: str = Field(description="Number of the certificate.")
    meaning: Meaning = Field(description="What it says.")
    login: str = Field(description="Account that signed, with its password.")
    name: str = Field(description="As it is printed.")
    signed_at: datetime = Field(description="UTC.")
    content_hash: str = Field(description="SHA-256 of all that the certificate stated when it was signed.")


class NewSignature(BaseModel):
    """A name that is to stand under a certificate."""

    model_config = ConfigDict(extra="forbid")

    number: Said = Field(description="Of the certificate that you read; one that is not the latest is refused.")
    meaning: Meaning = Field(description="A certificate is reviewed first, and approved by somebody else.")
    password: str = Field(max_length=1000, pattern=TEXT, description="Of your account, asked again.")


class IssueSchema(BaseModel):
    """One issue of a session's certificate."""

    model_config = ConfigDict(from_attributes=True)

    number: str = Field(description="Session, model revision, and count of the issue.")
    session: str = Field(description="Id of the session.")
    revision: int = Field(description="Model revision of its numbers; 0 is the baseline.")
    issued_at: datetime = Field(description="UTC.")
    who: str = Field(description="Who issued it.")
    replaces: str | None = Field(description="Number of the certificate that it takes the place of.")
    content_hash: str = Field(description="SHA-256 of all that it states.")
    signatures: list[SignatureSchema] = Field(default=[], description="Who signed it, in their order.")


class IssueList(BaseModel):
    """Every issue of a session's certificate."""

    certificates: list[IssueSchema] = Field(description="The first one first; the last one holds.")
    is_current: bool = Field(
        default=False, description="Whether the last one states what is stored now; another number is due if not."
    )
    concerns: list[str] = Field(default=[], description="What speaks against using the last one, in words.")
