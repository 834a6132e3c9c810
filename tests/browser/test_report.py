"""What an engineer does with the report: read it by day, by night, on a phone and on paper, and zoom its plots."""

import json
import os
import re

import pytest
from conftest import ROOT


def colour(page, selector, of="backgroundColor"):
    """Red, green and blue of a style, 0 … 255."""
    text = page.eval_on_selector(selector, f"node => getComputedStyle(node).{of}")
    return [float(number) for number in text[text.index("(") + 1 : -1].split(",")][:3]


def panel(page, index):
    """The index-th plot: its data, and the frame around them on the screen, which takes the pointer."""
    surface = page.locator("figure rect[fill=transparent]").nth(index)
    surface.scroll_into_view_if_needed()
    return page.locator("figure svg.data").nth(index), surface.bounding_box()


def ticks(page, index):
    """Numbers shown at the axes of the index-th plot."""
    return page.locator("figure svg.data").nth(index).evaluate(
        "data => { var group = data.previousElementSibling; var shown = [];"
        " while (group && shown.length === 0) { if (group.tagName === 'g' && group.style.display !== 'none')"
        " { shown = Array.from(group.querySelectorAll('text')).map(t => t.textContent); }"
        " group = group.previousElementSibling; } return shown; }")


def drag(page, box, begin, end, key=None):
    """Draws with the mouse from one place to another, given as shares of a frame."""
    if key:
        page.keyboard.down(key)
    page.mouse.move(box["x"] + begin[0] * box["width"], box["y"] + begin[1] * box["height"])
    page.mouse.down()
    page.mouse.move(box["x"] + end[0] * box["width"], box["y"] + end[1] * box["height"], steps=4)
    page.mouse.up()
    if key:
        page.keyboard.up(key)


def view(data):
    return [float(number) for number in data.get_attribute("viewBox").split(" ")]


def test_it_stands_alone(open_report, report):
    page = open_report()
    assert page.heard == [f"request: {report.as_uri()}"]
    assert page.title() == "unbalance: missing: unbalance"
    assert page.locator("h1").inner_text() == "Missing: unbalance"


def test_the_answer_is_on_the_first_screen(open_report, report):
    page = open_report()
    for selector in ("h1", ".answer", ".tiles"):
        box = page.locator(selector).bounding_box()
        assert box["y"] + box["height"] < 900, selector
    finding = json.loads(report.with_name("finding.json").read_text())
    closed = finding["gap"]["through_fmu"]["closed"]
    assert f"{100 * closed:.1f} %" in page.locator(".tiles").inner_text()


def test_what_decides_comes_first_and_what_shows_nothing_is_folded_away(open_report):
    page = open_report()
    first = page.locator("figure").first
    assert "over the disc's angle" in first.inner_text() and "restarted windows" in first.inner_text()
    assert first.bounding_box()["y"] < page.locator("h2").first.bounding_box()["y"]
    if os.environ.get("REPORT_PICTURE"):
        first.locator(".plot").screenshot(path=ROOT / "docs" / "pictures" / "diagnosis.png")
    folded = page.get_by_text("over the acceleration", exact=True)
    assert not folded.is_visible()
    page.locator("summary").click()
    assert folded.is_visible()
    assert "unbalance.torque" in page.locator(".answer").inner_text() and "unbal_T" not in page.content()


def test_every_section_is_there(open_report):
    headings = open_report().locator("h2").all_inner_texts()
    assert headings == [
        "Where model and records disagree",
        "The candidates",
        "Before and after on the held-out record",
        "Parameters",
        "The noise floor",
        "What it could be confused with",
        "How to use the amended FMU",
        "About the records",
        "How this was made",
    ]


def test_plots_show_what_the_issue_asks_for(open_report):
    page = open_report()
    page.locator("summary").click()
    text = " ".join(page.locator("figure").all_inner_texts())
    for label in ("over time", "over velocity", "over the phase-plane angle", "over the disc's angle", "orders", "over the normal force",
                  "restarted windows", "free run", "phase portrait", "friction torque over velocity",
                  "friction torque over the phase-plane angle", "Spectra", "gain in ln likelihood"):
        assert label in text, label


