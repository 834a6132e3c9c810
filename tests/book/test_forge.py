"""The files for a public forge: their syntax, and that the workflow runs the parts of .ci/run. No forge is asked."""

import pathlib
import re
import subprocess
import sys

import pytest
import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
FORGE = ROOT / ".github"
WORKFLOW = FORGE / "workflows/ci.yml"
TOOLS = pathlib.Path(sys.executable).parent


def passes(tool, *arguments):
    result = subprocess.run([TOOLS / tool, *arguments], capture_output=True, text=True)
    assert result.returncode == 0, result.stdout + result.stderr


@pytest.mark.parametrize("path", sorted(FORGE.rglob("*.yml")), ids=lambda path: path.name)
def test_files_follow_their_schema(path):
    kinds = {"ci.yml": "github-workflows", "config.yml": "github-issue-config"}
    passes("check-jsonschema", "--builtin-schema", f"vendor.{kinds.get(path.name, 'github-issue-forms')}", path)


def test_the_workflow_has_no_known_weakness():
    passes("zizmor", "--offline", "--no-progress", WORKFLOW)


def test_the_workflow_runs_the_parts_of_ci():
    strategy = yaml.safe_load(WORKFLOW.read_text())["jobs"]["check"]["strategy"]
    ours = re.findall(r"(?m)^tests/run(?: [a-z-]+)?$", (ROOT / ".ci/run").read_text())
    assert strategy["matrix"]["check"] == [".ci/run static", *ours]
