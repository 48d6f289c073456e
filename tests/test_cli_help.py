"""Help of the command line: every option of a part has a text of its own, with its unit."""

import dataclasses
import re

import pytest

from bench._cli_help import own_entries
from bench.cli import main
from bench.export import earth_motions
from bench.formats import formats
from bench.solvers import solvers

DOC = """A thing.

    Parameters
    ----------
    latitude, longitude, height : float, rad, rad, m
        Geodetic,
        at t = 0.
    swing, phase : tuple of 3 floats, rad
    rate : float, Hz
        How often.
    axes : {"a", "b"}
        Which.
    bias : array_like, shape (3,), rad/s, optional
    flag : bool

    Raises
    ------
    InputError : never, s
        If not.
    """


def entries(doc):
    """Return the entries of the first section that has any, by name."""
    return dict(re.findall(r"^(\w+) : [^\n]*\n((?:    [^\n]*\n?)*)", doc + "\n", flags=re.MULTILINE))


def test_every_name_has_its_own_entry_and_unit():
    found = entries(own_entries(DOC))
    assert found["latitude"] == found["longitude"] == "    Geodetic,\n    at t = 0.\n    Unit: rad.\n"
    assert found["height"] == "    Geodetic,\n    at t = 0.\n    Unit: m.\n"
    assert found["swing"] == found["phase"] == "    Unit: rad.\n"
    assert found["rate"] == "    How often.\n    Unit: Hz.\n"
    assert found["axes"] == "    Which.\n"
    assert found["bias"] == "    Unit: rad/s.\n"
    assert found["flag"] == ""
    assert "InputError : never, s\n    If not." in own_entries(DOC)  # no parameter


def test_once_more_changes_nothing():
    assert own_entries(own_entries(DOC)) == own_entries(DOC)


@pytest.mark.parametrize("kind", ["motions", "formats", "navigation", "damping"])
def test_every_option_of_a_part_is_explained(kind):
    parts = {"motions": earth_motions, "formats": formats}
    for cls in parts.get(kind, lambda: solvers(kind))().values():
        found = entries("\n".join(own_entries(base.__doc__ or "") for base in cls.__mro__[:-1]))
        options = [option.name for option in dataclasses.fields(cls) if option.init]
        assert set(options) <= set(found), cls


def test_the_help_says_units(capsys):
    with pytest.raises(SystemExit):
        main(["export", "earth-rest", "--format", "csv", "--help"])
    text = " ".join(capsys.readouterr().out.replace("│", " ").split())
    for option, unit in (("latitude", "rad"), ("height", "m"), ("swing-frequency", "rad/s")):
        assert re.search(rf"--motion\.{option} FLOAT( FLOAT FLOAT)? [^-]*?Unit: {unit}\.", text), option
