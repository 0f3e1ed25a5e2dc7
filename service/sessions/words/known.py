"""What is known of parameters that a session cannot tell apart, as a sum in people's measures."""

from dataclasses import dataclass

from estimator.message import joined, say
from estimator.results import KnownCombination
from service.kit.measures import COVERAGE, MINUS, Measure, measured, scale_measure, value_measure

READING_TERMS = {
    "zero_reading": ("K·b", 0),
    "sensitivity_x": ("K·e_x", 1),
    "sensitivity_y": ("K·e_y", 1),
    "sensitivity_z": ("K·e_z", 1),
    "quadratic_reading": ("K·c", 2),
}
"""What readings are linear in: how it is written, and the power of the input that it multiplies."""
NEGLIGIBLE = 1e-6
"""Share of the largest term below which a term is not written: six decimals show nothing of it."""


@dataclass(frozen=True)
class _Term:
    """One quantity of a sum, with its coefficient and people's measure."""

    name: str
    measure: Measure
    coefficient: float


def combination_in_words(known: KnownCombination, kind: str) -> str:
    """``bias + 0.5 × quadratic = 12.3 ± 0.4 µg``; readings in their own unit, per g (per °/s) and its square."""
    terms = [_term(name, coefficient, kind) for name, coefficient in known.coefficients.items()]
    lead = max(terms, key=lambda t: abs(t.coefficient))
    shares = [(t.coefficient / lead.coefficient, t.name) for t in terms]
    first, *others = [(share, name) for share, name in shares if abs(share) > NEGLIGIBLE]
    rest = joined(
        "",
        (
            say(" {sign} {product}", sign=MINUS if share < 0 else "+", product=_product(abs(share), name))
            for share, name in others
        ),
    )
    expanded = None if known.sigma is None else COVERAGE * known.sigma
    total = measured(known.value, expanded, Measure(lead.measure.label, 1 / lead.coefficient)).rstrip()
    sign, product = MINUS if first[0] < 0 else "", _product(abs(first[0]), first[1])
    return say("{sign}{product}{rest} = {total}", sign=sign, product=product, rest=rest, total=total)


def _term(name: str, coefficient: float, kind: str) -> _Term:
    element = name.rpartition(".")[2]
    if element in READING_TERMS:
        written, power = READING_TERMS[element]
        measure = Measure("", scale_measure(kind).factor ** power)
        return _Term(written, measure, coefficient / measure.factor)
    measure = value_measure(kind, element.partition("_")[0], 0.0)
    return _Term(element, measure, coefficient / measure.factor)


def _product(share: float, name: str) -> str:
    """``0.5 × quadratic``, the share above zero."""
    if share == 1:
        return name
    return say("{share} × {name}", share=f"{share:.6f}".rstrip("0").rstrip("."), name=name)
