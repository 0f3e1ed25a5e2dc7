"""A certificate with one thing changed that it states: what somebody might wish that it said."""

import random
from collections.abc import Callable
from datetime import date, timedelta

from lxml import etree
from lxml.etree import _Element as Element

from service.papers.dcc.digest import SIGNATURE, digest_of, parsed
from service.papers.dcc.elements import NAMESPACES

Change = Callable[[Element, random.Random], None]
"""Changes a certificate in one place, drawn."""


def _found(root: Element, path: str, rng: random.Random) -> Element:
    """One of the elements of a path."""
    return rng.choice(root.xpath(path, namespaces=NAMESPACES))


def value(root: Element, rng: random.Random) -> None:
    """A value moved by a hundredth of its U, or the U itself."""
    element = _found(root, "//si:real[.//si:valueExpandedMU]", rng)
    expanded = element.find(".//si:valueExpandedMU", NAMESPACES)
    changed = rng.choice((element.find("si:value", NAMESPACES), expanded))
    changed.text = repr(float(changed.text) + rng.choice((-1, 1)) * float(expanded.text) / 100)


def limit(root: Element, rng: random.Random) -> None:
    """A tolerance, guard band or condition."""
    path = (
        "//dcc:quantity[dcc:name/dcc:content != 'probability of being out of tolerance']/si:real[not(.//si:expandedMU)]"
    )
    changed = _found(root, f"{path}/si:value", rng)
    changed.text = repr(1.001 * float(changed.text))


def digit(root: Element, rng: random.Random) -> None:
    """Any digit of any number."""
    changed = _found(root, "//si:value | //si:valueExpandedMU | //si:valueXMLList | //si:coverageFactor", rng)
    place = rng.choice([k for k, character in enumerate(changed.text) if character.isdigit()])
    other = rng.choice([c for c in "0123456789" if c != changed.text[place]])
    changed.text = changed.text[:place] + other + changed.text[place + 1 :]


def variance(root: Element, rng: random.Random) -> None:
    """The variance of a parameter."""
    rows = root.xpath("//dcc:quantity[starts-with(dcc:name/dcc:content, 'covariance of')]", namespaces=NAMESPACES)
    first_of_rows = {row.findtext("dcc:name/dcc:content", "", NAMESPACES): row for row in reversed(rows)}
    changed = rng.choice(list(first_of_rows.values())).find("si:realListXMLList/si:valueXMLList", NAMESPACES)
    own, *others = changed.text.split()
    changed.text = " ".join((repr(1.01 * float(own)), *others))


def measure(root: Element, rng: random.Random) -> None:
    """A unit."""
    changed = _found(root, "//si:unit", rng)
    changed.text = rng.choice([u for u in (r"\metre", r"\radian", r"\second", r"\volt") if u != changed.text])


def verdict(root: Element, rng: random.Random) -> None:
    """A decision."""
    changed = _found(root, "//dcc:conformity", rng)
    changed.text = "pass" if changed.text != "pass" else "fail"


def day(root: Element, rng: random.Random) -> None:
    """The day of measurement."""
    changed = _found(root, "//dcc:beginPerformanceDate | //dcc:endPerformanceDate", rng)
    changed.text = f"{date.fromisoformat(changed.text) + timedelta(days=rng.randint(1, 400))}"


def file(root: Element, rng: random.Random) -> None:
    """The session or the hash of its file."""
    changed = _found(root, "//dcc:coreData/dcc:identifications/dcc:identification[position() < 3]/dcc:value", rng)
    changed.text = ("1" if changed.text[0] == "0" else "0") + changed.text[1:]


def moved(root: Element, rng: random.Random) -> None:
    """Two quantities in each other's place."""
    first, second = rng.sample(root.xpath("//dcc:quantity[.//si:expandedMU]", namespaces=NAMESPACES), 2)
    place = second.getparent()
    mark = etree.Element("mark")
    place.replace(second, mark)
    first.getparent().replace(first, second)
    place.replace(mark, first)


def gone(root: Element, rng: random.Random) -> None:
    """A quantity, a statement or a condition left out."""
    element = _found(root, "//dcc:quantity | //dcc:statement | //dcc:influenceCondition | //dcc:usedMethod", rng)
    element.getparent().remove(element)


def sensor(root: Element, rng: random.Random) -> None:
    """The name of a sensor, or the unit's serial number."""
    path = "//dcc:result/dcc:name/dcc:content | //dcc:item/dcc:identifications/dcc:identification/dcc:value"
    changed = _found(root, path, rng)
    changed.text += "1"


def name(root: Element, rng: random.Random) -> None:
    """The issuer, the customer, the person who measured, or the date of issue."""
    path = "//dcc:contact//dcc:content | //dcc:customer//dcc:content | //dcc:respPerson//dcc:content | //dcc:issueDate"
    changed = _found(root, f"{path} | //dcc:uniqueIdentifier", rng)
    changed.text = ("3" if changed.text[0] == "2" else "2") + changed.text[1:]


def seal(root: Element, rng: random.Random) -> None:
    """The electronic seal, in it or of it."""
    [own] = root.findall(SIGNATURE)
    if rng.random() < 0.5:
        root.remove(own)
        return
    changed = _found(root, "//*[local-name()='DigestValue' or local-name()='SignatureValue']", rng)
    place = rng.randrange(len(changed.text) // 2)
    changed.text = changed.text[:place] + ("A" if changed.text[place] != "A" else "B") + changed.text[place + 1 :]


FROM_FILE = (value, limit, variance, measure, verdict, day, file, moved, gone, sensor)
"""Changes that contradict the file, even where the hash is made anew and the seal taken off."""
GUARDED = (digit, name, seal, *FROM_FILE)
"""Changes that hash and seal reveal."""


def mutated(sealed: bytes, seed: int) -> bytes:
    """The certificate with one change: with its seal, or as somebody would write it anew without."""
    rng = random.Random(seed)
    root = parsed(sealed)
    if seed % 2:
        rng.choice(GUARDED)(root, rng)
        return etree.tostring(root)
    rng.choice(FROM_FILE)(root, rng)
    return anew(root)


def anew(root: Element) -> bytes:
    """The certificate without a seal, and with a hash that fits."""
    for own in root.findall(SIGNATURE):
        root.remove(own)
    path = "//dcc:coreData/dcc:identifications/dcc:identification[last()]/dcc:value"
    for hash_of_contents in root.xpath(path, namespaces=NAMESPACES):
        hash_of_contents.text = digest_of(root)
    return etree.tostring(root)
