"""README tells the truth: every command in it runs, except the two that set up and test."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```", TEXT, re.S | re.M)
SHELL = [body for kind, body in BLOCKS if kind == "sh"]
COMMANDS = [line for body in SHELL[2:] for line in body.splitlines() if line]


EXPECTED = [
    "satisfied 0.0 1",
    "[ True False] [1 1]",
    "-inf 1.0 1.0 undecided",
    "good True 3",
    "I401 write [2, 5]",
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder that looks like the checkout to the commands."""
    folder = tmp_path_factory.mktemp("readme")
    (folder / "specs").symlink_to(ROOT / "specs", target_is_directory=True)
    (folder / "out").mkdir()
    return folder


def test_the_first_two_blocks_are_the_two_commands() -> None:
    assert "pip install" in SHELL[0]
    assert "stlspec learn" in SHELL[0]
    assert "pytest" in SHELL[1]


@pytest.mark.xdist_group("readme")
def test_the_commands_run_in_order(folder: Path) -> None:
    assert len(COMMANDS) >= 12
    for line in COMMANDS:
        command, _, comment = line.partition("#")
        expected = int(comment.split()[-1]) if comment.strip().startswith("exit") else 0
        command, _, source = command.partition("<")
        words = shlex.split(command)
        assert words[0] == "stlspec"
        words = [
            str(path.relative_to(folder)) if "*" in word else word
            for word in words
            for path in (sorted(folder.glob(word)) if "*" in word else [Path(word)])
        ]
        run = subprocess.run(
            [sys.executable, "-m", "stlspec", *words[1:]],
            cwd=folder,
            input=(folder / source.strip()).read_text() if source else None,
            capture_output=True,
            text=True,
            check=False,
        )
        assert run.returncode == expected, f"{line}\n{run.stdout}{run.stderr}"
        assert run.stdout.strip(), line


def test_the_python_example_runs(folder: Path) -> None:
    code, _ = [body for kind, body in BLOCKS if kind == "python"]
    run = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert run.stdout.splitlines() == EXPECTED


def test_the_wrapper_in_the_python_example_runs(folder: Path) -> None:
    _, code = [body for kind, body in BLOCKS if kind == "python"]
    run = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    own, robustness, satisfied = run.stdout.split()
    assert (own, satisfied) == ("-1.0", "False")
    assert -1.1 < float(robustness) < -0.8  # a car near -0.5, the flag at 0.5


def test_the_language_at_a_glance_checks() -> None:
    from stlspec.compiler.compiling import check_source
    from stlspec.source import SourceText

    (spec,) = [body for kind, body in BLOCKS if kind == "text" and body.startswith("spec drone")]
    assert check_source(SourceText.of("README.md", spec)).diagnostics == ()


def test_every_file_that_readme_links_exists() -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", TEXT):
        assert (ROOT / target).exists(), target


def test_the_reader_in_the_readme_works_once_it_is_installed(tmp_path: Path) -> None:
    (code,) = re.findall(r"^```python reader\n(.*?)^```", TEXT, re.S | re.M)
    assert len([line for line in code.splitlines() if line]) <= 15
    section, entry = re.findall(r'`(\[project\.entry-points\."[\w.]+"\])`, then `(\w+ = "[\w.:]+")`', TEXT)[0]
    (tmp_path / "tlog.py").write_text(code)
    about = tmp_path / "tlog-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: tlog\nVersion: 1.0\n")
    group = section.split('"')[1]
    (about / "entry_points.txt").write_text(f"[{group}]\n{entry.replace(chr(34), '')}\n")
    (tmp_path / "s.stl").write_text("time s\nsignal x\nsignal y\nhard up: always (x > y)\n")

    def scored(text: str) -> subprocess.CompletedProcess[str]:
        (tmp_path / "d.tlog").write_text(text)
        env = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), str(ROOT)])}
        words = ["score", "s.stl", "d.tlog"]
        command = [sys.executable, "-m", "stlspec", *words]
        return subprocess.run(command, cwd=tmp_path, env=env, capture_output=True, text=True, check=False)

    run = scored("0 x=2 y=-1\n1.5 x=2 y=3\n")
    assert run.returncode == 0 and "up fails at sample 1 (1.5 s): x = 2, needs > y = 3" in run.stdout, run.stderr
    for text, told in (("0 x=2 y=-1\n1 x\n", "(line 2)"), ("0 x=2 y=1\n1 x=2\n", "D805"), ("", "D833")):
        run = scored(text)
        assert run.returncode == 2 and told in run.stderr and run.stderr.count("error[") == 1, run.stderr
