"""What every certificate states of itself, and what it lacks to be one that counts."""

from service.records.paper import NOT_STATED, Customer, Laboratory

RELATES = "The results relate only to the item calibrated, as it was on the day of measurement."
WHOLE = "This certificate may be reproduced only in full, except with the written approval of the laboratory."
SAMPLING = "None: every sensor of the item was measured."
RECEIVED = "not stated (not critical to the results)"
DRAFT = "Draft, not an accredited certificate: {missing} not stated."


def lacks(laboratory: Laboratory, customer: Customer, *, dated: bool) -> tuple[str, ...]:
    """What nobody stated of all that a calibration certificate must name."""
    wanted = (
        ("name of the laboratory", laboratory.name),
        ("address of the laboratory", laboratory.address),
        ("country of the laboratory", laboratory.country),
        ("name of the customer", customer.name),
        ("address of the customer", customer.address),
        ("day of measurement", dated),
    )
    return tuple(name for name, given in wanted if not given)


def draft_in_words(missing: tuple[str, ...]) -> str:
    """That the paper is a draft, and why; empty where nothing is missing."""
    if not missing:
        return ""
    listed = missing[0] if len(missing) == 1 else f"{', '.join(missing[:-1])} and {missing[-1]}"
    return DRAFT.format(missing=listed)


def stated(text: str) -> str:
    """The text, or that there is none."""
    return text.strip() or NOT_STATED
