"""Text is readable in light and in dark: WCAG 2.1 AA, contrast at least 4.5 to 1."""

import re

import pytest

from service.web.assets import STATIC

TONES = (
    "ink",
    "muted",
    "accent",
    "pass",
    "conditional-pass",
    "conditional-fail",
    "fail",
    "undecidable",
    "reference",
    "reserved",
)


def palettes() -> dict[str, dict[str, str]]:
    style = (STATIC / "style.css").read_text()
    light, dark = re.findall(r":root \{(.*?)\}", style, re.DOTALL)[:2]
    return {name: dict(re.findall(r"--([\w-]+): (#\w{6});", text)) for name, text in (("light", light), ("dark", dark))}


def luminance(colour: str) -> float:
    """Relative luminance of sRGB, WCAG 2.1."""
    parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    bright, dim = sorted((luminance(one), luminance(other)), reverse=True)
    return (bright + 0.05) / (dim + 0.05)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("tone", TONES)
def test_text_stands_out_from_card_and_paper(scheme: str, tone: str) -> None:
    palette = palettes()[scheme]
    assert min(contrast(palette[tone], palette[ground]) for ground in ("card", "paper")) >= 4.5


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_buttons_are_readable(scheme: str) -> None:
    palette = palettes()[scheme]
    assert contrast(palette["accent"], palette["accent-ink"]) >= 4.5
