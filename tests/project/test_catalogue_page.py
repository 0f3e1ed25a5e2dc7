"""The documentation's catalogue is the one that the program knows."""

from benchmarks.catalogue import PAGE, page
from estimator.causes import CATALOGUE


def test_the_catalogue_page_is_up_to_date() -> None:
    assert PAGE.read_text(encoding="utf-8") == page(), "run `python -m benchmarks.catalogue`"


def test_every_cause_is_on_the_page() -> None:
    assert [cause.identifier for cause in CATALOGUE if f"| `{cause.identifier}` |" not in page()] == []
