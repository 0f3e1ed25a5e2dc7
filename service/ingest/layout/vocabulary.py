"""Words of column headings in English, German, French and Russian, and their meaning in a session."""

import re
from dataclasses import dataclass
from math import pi

from estimator.applied_vector import STANDARD_GRAVITY
from estimator.session import ACCELEROMETER, GYROSCOPE


@dataclass(frozen=True)
class UnitOfMeasure:
    """A number in this unit is number · times / over + offset in the first unit of its quantity."""

    quantity: str
    times: float = 1.0
    over: float = 1.0
    offset: float = 0.0


SPELLINGS = {
    UnitOfMeasure("voltage"): "v в volt volts вольт",
    UnitOfMeasure("voltage", over=1e3): "mv мв millivolt",
    UnitOfMeasure("voltage", over=1e6): "µv uv мкв microvolt",
    UnitOfMeasure("current"): "amp ampere ампер",
    UnitOfMeasure("current", over=1e3): "ma ма",
    UnitOfMeasure("current", over=1e6): "µa ua мка",
    UnitOfMeasure("count"): "count counts cnt lsb lsbs raw digit digits code adc отсч отсчет отсчеты код ед емр",
    UnitOfMeasure("pulse"): "pulse pulses imp impulse имп импульс импульсы",
    UnitOfMeasure("acceleration"): "m/s² m/s/s ms-2 mps2 mpss м/с² м/с/с мс-2",
    UnitOfMeasure("acceleration", over=1e3): "mm/s² mms-2 мм/с²",
    UnitOfMeasure("acceleration", STANDARD_GRAVITY): "g gn g0",
    UnitOfMeasure("acceleration", STANDARD_GRAVITY, 1e3): "mg мg",
    UnitOfMeasure("acceleration", STANDARD_GRAVITY, 1e6): "µg ug мкg",
    UnitOfMeasure("acceleration", over=1e2): "gal cm/s² см/с²",
    UnitOfMeasure("rate"): "rad/s rads-1 radps рад/с радс-1",
    UnitOfMeasure("rate", over=1e3): "mrad/s mrads-1 мрад/с",
    UnitOfMeasure("rate", pi, 180): "°/s °s-1 deg/s degs-1 degree/s degrees/s grad/s dps degps °/с град/с",
    UnitOfMeasure("rate", pi, 180e3): "mdeg/s mdegs-1 m°/s mdps мград/с",
    UnitOfMeasure("rate", pi, 180 * 3600): "°/h deg/h °/ч град/ч °/hr",
    UnitOfMeasure("angle"): "deg degree degrees ° grad град градус градусы",
    UnitOfMeasure("angle", 180, pi): "rad рад",
    UnitOfMeasure("angle", 180e-3, pi): "mrad мрад",
    UnitOfMeasure("angle", over=60): "arcmin ' ′ угл.мин мин.дуги",
    UnitOfMeasure("angle", over=3600): 'arcsec " ″ угл.с угл.сек',
    UnitOfMeasure("time"): "s с sec сек second seconds sekunden секунды",
    UnitOfMeasure("time", over=1e3): "ms мс msec millis milliseconds millisekunden",
    UnitOfMeasure("time", over=1e6): "µs us мкс usec micros microseconds",
    UnitOfMeasure("time", over=1e9): "ns нс nsec nanos nanoseconds",
    UnitOfMeasure("time", 60): "min мин minutes minuten минуты",
    UnitOfMeasure("time", 3600): "h ч hr hours std stunden час часы",
    UnitOfMeasure("temperature"): "°c c degc celsius °с degreec degreesc градc градс",
    UnitOfMeasure("temperature", offset=-273.15): "k к kelvin",
    UnitOfMeasure("temperature", 5, 9, -160 / 9): "°f f degf fahrenheit",
    UnitOfMeasure("magnetic"): "µt ut nt mt gauss mgauss мктл",
    UnitOfMeasure("pressure"): "pa hpa kpa mbar",
}
"""Every unit with its spellings in lower case; others are converted to the first of a quantity."""
PLAIN = {unit: words.split()[0] for unit, words in SPELLINGS.items()}
MICRO = str.maketrans({"μ": "µ", "º": "°", "˚": "°", "⁻": "-", "−": "-", "¹": "1", "²": "2", "_": "/"})
"""Characters that look alike, or are written in line."""
NO_PART = re.compile(r"[\s\[\]()^*·⋅.]|(?<=s)ec(?:onds?)?\b|(?<=с)ек(?:унд\w*)?\b")
"""Characters between the parts of a unit, and the end of a long second."""
SHOWN = {
    "v": "V", "mv": "mV", "µv": "µV", "amp": "A", "ma": "mA", "µa": "µA", "°c": "°C", "k": "K", "°f": "°F",
    "gal": "Gal",
}  # fmt: skip
"""Spelling of units that are not written in lower case."""
TARGETS = {
    "beta_deg": "deg", "turn_angle_deg": "deg", "tilt_se_deg": "deg", "time_s": "s", "temperature_c": "°c",
    "vibration_m_s2": "m/s²",
}  # fmt: skip
"""Columns of a session with the unit of each; rates of a table are in °/s."""


def _bare(label: str) -> str:
    """``ms-2`` for m s^-2, ``m/s2`` for m/(s^2)."""
    return NO_PART.sub("", label.casefold().translate(MICRO))


BY_SPELLING = {_bare(word): unit for unit, words in SPELLINGS.items() for word in words.split()}


