"""The command: what is run, what is kept, what a stop leaves behind."""

import os
import signal
import subprocess
import sys
import time
from types import SimpleNamespace

import pytest

from stlspec.errors import InputError, UsageError
from stlspec.paper import command, journal
from stlspec.paper.experiments import EXPERIMENTS, Experiment


def options(out, *only, **fields):
    given = {"quick": True, "fresh": False, "figures": False, "jobs": 1, "out": str(out), "only": list(only)}
    return SimpleNamespace(**given | fields)


@pytest.fixture
def counted(monkeypatch, made):
    """Two experiments that count how often they are run."""
    runs = {"one": 0, "two": 0}

    def experiment(name):
        def run(budget, jobs, progress):
            runs[name] += 1
            progress(1, 1)
            return {"map": {}}

        return Experiment(name, f"title of {name}", run)

    monkeypatch.setattr(command, "EXPERIMENTS", {name: experiment(name) for name in runs})
    monkeypatch.setattr(command, "QUICK", made.tiny)
    return runs


def test_names_choose_experiments_and_may_begin_several():
    assert [e.name for e in command.chosen([])] == list(EXPERIMENTS)
    assert [e.name for e in command.chosen(["car"])] == ["car-50", "car-75", "car-100"]
    assert [e.name for e in command.chosen(["lakes", "car-50", "lakes"])] == ["lakes", "car-50"]


def test_an_unknown_name_is_refused_with_those_that_are_known():
    with pytest.raises(UsageError) as caught:
        command.chosen(["mars"])
    (found,) = caught.value.diagnostics
    assert found.code == "D880"
    assert "'mars'" in found.message
    assert "grids" in found.help


def test_finished_experiments_are_not_run_again_unless_asked(tmp_path, counted, capsys):
    command.run(options(tmp_path))
    command.run(options(tmp_path))
    assert counted == {"one": 1, "two": 1}
    assert "one: kept from before" in capsys.readouterr().err
    command.run(options(tmp_path, "two", fresh=True))
    assert counted == {"one": 1, "two": 2}


def test_a_stopped_reproduction_goes_on_after_the_last_finished_experiment(tmp_path, counted, monkeypatch, made):
    def stop(budget, jobs, progress):
        raise KeyboardInterrupt

    whole = command.EXPERIMENTS["two"]
    monkeypatch.setitem(command.EXPERIMENTS, "two", Experiment("two", "stops", stop))
    with pytest.raises(KeyboardInterrupt):
        command.run(options(tmp_path))
    assert [p.name for p in (tmp_path / "results").iterdir()] == ["one.json"]
    monkeypatch.setitem(command.EXPERIMENTS, "two", whole)
    command.run(options(tmp_path))
    assert counted == {"one": 1, "two": 1}
    assert (tmp_path / "report.md").read_text().startswith("# Learning from Demonstrations")


def test_what_lacked_its_libraries_is_measured_again(tmp_path, counted, monkeypatch):
    def skips(budget, jobs, progress):
        counted["one"] += 1
        return {"irl": {"skipped": "no libraries" if counted["one"] == 1 else None}}

    monkeypatch.setitem(command.EXPERIMENTS, "one", Experiment("one", "skips once", skips))
    experiment = command.EXPERIMENTS["one"]
    command.prepare(tmp_path, figures=False)
    for _ in range(3):
        command.measure(experiment, command.QUICK, tmp_path, jobs=1, fresh=False)
    assert counted["one"] == 2


@pytest.mark.parametrize("result", [{}, {"rows": 3}, {"rows": {"grid-5": {"shaped": [{"seed": 0}]}}}, {"rows": [[]]}])
def test_a_damaged_result_is_named_with_the_way_out(tmp_path, made, result, capsys):
    command.prepare(tmp_path, figures=False)
    journal.save(tmp_path, made.record("grids", result))
    with pytest.raises(UsageError) as caught:
        command.kept(tmp_path, made.tiny)
    (found,) = caught.value.diagnostics
    assert found.code == "D880"
    assert "grids.json" in found.message
    assert found.help == "measure it again: --only grids --fresh"


def test_a_result_that_cannot_be_drawn_is_damaged(tmp_path, made):
    pytest.importorskip("matplotlib")
    command.prepare(tmp_path, figures=False)
    with pytest.raises(UsageError, match="damaged"):
        command.draw({"table-1-grid-5": made.record("table-1-grid-5", {"truth": 3})}, tmp_path)


def test_an_account_of_libraries_of_another_kind_is_no_traceback(tmp_path, counted, made):
    command.prepare(tmp_path, figures=False)
    journal.save(tmp_path, made.record("one", {"irl": 3}))
    command.measure(command.EXPERIMENTS["one"], command.QUICK, tmp_path, jobs=1, fresh=False)
    assert counted["one"] == 0


def test_results_of_another_budget_are_measured_again(tmp_path, counted):
    command.run(options(tmp_path, "one"))
    command.run(options(tmp_path, "one", quick=False))
    assert counted["one"] == 2


def test_missing_matplotlib_is_refused_before_any_work_or_left_out(tmp_path, counted, monkeypatch):
    monkeypatch.setattr(command, "find_spec", lambda name: None)
    with pytest.raises(UsageError) as caught:
        command.run(options(tmp_path, figures=True))
    assert "stlspec[plot]" in caught.value.diagnostics[0].help
    assert counted == {"one": 0, "two": 0}
    command.run(options(tmp_path))
    assert counted == {"one": 1, "two": 1}


def test_a_folder_for_figures_is_made_only_where_there_will_be_some(tmp_path):
    command.prepare(tmp_path / "without", figures=False)
    command.prepare(tmp_path / "with", figures=True)
    assert [path.name for path in (tmp_path / "without").iterdir()] == ["results"]
    assert sorted(path.name for path in (tmp_path / "with").iterdir()) == ["figures", "results"]


def test_a_folder_that_cannot_be_made_is_a_diagnostic(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError) as caught:
        command.prepare(tmp_path / "file", figures=True)
    assert caught.value.diagnostics[0].code == "S092"


def test_the_smallest_experiment_prints_tables_and_writes_the_report(tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "none"))
    command.run(options(tmp_path, "table-1-lake-4"))
    out, err = capsys.readouterr()
    assert "Claims of the paper" in out
    assert "FrozenLake-4" in out
    assert "the report is" in err
    assert "## Table 1" in (tmp_path / "report.md").read_text()


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="the system has no kill -9")
def test_a_killed_reproduction_keeps_what_was_finished(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "none"))
    words = [sys.executable, "-m", "stlspec.paper", "--quick", "--no-figures", "--jobs", "1", "--out", str(tmp_path)]
    words += ["--only", "table-1-lake-4", "--only", "letter"]
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    first = tmp_path / "results" / "table-1-lake-4.json"
    deadline = time.monotonic() + 120
    while not first.exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert [p.name for p in (tmp_path / "results").iterdir()] == ["table-1-lake-4.json"]
    first.write_text(first.read_text().replace('"skipped": "', '"skipped": null, "why": "'))
    before = first.stat().st_mtime_ns
    done = subprocess.run([*words[:-4], "--only", "table-1-lake-4"], capture_output=True, text=True, check=True)
    assert "kept from before" in done.stderr
    assert first.stat().st_mtime_ns == before
