"""Permitted use of a unit, its reasons and the action to take, in words."""

from datetime import datetime

from estimator.message import capitalised, say
from service.judging.records import OpenFlag, Usable
from service.kit.measures import day_of
from service.sessions.doubt import Reservation

YES = "{word} by its session of {day}, and not due before {due}."
BY_REFERENCE = "Its reference was measured on {day}, there is no objection, and it is not due before {due}."
UNPROVEN = (
    "No session has been compared with the reference of {day} yet: the next one shows whether the unit is stable."
)
TOO_COARSE = (
    "In its reference of {day} these are more uncertain than the tolerance, or not observed: {what}. Measure more "
    "positions."
)
RETIRED = "It is retired since {day}."
NOTHING_JUDGED = "None of its sessions counts as a calibration: calibrate the unit."
SINCE_SERVICE = "Nothing was measured since the service of {day}: calibrate the unit, which sets its new reference."
OVERDUE = "Its calibration was due on {due}: calibrate it. {reason}"
NO_DUE = "It is not known when its calibration is due: calibrate it."
FUTURE = "Its session is dated {day}, in the future: correct the date."
FLAGGED = "Flag {id} is still open: {summary}"
CLOSE = "Within tolerance, but by less than the uncertainty of the measurement: {reason}"
WAITS = "The session of {day} waits for an engineer and does not count yet: accept it, correct it or withdraw it."
DATES_PENDING = "Its dates are being computed with its latest records: ask again in a few seconds."
VERDICT_PENDING = "Its verdict is being computed with its latest records: ask again in a few seconds."
NOT_DIAGNOSED = "The session of {day} is not diagnosed yet: ask again in a minute."
EXPIRED = (
    "Traceability is interrupted: certificate {number} of stand {stand} had expired on {until}, before the session of "
    "{day}."
)

RETURN = "put it back into use first"
CALIBRATE = "calibrate it"
ADJUST = "adjust, repair or withdraw it"
REPEAT = "repeat the session"
MEASURE_AGAIN = "measure it again"
MORE_POSITIONS = "measure more positions"
DATE = "put the date of its session right"
ASK_AGAIN = "ask again in a few seconds"
ADMINISTRATOR = "tell the administrator"
ENGINEER = "accept, correct or withdraw the session that waits"
CERTIFY = "have the stand calibrated"
SETTLE = "have an engineer resolve flag {id}"


def flagged(flag: OpenFlag) -> str:
    """An open flag."""
    return say(FLAGGED, id=flag.id, summary=flag.summary)


def reserved(reservation: Reservation) -> str:
    """A verdict's reservations as one sentence."""
    return say("{problem}: {advice}.", problem=capitalised(reservation.text), advice=reservation.advice)


def on(sentence: str, at: datetime, **more: str) -> str:
    """The sentence with its day."""
    return say(sentence, day=day_of(at), **more)


def next_in_words(use: Usable) -> str:
    """The next step for the unit: ``Next calibration: 4 Nov 2027``, or the action to take first."""
    if use.due is None:
        return capitalised(use.action)
    if use.is_overdue:
        return say("Calibration overdue since {date}", date=day_of(use.due))
    return say("Next calibration: {date}", date=day_of(use.due))
