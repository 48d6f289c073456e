"""Help texts of options from numpydoc: one entry a name, with its unit, as the command line's parser wants them."""

import re
from inspect import cleandoc

ENTRY = re.compile(r"(\w+(?:, \w+)*) : (.+)")
SECTIONS = ("Parameters", "Attributes")


def own_entries(doc: str) -> str:
    """Return a docstring in which every parameter has an entry of its own, and says its unit in the text.

    ``latitude, height : float, rad, m`` becomes two entries; units stand in the order of the names, or once for all.
    """
    lines = cleandoc(doc).splitlines()
    found: list[str] = []
    inside, k = False, 0
    while k < len(lines):
        line = lines[k]
        k += 1
        if k < len(lines) and lines[k].startswith("---"):
            inside = line in SECTIONS
        entry = ENTRY.fullmatch(line) if inside else None
        if entry is None:
            found.append(line)
            continue
        start = k
        while k < len(lines) and lines[k].startswith(" "):
            k += 1
        for name, kind, unit in _named(entry[1].split(", "), entry[2]):
            found += [f"{name} : {kind}", *lines[start:k], *([f"    Unit: {unit}."] if unit else [])]
    return "\n".join(found)


def _named(names: list[str], about: str) -> list[tuple[str, str, str]]:
    """Return name, type and unit of each name of an entry."""
    if "{" in about:
        return [(name, about, "") for name in names]
    kind, *rest = about.split(", ")
    units = [unit for unit in rest if not re.search(r"shape|\)|optional", unit)]
    if len(units) not in (0, 1, len(names)):
        units = [", ".join(units)]
    each = units * len(names) if len(units) == 1 else units or [""] * len(names)
    return [(name, kind, unit) for name, unit in zip(names, each, strict=True)]