def test_a_plot_zooms_into_a_rectangle_and_back(open_report):
    page = open_report()
    data, box = panel(page, 1)
    whole, labels = view(data), ticks(page, 1)
    drag(page, box, (0.25, 0.25), (0.5, 0.75))
    zoomed = view(data)
    assert zoomed[2] == pytest.approx(0.25 * whole[2], rel=0.02)
    assert zoomed[3] == pytest.approx(0.5 * whole[3], rel=0.02)
    assert zoomed[0] == pytest.approx(whole[0] + 0.25 * whole[2], rel=0.02)
    # The axes follow: time runs from 2 to 4 s of 8 s, and the velocity over the half of its range in the middle.
    shown = [float(label.replace("−", "-")) for label in ticks(page, 1)]
    assert ticks(page, 1) != labels
    assert shown and all(1 < number < 6 for number in shown)
    # Other plots stay as they are.
    other, _ = panel(page, 0)
    assert view(other)[2] == pytest.approx(float(other.get_attribute("width")))
    data, box = panel(page, 1)
    drag(page, box, (0.5, 0.5), (0.6, 0.5), key="Shift")
    assert view(data)[0] < zoomed[0] and view(data)[2] == pytest.approx(zoomed[2])
    page.mouse.dblclick(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    assert view(data) == whole and ticks(page, 1) == labels


def test_the_wheel_zooms_about_the_pointer_with_ctrl_alone(open_report):
    page = open_report()
    data, box = panel(page, 1)
    whole = view(data)
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    page.keyboard.down("Control")
    page.mouse.wheel(0, -400)
    page.keyboard.up("Control")
    page.wait_for_function("([data, width]) => data.viewBox.baseVal.width < 0.9 * width", arg=[data.element_handle(), whole[2]])
    assert page.evaluate("window.visualViewport.scale") == 1
    page.keyboard.press("Escape")
    assert view(data) == whole


def test_a_zoom_keeps_dots_round_and_lines_thin(open_report):
    page = open_report()
    data, box = panel(page, 0)
    assert data.locator("circle").count() > 50
    drag(page, box, (0.2, 0.4), (0.9, 0.6))
    assert data.locator("circle").count() == 0
    assert data.locator("path[stroke-linecap=round]").count() > 50
    assert data.locator("path").first.evaluate("node => getComputedStyle(node).vectorEffect") == "non-scaling-stroke"


def test_dark_and_light(open_report):
    light, dark = open_report(color_scheme="light"), open_report(color_scheme="dark")
    assert min(colour(light, "body")) > 240 and max(colour(dark, "body")) < 60
    assert max(colour(light, "body", "color")) < 60 and min(colour(dark, "body", "color")) > 200
    assert dark.eval_on_selector(".plot > svg", "node => getComputedStyle(node).filter") != "none"
    assert light.eval_on_selector(".plot > svg", "node => getComputedStyle(node).filter") == "none"


def test_on_a_phone_only_wide_things_scroll(open_report):
    page = open_report(viewport={"width": 390, "height": 800})
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    size = page.locator(".plot svg").first.bounding_box()["width"]
    assert size >= 600, "labels must stay legible"


def test_on_paper(open_report):
    page = open_report(color_scheme="dark")
    page.emulate_media(media="print")
    assert min(colour(page, "body")) > 250 and max(colour(page, "body", "color")) < 10
    assert page.eval_on_selector(".plot > svg", "node => getComputedStyle(node).filter") == "none"
    assert page.eval_on_selector(".hint", "node => getComputedStyle(node).display") == "none"
    assert page.eval_on_selector("figure", "node => getComputedStyle(node).breakInside") == "avoid"
    # Nothing is wider than the paper: the printable width of A4 at 96 dpi.
    page.set_viewport_size({"width": 718, "height": 1000})
    assert page.evaluate("document.documentElement.scrollWidth") <= 718
    pdf = page.pdf(format="A4")
    assert pdf.startswith(b"%PDF")
    assert 3 <= len(re.findall(rb"/Type\s*/Page\b(?!s)", pdf)) <= 12
