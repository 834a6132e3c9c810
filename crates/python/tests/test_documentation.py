"""The documentation in the code is whole, in NumPy's form, and true to the native module."""

from __future__ import annotations

import inspect

import pytest
from numpydoc.validate import validate

import stickslip

# Left to taste: summaries of more than a line, an extended summary, sections See Also, Notes and Examples for everything.
WANTED = {
    "GL03", "GL05", "GL06", "GL07", "GL08", "GL09", "GL10", "SS01", "SS02", "SS03", "SS04", "PR01", "PR02", "PR03", "PR04", "PR06",
    "PR07", "PR08", "PR09", "PR10", "RT01", "RT02", "RT03", "RT04", "RT05",
}


def documented() -> list[str]:
    """Dotted names of all that a user can call or read."""
    names = []
    for name in stickslip.__all__:
        value = getattr(stickslip, name)
        if not (inspect.isclass(value) or inspect.isfunction(value)):
            continue
        names.append(f"stickslip.{name}")
        if inspect.isclass(value):
            for member, own in vars(value).items():
                if not member.startswith("_") and (callable(own) or isinstance(own, (property, classmethod))):
                    names.append(f"stickslip.{name}.{member}")
    return names


@pytest.mark.parametrize("name", documented())
def test_docstrings(name: str) -> None:
    wanted = WANTED
    value = stickslip
    for part in name.split(".")[1:]:
        value = inspect.getattr_static(value, part)
    if isinstance(value, property):
        wanted = wanted - {"RT01"}
    elif inspect.isclass(value) and value is not stickslip.Case:
        # Not made by a user, who reads its attributes.
        wanted = wanted - {"PR01"}
    found = [(code, text) for code, text in validate(name)["errors"] if code in wanted]
    assert not found, found


def test_everything_is_there_and_loaded_when_asked_for() -> None:
    assert set(dir(stickslip)) == set(stickslip.__all__)
    with pytest.raises(AttributeError, match="no attribute 'simulate'"):
        stickslip.simulate  # noqa: B018
