"""The README tells the truth: its catalogue is current, its Python runs, its test command is that of .ci/run.

Run this file as a script to renew the catalogue.
"""

import re
from pathlib import Path

from bench.cli import _catalogue

ROOT = Path(__file__).parents[1]
README = ROOT / "README.md"
BEGIN, END = "<!-- catalogue: made by tests/test_readme.py -->\n", "<!-- end of catalogue -->"


def catalogue():
    rows = ["| kind | name | what it is |", "|---|---|---|"]
    for kind, entries in _catalogue().items():
        rows += [
            f"| {kind.removesuffix('s')} | `{name}` | {line.replace('|', chr(92) + '|')} |"
            for name, line in entries.items()
        ]
    return "\n".join(rows) + "\n"


def parts():
    before, rest = README.read_text().split(BEGIN)
    inside, after = rest.split(END)
    return before, inside, after


def test_catalogue_is_current():
    assert parts()[1] == catalogue()


def test_python_runs(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", README.read_text(), flags=re.DOTALL)
    assert len(blocks) == 5
    code = "\n".join(blocks).replace("trials=100", "trials=2")
    exec(compile(code, "README.md", "exec"), {"__name__": "readme"})
    residual, angles = capsys.readouterr().out.split("\n", 1)
    assert float(residual) < 1e-12
    assert "[" in angles


def test_ci_runs_the_test_command_of_the_readme():
    (command,) = re.findall(r"^python3 -m venv .*pytest tests/benchmarks$", README.read_text(), flags=re.MULTILINE)
    script = (ROOT / ".ci" / "run").read_text().replace("pip install -q", "pip install")
    assert command in script


def test_pictures_exist():
    for path in re.findall(r"!\[.*?\]\((.*?)\)", README.read_text()):
        assert (ROOT / path).stat().st_size > 10_000


if __name__ == "__main__":
    start, _, rest = parts()
    README.write_text(start + BEGIN + catalogue() + END + rest)
