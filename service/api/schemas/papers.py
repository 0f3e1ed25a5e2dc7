"""What papers name: customers, certificates of stands, numbers of certificates, traceability."""

from pydantic import BaseModel, ConfigDict, Field

from service.api.schemas.fields import TEXT, Day, LongText, Said, Text
from service.records.paper import StandCertificate
from service.records.signature import Meaning


class NewCustomer(BaseModel):
    """For whom a unit is calibrated, and who says so."""

    model_config = ConfigDict(extra="forbid")

    name: Text = Field(default="", description="Empty where it is not stated.", examples=["Aero Works Ltd"])
    address: LongText = Field(default="", description="Where they can be reached.", examples=["1 Hangar Road, Derby"])
    by: Text = Field(default="crew", description="Your name.")


class NewStandCertificate(BaseModel):
    """The certificate of a stand's own calibration."""

    model_config = ConfigDict(extra="forbid")

    number: Said = Field(description="As printed on it; one of a number that is there takes its place.")
    issued_by: Said = Field(description="The laboratory that calibrated the stand.")
    issued_on: Day = Field(description="From this day on it speaks for the stand.", examples=["2026-01-10"])
    valid_until: Day = Field(description="The last day on which it holds.", examples=["2027-01-10"])
    by: Said = Field(description="Your name.")


class StandCertificateList(BaseModel):
    """The certificates of one stand, oldest first."""

    certificates: tuple[StandCertificate, ...] = Field(description="As they were last recorded.")


class NewSignature(BaseModel):
    """A name that is to stand under a certificate."""

    model_config = ConfigDict(extra="forbid")

    number: Said = Field(description="Of the certificate that you read; one that is not the latest is refused.")
    meaning: Meaning = Field(description="A certificate is reviewed first, and approved by somebody else.")
    password: str = Field(max_length=1000, pattern=TEXT, description="Of your account, asked again.")
