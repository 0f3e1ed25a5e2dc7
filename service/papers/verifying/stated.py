"""Contents of a certificate that the session's file does not tell; they are set into the one computed again."""

import json
from base64 import b64decode
from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass
from datetime import UTC, datetime

from service.kit.printable import Element
from service.papers.dcc.administrative import UNKNOWN_COUNTRY
from service.papers.dcc.elements import NAMESPACES
from service.papers.dcc.inputs import RecomputationInputs
from service.papers.records import NOT_STATED, Issue, Laboratory
from service.storage.json_text import STORED
from service.units.records import Customer

CORE, ITEM = "dcc:administrativeData/dcc:coreData/", "dcc:administrativeData/dcc:items/dcc:item/"


@dataclass(frozen=True, eq=False)
class Printed:
    """A certificate that was read."""

    root: Element

    def text(self, path: str) -> str:
        """Text of one element; empty where there is none."""
        return (self.root.findtext(path, "", NAMESPACES) or "").strip()

    def identified(self, name: str) -> str:
        """The value of an identification of the certificate."""
        return self.text(f"{CORE}dcc:identifications/dcc:identification[dcc:name='{name}']/dcc:value")

    def declared(self, statement: str) -> str:
        """The words of a statement."""
        return self.text(f".//dcc:statement[dcc:name='{statement}']/dcc:declaration/dcc:content")

    @property
    def serial(self) -> str:
        """Serial number of the unit."""
        return self.text(f"{ITEM}dcc:identifications/dcc:identification/dcc:value")

    @property
    def unit_type(self) -> str:
        """Name of the unit type."""
        return self.text(f"{ITEM}dcc:model")

    @property
    def version(self) -> str:
        """Version of the program that made the certificate."""
        name = self.text(".//dcc:dccSoftware/dcc:software/dcc:name/dcc:content")
        release = self.text(".//dcc:dccSoftware/dcc:software/dcc:release").removeprefix("v")
        return name.removeprefix("imu-health").strip() or release

    @property
    def measured_on(self) -> datetime:
        """The day; ValueError where it is none."""
        return datetime.fromisoformat(self.text(f"{CORE}dcc:beginPerformanceDate")).replace(tzinfo=UTC)

    @property
    def is_sealed(self) -> bool:
        """Whether it says that it has an electronic seal."""
        return any(element.text == "true" for element in self.root.iterfind(".//dcc:cryptElectronicSeal", NAMESPACES))

    @property
    def signers(self) -> Sequence[Element]:
        """Elements of the signers; the operator stands before them."""
        return deepcopy(self.root.findall(".//dcc:respPersons/dcc:respPerson", NAMESPACES)[1:])

    @property
    def inputs_document(self) -> Sequence[Element]:
        """Elements that hold the inputs of the recomputation."""
        return deepcopy(self.root.findall("dcc:document", NAMESPACES))

    @property
    def laboratory(self) -> Laboratory:
        """Laboratory that issued the certificate."""
        contact = ".//dcc:calibrationLaboratory/dcc:contact/"
        country = self.text(f"{contact}dcc:location/dcc:countryCode") or self.text(f"{CORE}dcc:countryCodeISO3166_1")
        elsewhere = self.text(f"{CORE}dcc:performanceLocation") == "other"
        known = country if country != UNKNOWN_COUNTRY else ""
        return Laboratory(*self._contact(contact), country=known, place="elsewhere" if elsewhere else "")

    @property
    def customer(self) -> Customer:
        """Customer of the certificate."""
        return Customer(*self._contact(".//dcc:customer/"))

    def _contact(self, path: str) -> tuple[str, str]:
        texts = (self.text(f"{path}{part}/dcc:content") for part in ("dcc:name", "dcc:location/dcc:further"))
        name, address = ("" if text == NOT_STATED else text for text in texts)
        return name, address

    def issue(self) -> Issue:
        """Number and date of the certificate; ValueError where its date is none."""
        date = datetime.fromisoformat(self.text(f"{CORE}dcc:issueDate")).replace(tzinfo=UTC)
        replaced = self.text(f"{CORE}dcc:reportAmendedSubstituted/dcc:replacedUniqueIdentifier") or None
        return Issue(self.text(f"{CORE}dcc:uniqueIdentifier"), self.identified("Session"), 0, date, "", replaced, "")

    def inputs(self) -> RecomputationInputs | None:
        """Inputs of the recomputation; None in a certificate of a release that stated none, ValueError where they
        cannot be read.
        """
        encoded = self.text("dcc:document/dcc:dataBase64")
        if not encoded:
            return None
        return STORED.read(RecomputationInputs, json.loads(b64decode(encoded, validate=False)))
