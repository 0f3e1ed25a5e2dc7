"""Words that people head columns with, in English and Russian, and what they mean in a session."""

MEANINGS = {
    "run": "run series прогон серия ход заход mounting установка направление",
    "beta_deg": "beta β бета angle угол turn поворот headangle anglebeta уголβ уголбета уголповорота rotation azimuth",
    "time_s": "time t время elapsed timestamp секунды seconds clock datetime дата_время датавремя",
    "temperature_c": "temperature temp температура темп tempc t°c t° термодатчик",
    "vibration_m_s2": "vibration вибрация",
    "turn_angle_deg": "turnangle tableangle уголстола",
    "turn_rate_deg_s": "turnrate tablerate скоростьстола rate угловаяскорость",
    "position": "position pos положение позиция point точка",
    "direction_x": "directionx dirx upx",
    "direction_y": "directiony diry upy",
    "direction_z": "directionz dirz upz",
}
"""Columns of a session and how they are headed, in small letters without spaces and marks."""
BY_WORD = {word: meaning for meaning, words in MEANINGS.items() for word in words.split()}
ASIDE = (
    "№", "n", "no", "num", "number", "nr", "row", "строка", "номер", "п/п", "nпп", "№пп", "нпп", "comment", "comments",
    "note", "notes", "примечание",
)  # fmt: skip
"""Columns that say nothing of the sensors."""
SENSOR_WORDS = {
    "accelerometer": "A", "acc": "A", "accel": "A", "a": "A", "акселерометр": "A", "ак": "A", "акс": "A", "aк": "A",
    "gyroscope": "G", "gyro": "G", "gyr": "G", "g": "G", "w": "G", "гироскоп": "G", "дус": "G", "гиро": "G",
    "channel": "", "ch": "", "канал": "", "кан": "", "к": "", "датчик": "", "sensor": "", "s": "", "u": "",
}  # fmt: skip
"""Words before the number or axis of a sensor, and the letter that its name begins with here."""
ERROR_WORDS = ("se", "std", "sigma", "σ", "ско", "err", "error", "stderr", "погрешность", "sd", "uncertainty")
"""Beside a sensor's name: the standard error of its reading."""
DIRECT = ("direct", "forward", "прямой", "прямая", "прямо", "прям", "пр", "normal", "d")
FLIPPED = (
    "flipped", "reverse", "reversed", "inverted", "backward", "обратный", "обратная", "обратно", "обр",
    "перевернутый", "перевернутая", "f", "r",
)  # fmt: skip
"""What the two runs are called."""
LOOK_ALIKE = str.maketrans("АВСЕНКМОРТХавсеорхуё", "ABCEHKMOPTXaвсеорхуе")
"""Cyrillic capitals that a sensor's name may be typed with."""
