"""What the book adds to docs/: the project's root documents, and reference pages made from the model descriptions and
from the programs' help, so that they cannot drift from them."""

import html
import pathlib
import re
import subprocess
import xml.etree.ElementTree as ElementTree

from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Documents of the root, under the names that they have in the book.
ROOT_PAGES = {
    "README.md": "OVERVIEW.md",
    "ARCHITECTURE.md": "ARCHITECTURE.md",
    "CHANGELOG.md": "CHANGELOG.md",
}
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s#]*)(#[^)\s]*)?\)")


def on_config(config):
    """Puts each page that no chapter names behind those of its folder's chapter, so that a new page is never lost."""
    listed = set(re.findall(r"[\w./-]+\.md", str(config.nav)))
    chapters = {"effects": chapter(chapter(config.nav, "Reference"), "Effects"), ".": chapter(config.nav, "Explanation")}
    for folder, pages in chapters.items():
        for path in sorted((ROOT / "docs" / folder).glob("*.md")):
            name = path.relative_to(ROOT / "docs").as_posix()
            if name not in listed:
                pages.append(name)
    return config


def chapter(nav, title):
    return next(entry[title] for entry in nav if isinstance(entry, dict) and title in entry)


def on_files(files, config):
    for source, name in ROOT_PAGES.items():
        text = links((ROOT / source).read_text(), ROOT)
        files.append(File.generated(config, name, content=text))
    files.append(File.generated(config, "css/book.css", content=(ROOT / "tools/book/book.css").read_text()))
    files.append(File.generated(config, "reference/variables.md", content=variables()))
    files.append(File.generated(config, "reference/commands.md", content=commands()))
    return files


def on_page_markdown(markdown, page, config, files):
    if page.file.generated_by:
        return markdown
    return links(markdown, (ROOT / "docs" / page.file.src_uri).parent)


def on_page_content(content, page, config, files):
    """Paths and names in tables may break behind a slash, two colons or an underscore, or they would widen the page."""

    def breakable(code):
        return re.sub(r"(/|::|_)", r"\1<wbr>", code[0].removesuffix("</code>")) + "</code>"

    return re.sub(r"(?s)<td.*?</td>", lambda cell: re.sub(r"<code>[^<]*</code>", breakable, cell[0]), content)


def links(text, folder):
    """Links between documents of the repository as links between pages; those to other files as their names alone."""

    def replaced(match):
        image, label, target, anchor = match.groups()
        if not target or "://" in target or target.startswith("mailto:"):
            return match[0]
        path = (folder / target).resolve()
        if path.is_dir():
            return label
        if path.is_relative_to(ROOT / "docs"):
            inside = path.relative_to(ROOT / "docs")
        elif str(path.relative_to(ROOT)) in ROOT_PAGES:
            inside = pathlib.Path(ROOT_PAGES[str(path.relative_to(ROOT))])
        elif path.exists():
            return label
        else:
            return match[0]
        here = folder.relative_to(ROOT / "docs") if folder.is_relative_to(ROOT / "docs") else pathlib.Path()
        up = "../" * len(here.parts)
        return f"{image}[{label}]({up}{inside.as_posix()}{anchor or ''})"

    return LINK.sub(replaced, text)


def cell(text):
    return html.escape(text or "", quote=False).replace("|", "\\|")


def table(heads, rows):
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return "\n".join(lines + ["| " + " | ".join(cell(word) for word in row) + " |" for row in rows]) + "\n"


def variables():
    """Variables and parameters of all shipped models, from the kept copies of the FMI 3 descriptions."""
    text = "# Variables and parameters\n\nMade from the model descriptions in `modelDescription/`, which the tests compare with the FMUs.\n"
    for path in sorted((ROOT / "modelDescription").glob("*.fmi3.xml")):
        root = ElementTree.parse(path).getroot()
        text += f"\n## {root.get('modelName')}\n\n{cell(root.get('description'))}\n"
        every = list(root.find("ModelVariables"))
        for title, causalities in [("Variables", ("input", "output", "local")), ("Parameters", ("parameter",))]:
            chosen = [variable for variable in every if variable.get("causality") in causalities]
            rows = [
                [
                    ", also ".join([variable.get("name"), *(alias.get("name") for alias in variable.findall("Alias"))]),
                    variable.get("causality") if title == "Variables" else variable.get("variability"),
                    variable.get("unit") or ("Boolean" if variable.tag == "Boolean" else "1"),
                    variable.get("start"),
                    variable.get("min"),
                    variable.get("max"),
                    variable.get("description"),
                ]
                for variable in chosen
            ]
            kind = "causality" if title == "Variables" else "variability"
            text += f"\n### {title} of {root.get('modelName')}\n\n"
            text += table(["name", kind, "unit", "start", "min", "max", "is"], rows)
    return text


def commands():
    """Help of both programs and all their commands."""
    text = "# Commands\n\nWhat `--help` prints.\n"
    for program in ("stickslip", "build-fmu"):
        path = ROOT / "target/release" / program
        if not path.exists():
            raise PluginError(f"{path} is missing: cargo build --release --package {program.replace('stickslip', 'workbench')}")
        text += help_pages(path, program)
    return text


def help_pages(path, program, *command):
    """Help of a program or one of its commands, then that of the commands below it."""
    shown = help_of(path, *command)
    text = f"\n##{'#' * len(command)} {' '.join([program, *command])}\n\n```text\n{shown}```\n"
    listed = re.search(r"Commands:\n((?:  .*\n)+)", shown)
    for name in re.findall(r"^  (\S+)", listed[1] if listed else "", re.MULTILINE):
        if name != "help":
            text += help_pages(path, program, *command, name)
    return text


def help_of(program, *command):
    return subprocess.run([program, *command, "--help"], check=True, capture_output=True, text=True).stdout
