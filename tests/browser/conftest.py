"""A report as `stickslip diagnose` writes it, in Debian's Chromium."""

import os
import pathlib
import subprocess

import pytest
from playwright.sync_api import sync_playwright

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "target" / "release" / "stickslip"
FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync"]


@pytest.fixture(scope="session")
def report(tmp_path_factory):
    """Path of the report on the small case."""
    out = tmp_path_factory.mktemp("report")
    case = ROOT / "crates" / "workbench" / "tests" / "data" / "unbalance"
    done = subprocess.run([PROGRAM, "diagnose", case, "--out", out], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return out / "report.html"


@pytest.fixture(scope="session")
def browser(tmp_path_factory):
    """Chromium with a profile of its own."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=os.environ["CHROMIUM"], args=FLAGS, headless=True)
        yield browser
        browser.close()


@pytest.fixture
def open_report(browser, report):
    """Opens the report under options of a browser context; what it says and asks for is on the page as `heard`."""
    contexts = []

    def open_it(**options):
        context = browser.new_context(**{"viewport": {"width": 1200, "height": 900}, **options})
        contexts.append(context)
        page = context.new_page()
        page.heard = []
        page.on("console", lambda message: page.heard.append(f"console: {message.text}"))
        page.on("pageerror", lambda error: page.heard.append(f"error: {error}"))
        page.on("request", lambda request: page.heard.append(f"request: {request.url}"))
        page.goto(report.as_uri())
        return page

    yield open_it
    for context in contexts:
        context.close()
