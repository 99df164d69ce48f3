"""The house rules, enforced: import order, no cycles, a test file for each module, small units, light imports."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "stlspec"
ORDER = (
    "source errors lang compiler markup columns traces semantics documents api envs readers demos sampling binding "
    "formulas scores many rewards wrapper gym learning paper pictures pages report tools cli __main__"
).split()
LIGHT = ("numpy", "networkx", "gymnasium", "rich", "typer", "lark", "matplotlib")
LATE = {
    "networkx": {"compiler/graph.py"},
    "matplotlib": {"learning/plots.py", "paper/figures.py", "pictures/drawing.py"},
    "pyarrow": {"readers/parquet.py", "many/journal.py"},
    "ray": {"many/engines.py"},
    "minari": {"readers/minari.py"},
    "gymnasium": {"readers/minari.py"},
    "h5py": {"readers/minari.py"},
    "PIL": {"readers/minari.py"},
    "imitation": {"paper/mce_irl.py"},
    "seals": {"paper/mce_irl.py"},
    "torch": {"paper/mce_irl.py"},
}
"""Third-party packages that may be imported inside functions, and where."""
MODULES = sorted(PACKAGE.rglob("*.py"))


def name_of(path: Path) -> str:
    return path.relative_to(PACKAGE).as_posix()


def stage(name: str) -> str:
    """Return the stage that a module belongs to: the first part of its path."""
    return name.split("/")[0].removesuffix(".py")


def imports(tree: ast.AST) -> list[tuple[str, int]]:
    """Return the modules that a tree imports at any depth, `if TYPE_CHECKING` left out, with lines."""
    hidden = {
        id(inner)
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"
        for inner in ast.walk(node)
    }
    found = []
    for node in ast.walk(tree):
        if id(node) in hidden:
            continue
        if isinstance(node, ast.Import):
            found += [(alias.name, node.lineno) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute"
            base = node.module or ""
            found += [(f"{base}.{alias.name}", node.lineno) for alias in node.names]
    return found


def internal(path: Path) -> list[str]:
    """Return the modules of this package that a module imports, as paths."""
    found = []
    for name, _ in imports(ast.parse(path.read_text())):
        if not name.startswith("stlspec."):
            continue
        parts = name.split(".")[1:]
        for end in range(len(parts), 0, -1):
            base = PACKAGE.joinpath(*parts[:end])
            if base.with_suffix(".py").exists():
                found.append(name_of(base.with_suffix(".py")))
                break
            if (base / "__init__.py").exists():
                found.append(name_of(base / "__init__.py"))
                break
    return found


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_imports_point_up_the_list_only(path: Path) -> None:
    here = stage(name_of(path))
    if here == "__init__":
        return
    for other in internal(path):
        if stage(other) == "__init__":
            continue  # the version
        assert ORDER.index(stage(other)) <= ORDER.index(here), f"{name_of(path)} imports {other}"


def test_there_are_no_import_cycles() -> None:
    graph = {name_of(path): set(internal(path)) - {name_of(path)} for path in MODULES}
    while True:
        free = [name for name, needed in graph.items() if not needed]
        if not free:
            break
        for name in free:
            del graph[name]
        for needed in graph.values():
            needed.difference_update(free)
    assert not graph, f"a cycle among {sorted(graph)}"


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_late_imports_stand_only_where_they_may(path: Path) -> None:
    name = name_of(path)
    tree = ast.parse(path.read_text())
    for function in ast.walk(tree):
        if not isinstance(function, ast.FunctionDef):
            continue
        for module, line in imports(function):
            top = module.split(".")[0]
            command = (name.startswith("cli/") or path.name == "__main__.py") and top == "stlspec"
            allowed = command or name in LATE.get(top, set())
            assert allowed, f"{name}:{line} imports {module} inside a function"


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_modules_and_functions_are_small(path: Path) -> None:
    text = path.read_text()
    assert text.count("\n") <= 400
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            body = node.body[1:] if ast.get_docstring(node) and len(node.body) > 1 else node.body
            length = (node.end_lineno or 0) - body[0].lineno + 1
            assert length <= 40, f"{path}:{node.lineno} {node.name} has {length} lines"


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_every_module_has_a_docstring_and_a_test_of_the_same_name(path: Path) -> None:
    tree = ast.parse(path.read_text())
    assert ast.get_docstring(tree), f"{path} has no docstring"
    if path.name == "__init__.py" or is_catalogue(tree):
        return  # packages are tested through their modules, tables by tests/errors/test_catalogue.py
    relative = path.relative_to(PACKAGE)
    expected = ROOT / "tests" / relative.parent / f"test_{relative.stem.strip('_')}.py"
    assert expected.exists(), f"{relative} has no test file {expected.relative_to(ROOT)}"


def is_catalogue(tree: ast.Module) -> bool:
    """Tell whether a module only holds rows of the catalogue of codes."""
    defined = [n for n in tree.body if isinstance(n, ast.FunctionDef | ast.ClassDef)]
    names = [n.target.id for n in tree.body if isinstance(n, ast.AnnAssign) and isinstance(n.target, ast.Name)]
    return not defined and names == ["CODES"]


def test_no_module_is_a_drawer_for_everything() -> None:
    assert not [p for p in MODULES if p.stem in ("utils", "helpers", "common", "misc")]


def loaded_by(code: str) -> set[str]:
    """Run code in a fresh interpreter and return the heavy packages that it loaded."""
    script = f"import sys\n{code}\nprint(*[m for m in {LIGHT!r} if m in sys.modules])"
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return set(run.stdout.splitlines()[-1].split())


def test_importing_the_package_loads_nothing_heavy() -> None:
    assert loaded_by("import stlspec") == set()


@pytest.mark.parametrize(
    "words",
    [["check", "specs/example_1.stl"], ["fmt", "--check", "specs/example_1.stl"], ["explain", "I401"], ["explain"]],
)
def test_check_and_explain_load_only_what_they_need(words: list[str]) -> None:
    path = [word if not word.startswith("specs") else str(ROOT / word) for word in words]
    heavy = loaded_by(f"from stlspec.cli.main import run\nassert run({path!r}) == 0")
    assert heavy <= {"lark", "typer", "rich"}


def test_the_public_surface_is_frozen() -> None:
    import stlspec

    assert len(set(stlspec.__all__)) == len(stlspec.__all__)
    assert set(stlspec.__all__) == {
        *(
            "Algebra",
            "BOOLEAN",
            "Explanation",
            "MIN_MAX",
            "Monitor",
            "log_sum_exp",
            "Bundle",
            "BundleError",
            "DataError",
            "Demonstration",
            "Diagnostic",
            "Evaluation",
        ),
        *("InputError", "Outcome", "Policy", "Ranking", "RewardMap", "SpecError", "StlspecError", "UsageError"),
        *("Verdict", "Witness", "__version__", "compile", "infer_reward", "learn", "load"),
        *("load_demonstrations", "load_policy", "load_reward", "make_environment", "score"),
    }
    for name in stlspec.__all__:
        assert getattr(stlspec, name) is not None


def test_no_path_of_a_machine_and_no_host_of_a_registry_is_in_the_project() -> None:
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=False
    ).stdout.split("\0")
    forbidden = ["/" + "root/", "/" + "work/", "pypi" + ".org", "files.python" + "hosted", "registry.npm" + "js"]
    for name in filter(None, listed):
        path = ROOT / name
        if path.suffix in (".png", ".npz", ".bin") or not path.exists():
            continue
        text = path.read_text(encoding="utf-8", errors="replace")
        assert not [word for word in forbidden if word in text], name
