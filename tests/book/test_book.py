"""The book builds without a warning, its pages hold what they promise, and tutorial and CONTRIBUTING.md can be typed."""

import html.parser
import json
import pathlib
import re
import subprocess
import sys
import tomllib
import zipfile

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
BOOK = ROOT / "target" / "book"


class Page(html.parser.HTMLParser):
    """Text, headings and table rows of a page."""

    def __init__(self, path):
        super().__init__()
        self.words, self.heads, self.rows, self.inside = [], [], 0, []
        self.feed(path.read_text())

    def handle_starttag(self, tag, attributes):
        self.inside.append(tag)
        self.rows += tag == "tr"

    def handle_data(self, data):
        self.words.append(data)
        if self.inside and self.inside[-1] in ("h1", "h2", "h3"):
            self.heads.append(data.strip())

    @property
    def text(self):
        return "".join(self.words)


@pytest.fixture(scope="session")
def book():
    """Builds the book; a broken link, a page that is in no chapter or the like is an error."""
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--clean", "--config-file", ROOT / "tools/book/mkdocs.yml"]
    result = subprocess.run(command, capture_output=True, text=True)
    assert result.returncode == 0, result.stdout + result.stderr
    return BOOK


def test_every_page_is_in_the_book(book):
    for source in DOCS.rglob("*.md"):
        page = book / source.relative_to(DOCS).with_suffix(".html")
        if source.name == "README.md":
            page = page.with_name("index.html")
        assert page.exists(), page
        title = re.search(r"(?m)^# (.+)$", source.read_text())
        assert title, f"{source} has no title"


def test_tables_are_tables(book):
    """A table that Markdown does not take for one leaves its bars in the text."""
    for page in book.rglob("*.html"):
        text = re.sub(r"(?s)<(pre|code)[^>]*>.*?</\1>", "", page.read_text())
        assert "|---" not in text, page


def test_the_reference_has_every_variable_and_command(book):
    variables = Page(book / "reference/variables.html").text
    for path in (ROOT / "modelDescription").glob("*.fmi3.xml"):
        for name in re.findall(r'<(?:Float64|Boolean) name="([^"]+)"', path.read_text()):
            assert name in variables, (path.name, name)
    commands = Page(book / "reference/commands.html")
    for name in ("stickslip simulate", "stickslip diagnose", "stickslip completions", "build-fmu check", "build-fmu ssp"):
        assert name in commands.heads, name
    assert commands.text.count("Usage:") > 15


def test_every_verdict_is_explained():
    verdicts = json.loads((DOCS / "finding.schema.json").read_text())["properties"]["verdict"]["enum"]
    page = (DOCS / "reference/verdicts.md").read_text()
    for verdict in verdicts:
        assert f"| `{verdict}` |" in page, verdict


def rows(path):
    """Cells of the table rows of a page."""
    lines = [line for line in path.read_text().splitlines() if line.startswith("| ")]
    return [[part.strip() for part in line.strip("| ").split(" | ")] for line in lines]


def test_importers_are_pinned_and_their_tests_are_there():
    _, *importers = rows(DOCS / "importers.md")
    assert len(importers) >= 9
    for name, version, pinned, _, _, _, test in importers:
        pin = ROOT / pinned.strip("`")
        assert pin.exists(), pin
        if version != "–":
            package = re.split(r"[ ,]", name)[0]
            if pin.suffix == ".lock":
                packages = tomllib.loads(pin.read_text())["package"]
                assert any(one["name"] == package and one["version"] == version for one in packages), name
            else:
                wanted = {"ecos": "ecospy", "libcosim": "libcosimpy", "fmucontainer": "fmu_manipulation_toolbox"}
                assert f"{wanted.get(package, package)}=={version}" in pin.read_text().splitlines(), name
        file, _, function = test.strip("`").partition("::")
        text = (ROOT / file).read_text()
        assert not function or re.search(rf"(def|fn) {function}\b", text), test


def test_the_files_of_an_fmu_are_those_of_the_table(tmp_path):
    release = ROOT / "target/release"
    library = ["--library", release / "libstickslip.so"]  # this machine's alone, whatever else was built
    command = [release / "build-fmu", ROOT / "modelDescription/reduced-rig.toml", *library, "--out", tmp_path]
    subprocess.run(command, check=True, capture_output=True)
    table = (DOCS / "reference/files.md").read_text().partition("## In an FMU")[2]
    lines = [[part.strip(" `") for part in line.strip("| ").split(" | ")] for line in table.splitlines() if line[:2] == "| "]
    for column, version in enumerate(["fmi2", "fmi3"]):
        listed = {}
        for line in lines[1:]:
            sizes = line[2].split(", ")
            if line[column] != "–":
                listed[line[column]] = int(sizes[min(column, len(sizes) - 1)].replace(",", ""))
        with zipfile.ZipFile(tmp_path / f"ReducedRig.{version}.fmu") as archive:
            packed = {entry.filename: entry.file_size for entry in archive.infolist()}
        assert listed.keys() == packed.keys()
        for name, size in packed.items():
            assert listed[name] == pytest.approx(size, rel=0.05), name


def shell_blocks(page):
    return re.findall(r"(?ms)^```sh\n(.*?)^```", page.read_text())


def type_blocks(page, out):
    """Runs all `sh` blocks of a page in their order, in one shell; `out` is the folder that they fill."""
    script = f"set -euo pipefail\nrm -rf {out}\n" + "".join(shell_blocks(page))
    result = subprocess.run(["bash", "-c", script], cwd=ROOT, capture_output=True, text=True, timeout=600)
    assert result.returncode == 0, result.stdout + result.stderr
    return result


def test_the_tutorial_can_be_typed():
    """The verdict is the promised one."""
    result = type_blocks(DOCS / "tutorial.md", "out/tutorial")
    assert result.stdout.count("nothing found") == 4
    finding = json.loads((ROOT / "out/tutorial/diagnosis/finding.json").read_text())
    assert finding["verdict"] == "named"
    assert [effect["name"] for effect in finding["effects"]] == ["unbalance"]
    for name in ("believed/result.png", "corrected/result.csv", "diagnosis/report.html"):
        assert (ROOT / "out/tutorial" / name).exists(), name


def test_the_record_and_the_effect_of_contributing_can_be_typed():
    """The record tells enough for the page's own effect to be named, alone and with its number."""
    result = type_blocks(DOCS / "CONTRIBUTING.md", "out/contributing")
    assert "disagree most over the disc angle" in result.stdout
    assert "cannot be told from each other" not in result.stdout + result.stderr
    finding = json.loads((ROOT / "out/contributing/finding/finding.json").read_text())
    assert finding["verdict"] == "named"
    assert [effect["name"] for effect in finding["effects"]] == ["worn_bearing"]
    assert finding["effects"][0]["parameters"]["torque"]["value"] == pytest.approx(0.05, rel=0.02)


def test_contributing_names_files_that_are_there():
    """All that the lists of files name, but what an example adds."""
    added = {"src/friction/coulomb_viscous.rs"}
    named = set(re.findall(r"`((?:src|crates|tools|docs|build-fmu|tests)/[\w/.-]+)`", (DOCS / "CONTRIBUTING.md").read_text()))
    assert len(named) > 25
    for path in named - added:
        assert (ROOT / path.replace("chapterN", "chapter4")).exists(), path


def test_what_was_not_run_says_so():
    for page in ("modelica.md", "simulink.md"):
        assert "**Not run here.**" in (DOCS / page).read_text()
