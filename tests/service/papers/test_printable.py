"""Every character that documents claim to print is really printed."""

import json
import re
import unicodedata
from pathlib import Path

import typst

from service.kit.printable import RANGES, is_printable, printable
from service.papers.typeset import PALETTE
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.papers.documents import text_of

SOURCE = b"""#set text(font: ("Libertinus Serif", "DejaVu Sans Mono"))
#for c in json(bytes(sys.inputs.data)) [#box(c) ]"""
STYLE = Path(__file__).parents[3] / "service" / "web" / "static" / "style.css"


def test_the_fonts_hold_every_character_that_is_printed_as_itself() -> None:
    claimed = [chr(code) for low, high in RANGES for code in range(low, high + 1) if is_printable(chr(code))]
    shown = [c for c in claimed if unicodedata.category(c)[0] not in "ZM"]
    assert len(shown) > 2000
    pdf = typst.compile(SOURCE, sys_inputs={"data": json.dumps(shown)}, ignore_system_fonts=True)
    assert isinstance(pdf, bytes)
    assert text_of(pdf).count("\x00") == 0


def test_what_is_not_seen_is_shown_as_its_code_point() -> None:
    assert printable("a\u202eb\x00c\ud7ffd") == "a‹U+202E›b‹U+0000›c‹U+D7FF›d"


def test_the_signs_of_measurement_are_printed() -> None:
    text = "±40\u202fµg, −1.5\u00a0°/h, χ² = 10¹², 20″, (rad/s)⁻¹, β ≤ 3σ, Ω ×"
    assert printable(text) == text


def test_paper_has_the_light_colours_of_the_pages() -> None:
    light = STYLE.read_text("utf-8").partition("@media")[0]
    colours = dict(re.findall(r"--([\w-]+): (#\w+);", light))
    assert {name: colours[name] for name in PALETTE} == PALETTE
