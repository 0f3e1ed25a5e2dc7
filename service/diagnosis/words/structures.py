"""Structure that no known cause explains, in words: what it is said to be, where it lives, and what to do."""

from collections.abc import Sequence

from estimator.diagnosis.results import Course, Structure
from estimator.message import changed, joined, say, uncapitalised

UNEXPLAINED = "Something is there that no known cause explains"
COMMON = "Something common to all sensors, of the stand or fixture, that no known cause explains"
MIXED_UP = "The record cannot be right"
SIZE = "size"
"""The component of a course that no turn of the applied vector makes."""
COMPONENTS = {
    "β": "the angle β of the head were off",
    "α": "the angle α of the stand were off",
    SIZE: "gravity or the rate were larger",
    "β of the gyros": "the angle β were off, for the gyros alone",
    "α of the gyros": "the angle α were off, for the gyros alone",
}
"""What each component of a course looks like."""
IN_COMMON = "the applied vector, common to all sensors: "
"""How the place of a pattern begins that all sensors share: what is said of it says that already."""
LOOK_AT_SENSOR = (
    "Do not force a name on it: look where it lives, repeat the session, and compare with another unit or stand."
)
LOOK_AT_STAND = (
    "All sensors show the same, so it is none of theirs. Look at the stand, the fixture and the reference: play, "
    "levelling, clamping, what the angles are read from. Then measure another unit there: it would show the same."
)
LOOK_AT_RECORD = "Compare the file with what was done: columns, runs, angles and signs. Correct it and upload it again."


def headline_of(structures: Sequence[Structure]) -> str:
    """What is there, in a few words: of the record first, because nothing else holds where that is wrong."""
    first = leading(structures)
    return MIXED_UP if first.of_record else UNEXPLAINED if first.sensors else COMMON


def what_to_do_about(structures: Sequence[Structure]) -> str:
    """What a technician does next."""
    first = leading(structures)
    return LOOK_AT_RECORD if first.of_record else LOOK_AT_SENSOR if first.sensors else LOOK_AT_STAND


def leading(structures: Sequence[Structure]) -> Structure:
    """The one that is told first."""
    return next((s for s in structures if s.of_record), structures[0])


def told(structures: Sequence[Structure]) -> str:
    """What is there, in whom and where, in one line."""
    first = leading(structures)
    who = say(" in {sensors}", sensors=joined(", ", first.sensors)) if first.sensors and not first.of_record else ""
    return say("{structures}{who}: {first}.", structures=headline_of(structures), who=who, first=where_of(first))


def summed_up(structures: Sequence[Structure]) -> str:
    """That something is there, and in which sensors."""
    if leading(structures).of_record:
        return told(structures)
    sensors = sorted({sensor for structure in structures for sensor in structure.sensors})
    beside = (
        say(
            " Beside it: {unexplained} in {sensors}.",
            unexplained=uncapitalised(UNEXPLAINED),
            sensors=joined(", ", sensors),
        )
        if sensors
        else ""
    )
    if any(not structure.sensors for structure in structures):
        return say("{common}.{beside}", common=COMMON, beside=beside)
    return say("{unexplained} in {sensors}.", unexplained=UNEXPLAINED, sensors=joined(", ", sensors))


def who_of(structure: Structure) -> str:
    """``A1, A2``, or all."""
    return joined(", ", structure.sensors) or "all sensors together"


def where_of(structure: Structure) -> str:
    """Where it lives; of a course what it does to the applied vector."""
    if structure.course is not None:
        return say("the applied vector {course}", course=course_in_words(structure.course))
    return changed(structure.where, lambda text: text.removeprefix(IN_COMMON))


def component_in_words(component: str) -> str:
    """``as if the angle β of the head were off``; of another version's component its name."""
    return say("as if {components}", components=COMPONENTS[component]) if component in COMPONENTS else component


def course_in_words(course: Course) -> str:
    """``runs off in α along β, each run for itself``."""
    if not course.components:
        return course.order
    what = joined(" and ", course.components)
    if course.order.startswith("no order"):
        return say("is off in {what}, anew at every row", what=what)
    return say("is off in {what}, smoothly along {order}", what=what, order=course.order)
