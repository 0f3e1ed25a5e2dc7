"""A printed certificate beside the one computed again, element by element.

Numbers agree where they differ by less than a ten-thousandth of their U: the paper prints two digits of U, and another
build of the linear algebra moves the last digits of a double. A covariance is compared with the standard uncertainties
of its two parameters, a number without U with itself, all else letter by letter.
"""

from collections.abc import Iterator, Mapping
from math import isfinite, sqrt

from service.kit.printable import Element
from service.papers.dcc.elements import NAMESPACES
from service.papers.dcc.measurement import COVARIANCE_OF, PROBABILITY

AGREEMENT = 1e-4
"""Part of U; also the difference of two probabilities."""
WITHOUT_U = 1e-6, 1e-12
"""Relative, and SI: of a number that has none."""
U = "valueExpandedMU"
Difference = tuple[str, str, str]
"""Place, printed value, computed value."""
Slack = Mapping[Element, tuple[float, ...]]
"""Greatest difference of every number of an element."""


def differences(printed: Element, computed: Element) -> Iterator[Difference]:
    """The differences between two certificates, in the order of the document."""
    return _differences(printed, computed, (), _slack(computed))


def numbers_in(root: Element) -> int:
    """The count of numbers in a certificate."""
    return sum(map(len, _slack(root).values()))


def _differences(printed: Element, computed: Element, above: tuple[str, ...], slack: Slack) -> Iterator[Difference]:
    name, tag = _name(computed), str(computed.tag).rpartition("}")[2]
    place = (*above, name) if name else above
    at = " › ".join((*place, "U" if tag == U else tag))
    stated, other = (element.findall("{*}*") for element in (printed, computed))
    if dict(printed.attrib) != dict(computed.attrib):
        yield at, f"{dict(printed.attrib)}", f"{dict(computed.attrib)}"
    if [child.tag for child in stated] != [child.tag for child in other]:
        said, wanted = (", ".join(_name(child) or str(child.tag) for child in children) for children in (stated, other))
        yield at, said, wanted
        return
    if not _agree(_text(printed), _text(computed), slack.get(computed, ())):
        yield at, _text(printed), _text(computed)
    for element, again in zip(stated, other, strict=True):
        yield from _differences(element, again, place, slack)


def _agree(printed: str, computed: str, slack: tuple[float, ...]) -> bool:
    if printed == computed or not slack:
        return printed == computed
    try:
        pairs = list(zip(map(float, printed.split()), map(float, computed.split()), slack, strict=True))
    except ValueError:
        return False
    return all(isfinite(number) and abs(number - other) <= least for number, other, least in pairs)


def _slack(root: Element) -> Slack:
    """Permitted difference of every number of a certificate computed again, by its element; the elements are held, so
    that they stay the same.
    """
    found: dict[Element, tuple[float, ...]] = {}
    for real in root.iterfind(".//si:real", NAMESPACES):
        numbers = {str(part.tag).rpartition("}")[2]: part for part in real.iter("{*}*")}
        value, expanded = numbers["value"], numbers.get(U)
        relative, least = WITHOUT_U
        if expanded is not None:
            found |= dict.fromkeys((value, expanded), (AGREEMENT * float(_text(expanded)),))
            parts = (numbers["coverageFactor"], numbers["coverageProbability"])
            found |= {part: (AGREEMENT * float(_text(part)),) for part in parts}
        elif _name(real.getparent()) == PROBABILITY:
            found[value] = (AGREEMENT,)
        else:
            found[value] = (max(relative * abs(float(_text(value))), least),)
    return found | dict(_of_covariances(root))


def _of_covariances(root: Element) -> Iterator[tuple[Element, tuple[float, ...]]]:
    """Each row begins with the variance of its parameter."""
    rows, sigmas = list[tuple[str, list[str], Element]](), dict[str, float]()
    for numbers in root.iterfind(".//si:realListXMLList", NAMESPACES):
        labels, values = (numbers.find(f"si:{part}XMLList", NAMESPACES) for part in ("label", "value"))
        quantity = "_".join(_name(numbers.getparent()).removeprefix(COVARIANCE_OF).split())
        rows.append((quantity, _text(labels).split(), values))
        sigmas.setdefault(quantity, sqrt(abs(float(_text(values).split()[0]))))
    for quantity, names, values in rows:
        yield values, tuple(AGREEMENT * sigmas[quantity] * sigmas[name] for name in names)


def _text(element: Element) -> str:
    return (element.text or "").strip()


def _name(element: Element) -> str:
    """The name of an element; empty where it has none."""
    found: str = element.findtext("dcc:name/dcc:content", "", NAMESPACES)
    return found
