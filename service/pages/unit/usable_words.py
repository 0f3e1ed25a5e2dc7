"""Why a unit may be used, or may not and what to do about it."""

from datetime import datetime

from estimator.message import capitalised, say
from service.flags.records import Flag
from service.kit.measures import day_of
from service.sessions.doubt import Reservation

YES = "Fit by its session of {day}, and not due before {due}."
NO_SESSION = "No session is stored: calibrate the unit."
BY_REFERENCE = "Its reference was measured on {day}, nothing speaks against it, and it is not due before {due}."
UNPROVEN = (
    "No session was held against the reference of {day} yet: whether the unit keeps its values shows with the next one."
)
TOO_COARSE = (
    "Its reference of {day} leaves {what} uncertain by more than the tolerance, or does not show it: measure more "
    "positions."
)
NOTHING_JUDGED = "None of its sessions counts as a calibration: calibrate the unit."
SINCE_SERVICE = "Nothing was measured since the service of {day}: calibrate the unit, which sets its new reference."
NOT_FIT = "Not fit by its session of {day}: {reason}"
UNDECIDED = "Not decided by its session of {day}: {reason}"
OVERDUE = "Its calibration was due on {due}: calibrate it. {reason}"
NO_DUE = "It is not known when its calibration is due: calibrate it."
FUTURE = "Its session is dated {day}, which is still to come: put the date right."
FLAGGED = "Flag {id} is open: {summary}"
CLOSE = "Within tolerance, but by less than the uncertainty of the measurement: {reason}"
WAITS = "The session of {day} waits for an engineer and does not count yet: accept it, correct it or withdraw it."
DATES_PENDING = "Its dates are being worked out with its latest records: ask again in some seconds."
NOT_DIAGNOSED = "The session of {day} is not diagnosed yet: ask again in a minute."


def flagged(flag: Flag) -> str:
    """An open flag."""
    return say(FLAGGED, id=flag.id, summary=flag.summary)


def reserved(one: Reservation) -> str:
    """What a verdict is said with, as a sentence of its own."""
    return say("{problem}: {advice}.", problem=capitalised(one.text), advice=one.advice)


def on(sentence: str, at: datetime, **more: str) -> str:
    """The sentence with its day."""
    return say(sentence, day=day_of(at), **more)
