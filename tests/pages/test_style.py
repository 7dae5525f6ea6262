# SPDX-License-Identifier: Apache-2.0
"""The colours of the pages: what is read stands out from what is behind it (WCAG 2, 1.4.3)."""

import itertools
import re
from pathlib import Path

import pytest

PAGES = Path(__file__).parents[2] / "gateway/fronts/pages"
STYLE = (PAGES / "style.css").read_text()
LEAST = 4.5
READ = ("text", "quiet", "accent", "warning", "series-4")
DRAWN = ("series-1", "series-2", "series-3", "series-4")
LEAST_DRAWN = 3  # of lines and shapes (WCAG 2, 1.4.11)
BEHIND = ("ground", "surface", "raised")
TOKENS = r":root(?:\[data-theme=\"light\"\])? \{(.*?)\}"
# parts of a distance, a size of type or a radius, in addition to tokens
PLAIN = {"!important", "0", "auto", "inherit", "calc", "max", "min", "1px", "2", "-", "*", "+"}


def colours(scheme: str) -> dict[str, str]:
    """Return the tokens of a scheme. Light says only what is different from dark."""
    dark, light = (
        dict(re.findall(r"--([a-z0-9-]+): (#[0-9a-f]{6});", block))
        for block in re.findall(TOKENS, STYLE, re.DOTALL)
    )
    return dark if scheme == "dark" else dark | light


def luminance(colour: str) -> float:
    parts = [int(colour[at : at + 2], 16) / 255 for at in (1, 3, 5)]
    linear = [
        each / 12.92 if each <= 0.03928 else ((each + 0.055) / 1.055) ** 2.4 for each in parts
    ]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    lighter, darker = sorted((luminance(one), luminance(other)), reverse=True)
    return (lighter + 0.05) / (darker + 0.05)


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_text_stands_out(scheme):
    tokens = colours(scheme)
    pairs = [*itertools.product(READ, BEHIND), ("on-danger", "danger"), ("on-accent", "accent")]
    found = {pair: round(contrast(*(tokens[name] for name in pair)), 2) for pair in pairs}
    assert {pair: ratio for pair, ratio in found.items() if ratio < LEAST} == {}


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_curves_of_a_plot_stand_out_from_their_card(scheme):
    tokens = colours(scheme)
    found = {name: contrast(tokens[name], tokens["surface"]) for name in DRAWN}
    assert {name: ratio for name, ratio in found.items() if ratio < LEAST_DRAWN} == {}


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_walls_of_a_map_stand_out_from_its_floor(scheme):
    tokens = colours(scheme)
    assert contrast(tokens["map-occupied"], tokens["map-free"]) >= LEAST


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_a_scan_stands_out_from_all_that_a_map_shows(scheme):
    tokens = colours(scheme)
    behind = ("map-free", "map-occupied", "map-unknown", "surface")
    found = {name: contrast(tokens["scan"], tokens[name]) for name in behind}
    assert {name: ratio for name, ratio in found.items() if ratio < LEAST_DRAWN} == {}


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_text_fields_have_a_visible_edge(scheme):
    tokens = colours(scheme)
    found = {name: contrast(tokens["edge"], tokens[name]) for name in BEHIND}
    assert {name: ratio for name, ratio in found.items() if ratio < LEAST_DRAWN} == {}
    assert "input, select, textarea { border-color: var(--edge); }" in STYLE
    assert "::placeholder { color: var(--quiet); opacity: 1; }" in STYLE  # as a browser would not


SHEETS = [each for each in PAGES.rglob("*.css") if each.parent.name != "vendor"]


def rules(sheet: Path) -> str:
    return re.sub(TOKENS, "", sheet.read_text(), flags=re.DOTALL)


@pytest.mark.parametrize("sheet", SHEETS, ids=lambda each: each.name)
def test_rules_use_the_names_of_colours_alone(sheet):
    assert re.findall(r"#[0-9a-fA-F]{3,8}\b(?=[;\s])|\b(?:rgba?|hsla?)\(", rules(sheet)) == []


@pytest.mark.parametrize("sheet", SHEETS, ids=lambda each: each.name)
def test_rules_use_the_names_of_distances_sizes_of_type_and_radii_alone(sheet):
    kinds = r"font-size|border-radius|(?:row-|column-)?gap|padding(?:-[a-z-]+)?"
    found = re.findall(rf"(?<![\w-])((?:{kinds}): [^;}}]+)", rules(sheet))
    assert found
    named = re.compile(r"var\(--[a-z0-9-]+\)")
    parts = {
        each: set(re.split(r"[\s()]+", named.sub("", each.partition(": ")[2]))) for each in found
    }
    assert {each: left - PLAIN - {""} for each, left in parts.items() if left - PLAIN - {""}} == {}
