"""Many files to one result."""

import json
from dataclasses import replace

import pytest

from stlspec.demos import load_demonstrations
from stlspec.errors import DataError
from stlspec.many.engines import in_processes, serially
from stlspec.many.run import Summary, gather, identity_of, score_many
from stlspec.scores import ranked, score


def rows(path):
    return [json.loads(line) for line in path.read_text().splitlines()]


def test_the_rows_are_the_scores_without_ranks(job, paths, tmp_path):
    out = tmp_path / "scores.jsonl"
    assert score_many(job, paths, out, serially) == Summary(9, 27, 0)
    expected = score(job.bundle, load_demonstrations(paths)).to_json()["demonstrations"]
    for row in expected:
        del row["rank"]
    assert [{k: v for k, v in row.items() if k != "file"} for row in rows(out)] == expected


def test_a_run_that_stops_halfway_goes_on_and_ends_in_the_same_bytes(job, paths, tmp_path):
    whole, cut = tmp_path / "whole.jsonl", tmp_path / "cut.jsonl"
    score_many(job, paths, whole, serially)

    def stops(work, some):
        for number, path in enumerate(some):
            if number == 4:
                raise KeyboardInterrupt
            yield work(path)

    with pytest.raises(KeyboardInterrupt):
        score_many(job, paths, cut, stops)
    assert not cut.exists()
    asked = []
    score_many(job, paths, cut, serially, told=lambda found, done: asked.append((found.path, done)))
    assert asked == [(path, number) for number, path in enumerate(paths, 1)][4:]
    assert cut.read_bytes() == whole.read_bytes()


def test_a_file_that_cannot_be_used_ends_the_run_or_is_left_out(job, paths, tmp_path):
    bad = tmp_path / "bad.csv"
    bad.write_text("x,y\n1,nan\n")
    mixed = [*paths[:2], str(bad), *paths[2:]]
    out = tmp_path / "scores.jsonl"
    with pytest.raises(DataError):
        score_many(job, [str(bad), *paths], out, serially)
    assert not list(tmp_path.glob("scores*")), "nothing was settled, and nothing stands in the way of the next run"
    with pytest.raises(DataError):
        score_many(job, mixed, out, serially)
    assert not out.exists()
    assert score_many(job, mixed, out, serially, keep_going=True) == Summary(10, 27, 1)
    scores, problems = gather(job, mixed, serially, keep_going=True)
    assert (len(scores), [d.code for d in problems]) == (27, ["D801"])
    with pytest.raises(DataError):
        gather(job, mixed, serially)
    with pytest.raises(DataError):
        gather(job, [str(bad)], serially, keep_going=True)


def test_ranks_in_memory_are_those_of_one_process(job, paths):
    def two(work, some):
        return in_processes(work, some, 2)

    scores, _ = gather(job, paths, two)
    assert ranked(job.bundle, scores).to_json() == score(job.bundle, load_demonstrations(paths)).to_json()


def test_work_is_told_apart_by_spec_options_and_the_files_that_are_settled(job, paths):
    same = identity_of(job, paths)
    assert same(4) == identity_of(job, [*paths[:4], "other.csv"])(4)
    others = [identity_of(job, paths[::-1]), identity_of(replace(job, end="strict"), paths)]
    assert [same(n) for n in (2, 5, 4, 9)] == [identity_of(job, paths)(n) for n in (2, 5, 4, 9)]
    assert len({same(4), same(5), *(other(4) for other in others)}) == 4
