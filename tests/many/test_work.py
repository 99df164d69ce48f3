"""One file to its scores."""

import pickle

from stlspec import api
from stlspec.demos import load_demonstrations
from stlspec.envs.catalogue import make_environment
from stlspec.many.work import job_of, score_file
from stlspec.scores import Settled, score


def test_a_file_has_the_scores_that_it_has_alone(job, paths):
    found = score_file(job, paths[0])
    expected = score(job.bundle, load_demonstrations(paths[0]))
    assert [s.to_json() | {"rank": None} for s in expected.demonstrations] == [s.to_json() for s in found.scores]
    assert found.problems == ()


def test_no_trace_is_kept(job, paths):
    found = score_file(job, paths[0])
    assert all(type(x.result) is Settled for s in found.scores for x in s.requirements.values())
    assert len(pickle.dumps(found)) < 5000


def test_a_file_that_cannot_be_used_is_told_not_raised(job, tmp_path):
    found = score_file(job, str(tmp_path / "missing.csv"))
    assert (found.scores, [d.code for d in found.problems]) == ((), ["D830"])


def test_the_environment_goes_along_by_its_description(tmp_path):
    bundle = api.compile("signal d_goal\nhard reach: eventually (d_goal < 1)")
    path = tmp_path / "walk.json"
    path.write_text('{"states": [[0, 0], [0, 1]]}')
    for world in (
        make_environment("stlspec/GridWorld-v0", {}, ("SG",)),
        make_environment("FrozenLake-v1", {"map_name": "4x4", "is_slippery": False}),
        make_environment("FrozenLake-v1", {}, ("SG", "FF")),
    ):
        job = pickle.loads(pickle.dumps(job_of(bundle, world)))
        (alone,) = score(bundle, load_demonstrations(path), world).demonstrations
        (found,) = score_file(job, str(path)).scores
        assert found.requirements["reach"].to_json() == alone.requirements["reach"].to_json()
