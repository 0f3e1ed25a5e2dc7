"""The words of a session's workbook in Russian: sheets, keys, headings and choices, one for each English word.

A workbook is written and read with the same words, so a Russian one that is filled in and returned is the session that
an English one would be.
"""

from collections.abc import Iterable
from typing import TypeVar

Value = TypeVar("Value")

SHEETS = {"session": "сеанс", "readings": "показания", "example": "пример"}
STEPS = {
    "format": "формат", "unit": "прибор", "unit_type": "тип прибора", "block": "блок", "programme": "программа",
    "started_at": "начало", "operator": "оператор", "notes": "примечания", "stage": "этап",
    "powered_on_at": "включение", "time_since_power_on_s": "время от включения, с",
    "origin": "происхождение", "site": "место", "stand": "стенд", "mounting": "установка", "sensors": "датчики",
    "count_time_s": "время счёта, с",
    "counter": "счётчик", "sample_rate_hz": "частота отсчётов, Гц", "direction_sigma_deg": "сигма направлений, °",
    "screening": "отклонённые проверки",
    "latitude_deg": "широта, °", "height_m": "высота, м", "gravity_m_s2": "ускорение силы тяжести, м/с²",
    "id": "номер", "alpha_deg": "угол наклона α, °", "chi_deg": "угол наклона χ, °",
    "sigma_arcsec": "сигма, угловые секунды", "sigma_count_time_s": "сигма времени счёта, с", "theta_x": "θx",
    "theta_y": "θy", "alpha": "α", "beta": "β", "latitude": "широта", "meridian": "меридиан", "wobble": "биение",
    "name": "название", "kind": "вид", "nominal_axis": "номинальная ось", "nominal_scale": "номинальный масштаб",
    "nominal_offset": "номинальный ноль", "reading_unit": "единица показаний",
    "bias_repeatability_m_s2": "повторяемость нуля, м/с²", "bias_repeatability_rad_s": "повторяемость нуля, рад/с",
    "position_m": "положение датчика, м",
}  # fmt: skip
"""Parts of a key: ``stand.alpha_deg`` is ``стенд.угол наклона α, °``."""
COLUMNS = {
    "run": "прогон", "beta_deg": "β, °", "time_s": "время, с", "temperature_c": "температура, °C",
    "vibration_m_s2": "вибрация, м/с²", "tilt_se_deg": "СКО наклона, °",
    "turn_angle_deg": "угол стола, °", "turn_rate_deg_s": "скорость стола, °/с",
    "position": "положение", "direction_x": "направление x", "direction_y": "направление y",
    "direction_z": "направление z",
}  # fmt: skip
VALUES = {
    "accelerometer": "акселерометр", "gyroscope": "гироскоп", "two-axis-stand": "двухосный стенд",
    "arbitrary-orientations": "произвольные положения", "rotation-alignment": "выставка на поворотном столе",
    "rate-table": "стол угловых скоростей", "in-service": "в эксплуатации",
    "thermal": "температурная калибровка", "as-found": "до работ",
    "as-left": "после работ", "free-running": "непрерывный", "reset": "со сбросом", "direct": "прямая",
    "flipped": "обратная", "measured": "измерение", "simulated": "имитация",
}  # fmt: skip
CHOSEN = ("block", "kind", "programme", "stage", "origin", "counter", "run")
"""Keys and columns whose values are words of a list."""
ERROR, ERROR_IN_RUSSIAN = "_se", ", СКО"
"""Suffix of a sensor's name: the column of its standard errors."""
IN_ENGLISH = {text: word for words in (SHEETS, COLUMNS, VALUES) for word, text in words.items()}
STEPS_IN_ENGLISH = {text: word for word, text in STEPS.items()}


def key_in_russian(key: str) -> str:
    """``sensors[1].kind`` as ``датчики[1].вид``."""
    return _by_step(key, STEPS)


def key_in_english(key: str) -> str:
    """The English key of a Russian one; any other key unchanged."""
    return _by_step(key, STEPS_IN_ENGLISH)


def _by_step(key: str, words: dict[str, str]) -> str:
    steps = (step.partition("[") for step in key.split("."))
    return ".".join(f"{words.get(name.strip(), name)}{bracket}{number}" for name, bracket, number in steps)


def heading_in_russian(name: str, sensors: Iterable[str]) -> str:
    """Heading of a column; sensors keep their names."""
    base = name.removesuffix(ERROR)
    if base != name and base in sensors:
        return base + ERROR_IN_RUSSIAN
    return COLUMNS.get(name, name)


def heading_in_english(text: str) -> str:
    """The column under a Russian heading; any other heading unchanged."""
    heading = text.strip()
    if heading.endswith(ERROR_IN_RUSSIAN):
        return heading.removesuffix(ERROR_IN_RUSSIAN) + ERROR
    return IN_ENGLISH.get(heading, text)


def value_in_russian(name: str, value: Value) -> Value | str:
    """The Russian word of a choice."""
    return VALUES.get(value, value) if name in CHOSEN and isinstance(value, str) else value


def value_in_english(name: str, value: Value) -> Value | str:
    """The choice under a Russian word."""
    return IN_ENGLISH.get(value.strip(), value) if name in CHOSEN and isinstance(value, str) else value
