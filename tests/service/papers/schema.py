"""The parts of the DCC schema 3.3.0 and of D-SI 2.2.1 that our certificates use, as their documentation states them.

No package of the Python or npm registries holds the schema files. `test_dcc_schema` validates by them where they are at
hand; everywhere else every element is held to its place: which children may come, in which order, which must, and how
numbers are written.
"""

import re
from xml.etree.ElementTree import Element

DCC, SI = "{https://ptb.de/dcc}", "{https://ptb.de/si}"
TEXT = "content+"
METADATA = (
    "name? description? countryCodeISO3166_1* convention? traceable? norm* reference* link* declaration? valid? date? \
period? respAuthority? conformity? data? nonSIDefinition? nonSIUnit? location?"
)
CONTACT = "name eMail? phone? fax? location descriptionData?"
SEQUENCES = {
    "digitalCalibrationCertificate": "administrativeData measurementResults comment? document?",
    "document": "name? description? fileName mimeType dataBase64",
    "administrativeData": "dccSoftware refTypeDefinitions? coreData items calibrationLaboratory respPersons customer "
    "statements?",
    "dccSoftware": "software+",
    "usedSoftware": "software+",
    "software": "name release type? description?",
    "coreData": "countryCodeISO3166_1 usedLangCodeISO639_1+ mandatoryLangCodeISO639_1+ uniqueIdentifier "
    "identifications? receiptDate? beginPerformanceDate endPerformanceDate performanceLocation issueDate? "
    "reportAmendedSubstituted? previousReport?",
    "reportAmendedSubstituted": "typeOfChange replacedUniqueIdentifier",
    "identifications": "identification+",
    "identification": "issuer value name?",
    "items": "name? equipmentClass* description? owner? identifications? item+",
    "item": "name equipmentClass* description? installedSoftwares? manufacturer model? identifications itemQuantities?",
    "manufacturer": "name eMail? phone? fax? location? descriptionData?",
    "person": "name eMail? phone? fax? location? descriptionData?",
    "calibrationLaboratory": "calibrationLaboratoryCode? contact cryptElectronicSeal? cryptElectronicSignature? "
    "cryptElectronicTimeStamp?",
    "contact": CONTACT,
    "customer": CONTACT,
    "location": "(countryCode|further)+",
    "further": TEXT,
    "respPersons": "respPerson+",
    "respPerson": "person description? role? mainSigner?",
    "statements": "statement+",
    "statement": METADATA,
    "metaData": METADATA,
    "measurementResults": "measurementResult+",
    "measurementResult": "name description? usedMethods? usedSoftware? measuringEquipments? influenceConditions? "
    "results measurementMetaData?",
    "usedMethods": "usedMethod+",
    "usedMethod": "name description? norm* reference* link*",
    "influenceConditions": "influenceCondition+",
    "influenceCondition": "name description? status? certificate? data",
    "measuringEquipments": "name? equipmentClass* description? owner? identifications? measuringEquipment+",
    "measuringEquipment": "name equipmentClass* description? certificate? manufacturer? model? identifications?",
    "results": "result+",
    "result": "name description? data",
    "data": "(text|quantity|list)+",
    "list": "name? description? (list|quantity)+",
    "quantity": "name? description? (noQuantity|si:real|si:realListXMLList) relativeUncertainty? usedMethods? "
    "usedSoftware? measuringEquipments? influenceConditions? measurementMetaData?",
    "measurementMetaData": "metaData+",
    "si:real": "si:label? si:value si:unit si:dateTime? (si:measurementUncertaintyUnivariate)?",
    "si:measurementUncertaintyUnivariate": "si:expandedMU",
    "si:expandedMU": "si:valueExpandedMU si:coverageFactor si:coverageProbability si:distribution?",
    "si:realListXMLList": "si:labelXMLList? si:valueXMLList si:unitXMLList",
    **dict.fromkeys(("name", "description", "declaration", "text"), TEXT),
}
DECIMAL = r"((\d*\.\d+)|(\d+\.\d*)|(\d+\.?))([Ee][-+]?\d+)?"
ENUMERATED = {
    "issuer": "manufacturer|calibrationLaboratory|customer|owner|other",
    "type": "application|bios|driver|editor|firmware|library|os|other",
    "performanceLocation": "laboratory|customer|laboratoryBranch|customerBranch|other",
    "conformity": "pass|fail|conditionalPass|conditionalFail|noPass|noFail",
    "countryCode": "[A-Z]{2}",
    "countryCodeISO3166_1": "[A-Z]{2}",
    "usedLangCodeISO639_1": "[a-z]{2}",
    "mandatoryLangCodeISO639_1": "[a-z]{2}",
    "mainSigner": "true|false|0|1",
    "traceable": "true|false|0|1",
    "typeOfChange": "amended|substituted",
    "release": r"[a-zA-Z] ?(\d{1,3}\.){0,3}\d{1,3}",
    "beginPerformanceDate": r"\d{4}-\d\d-\d\d",
    "endPerformanceDate": r"\d{4}-\d\d-\d\d",
    "issueDate": r"\d{4}-\d\d-\d\d",
    "si:value": f"[-+]?{DECIMAL}",
    "si:valueExpandedMU": rf"\+?{DECIMAL}",
    "si:valueXMLList": rf"[-+]?{DECIMAL}( [-+]?{DECIMAL})*",
    "si:unitXMLList": r"(\\[a-z]+(\\tothe\{-?\d+\})?)+",
    "si:coverageFactor": r"\+?(([1-9]\d*\.\d*)|([1-9]\d*))",
    "si:coverageProbability": r"\+?((0(\.\d*)?)|(1(\.0*)?))",
    "si:unit": r"(\\[a-z]+(\\tothe\{-?\d+\})?)+",
    "si:distribution": r"normal|t, [\d.e+]+ effective degrees of freedom",
}
NOT_EMPTY = r"[^\s]+(\s+[^\s]+)*"


def faults(root: Element) -> list[str]:
    """Every element that is not where, or not what, the schema allows."""
    return [fault for element in root.iter() for fault in _faults(element)]


def _faults(element: Element) -> list[str]:
    name, children = short(element), [short(child) for child in element]
    text = (element.text or "").strip()
    if name in SEQUENCES:
        pattern = re.sub(r"[\w:]+", lambda found: f"(?:{found[0]},)", SEQUENCES[name]).replace(" ", "")
        if not re.fullmatch(pattern, "".join(f"{child}," for child in children)):
            return [f"{name} holds {' '.join(children)}"]
        return [f"{name} holds text"] if text else []
    if children:
        return [f"{name} is not known to hold anything"]
    wanted = ENUMERATED.get(name, NOT_EMPTY)
    return [] if re.fullmatch(wanted, element.text or "") else [f"{name} is {element.text!r}"]


def short(element: Element) -> str:
    """The name of an element, those of D-SI with their prefix."""
    return element.tag.replace(DCC, "").replace(SI, "si:")