def unit_of(label: str) -> UnitOfMeasure | None:
    """The unit of a label; None where it is not known. A single A is ampere."""
    if label.strip(" []().") in ("A", "А"):
        return BY_SPELLING["amp"]
    return BY_SPELLING.get(_bare(label))


def plain_label(label: str) -> str:
    """``mV`` for мВ; the label itself where the unit is not known."""
    unit = unit_of(label)
    if unit is None:
        return label.strip()
    return SHOWN.get(PLAIN[unit], PLAIN[unit])


def target_label(meaning: str) -> str:
    """Unit of a column of a session; empty where it has none."""
    return "°/s" if meaning == "turn_rate_deg_s" else plain_label(TARGETS.get(meaning, ""))


def conversion(label: str, wanted: str) -> tuple[float, float, float] | None:
    """(times, over, offset) from one unit to another; None where they measure different things."""
    if label.strip().casefold() == wanted.strip().casefold() or not label.strip():
        return 1.0, 1.0, 0.0
    source, target = unit_of(label), unit_of(wanted)
    if source is None or target is None or source.quantity != target.quantity:
        return None
    if source == target:
        return 1.0, 1.0, 0.0
    times, over = source.times * target.over, source.over * target.times
    return times, over, (source.offset - target.offset) * target.over / target.times


MEANINGS = {
    "run": "run series прогон серия ход заход mounting установка направление lauf messreihe richtung",
    "beta_deg": "beta β бета angle угол turn поворот headangle anglebeta уголβ уголбета уголповорота rotation azimuth "
    "winkel drehwinkel winkelβ",
    "time_s": "time t время elapsed timestamp секунды seconds clock datetime дата_время датавремя zeit uhrzeit",
    "temperature_c": "temperature temp temperatur температура темп tempc t°c t° термодатчик",
    "vibration_m_s2": "vibration вибрация",
    "tilt_se_deg": "tiltse",
    "turn_angle_deg": "turnangle tableangle уголстола",
    "turn_rate_deg_s": "turnrate tablerate скоростьстола rate угловаяскорость",
    "position": "position pos lage положение позиция point точка",
    "direction_x": "directionx dirx upx",
    "direction_y": "directiony diry upy",
    "direction_z": "directionz dirz upz",
}
"""Columns of a session and their headings, in lower case without spaces and punctuation."""
BY_WORD = {word: meaning for meaning, words in MEANINGS.items() for word in words.split()}
ASIDE = (
    "№", "n", "no", "num", "number", "nr", "row", "строка", "номер", "п/п", "nпп", "№пп", "нпп", "comment", "comments",
    "note", "notes", "bemerkung", "примечание",
)  # fmt: skip
"""Columns unrelated to the sensors."""
SENSOR_WORDS = {
    "beschleunigungsmesser": "A", "kanal": "", "channel": "", "ch": "", "канал": "", "кан": "", "к": "", "датчик": "",
    "sensor": "", "s": "", "u": "",
}  # fmt: skip
"""Words before the number of a sensor of any kind, and the letter that its name begins with here."""
LETTERS = {ACCELEROMETER: "A", GYROSCOPE: "G"}
"""Letter that the names of new sensors begin with."""
SHORT = {
    ACCELEROMETER: "a acc acl accl accel xl gf f alpha ак акс aк",
    GYROSCOPE: "g w gyr gyro omega ω rot rate дус",
}  # fmt: skip
"""Whole words of a heading that say the kind of a sensor next to its axis or number."""
BEGINNINGS = {
    GYROSCOPE: "gyr kreisel drehrate drehgeschw winkelgeschw гиро дус angularvel angularrate angvel rotationrate "
    "rotrate turnrate rateofturn vitesseangul vitessederot vitesserot угловаяскор скоростьвращ omega",
    ACCELEROMETER: "accel akzel beschl gforce specificforce уск аксел",
}
"""Beginnings of words, or of words written as one, that do so."""
OTHER_THINGS = (
    "mag", "compass", "euler", "quat", "roll", "pitch", "yaw", "heading", "gravity", "schwere", "free", "inc", "delta",
    "cov", "var", "bias", "offset", "total", "absolut", "norm", "betrag", "baro", "press", "gps", "lat", "lon", "angle",
    "угол", "магн", "ориент", "orient", "angacc", "angularacc", "jerk", "status", "temp",
)  # fmt: skip
"""Beginnings of words about something else than a reading of a sensor."""
TIME_WORDS = (
    "time", "timestamp", "timestamps", "stamp", "elapsed", "clock", "zeit", "zeitstempel", "uhrzeit", "время", "temps",
    "horodatage", "heure", "t", "datetime", "millis", "micros", "nanos", "ms", "us", "µs", "ns", "мс", "мкс", "нс",
    "sec", "seconds", "sekunden", "секунды", "secondes",
)  # fmt: skip
ERROR_WORDS = ("se", "std", "sigma", "σ", "ско", "err", "error", "stderr", "погрешность", "sd", "uncertainty", "stdabw")
"""Next to a sensor's name: the standard error of its reading."""
DIRECT = ("direct", "forward", "прямой", "прямая", "прямо", "прям", "пр", "normal", "direkt", "vorwärts", "d")
FLIPPED = (
    "flipped", "reverse", "reversed", "inverted", "backward", "обратный", "обратная", "обратно", "обр",
    "перевернутый", "перевернутая", "umgekehrt", "gedreht", "rückwärts", "f", "r",
)  # fmt: skip
"""Words for the two runs."""
LOOK_ALIKE = str.maketrans("АВСЕНКМОРТХавсеорхуё", "ABCEHKMOPTXaвсеорхуе")
"""Cyrillic capitals that a sensor's name may be typed with."""
