import io
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stlspec.errors import DataError
from stlspec.readers.npz import read


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "d.npz"


def refused(file: Path) -> tuple[str, str]:
    with pytest.raises(DataError) as error:
        read(file)
    (found,) = error.value.diagnostics
    assert found.file == str(file)
    return found.code, str(error.value)


def head(shape: tuple[int, ...], descr: str = "<f8") -> bytes:
    """The head of an array, which may claim what its body does not hold."""
    stream = io.BytesIO()
    np.lib.format.write_array_header_1_0(stream, {"descr": descr, "fortran_order": False, "shape": shape})
    return stream.getvalue()


def test_every_array_is_a_signal(file):
    np.savez(file, x=np.array([1, 2]), ok=np.array([True, False]), y=np.array([0.5, np.inf], dtype=np.float32))
    (found,) = read(file)
    assert {k: (v.tolist(), v.dtype.kind) for k, v in found.columns.items()} == {
        "x": ([1, 2], "f"),
        "ok": ([True, False], "b"),
        "y": ([0.5, np.inf], "f"),
    }


def test_states_actions_and_time_have_their_own_places(file):
    np.savez_compressed(file, x=[1, 2], time=[0, 0.1], states=[[0, 0], [0, 1]], actions=[2])
    (found,) = read(file)
    assert found.time.tolist() == [0, 0.1]
    assert found.states == ([0, 0], [0, 1]) and found.actions == (2,)
    assert list(found.columns) == ["x"]


def test_episodes_share_out_the_actions(file):
    np.savez(file, x=[1, 2, 3, 4, 5], episode=[4, 4, 2, 2, 2], actions=[9, 7, 8], states=[0, 1, 2, 3, 4])
    first, second = read(file)
    assert (first.episode, first.columns["x"].tolist(), first.actions, first.states) == ("4", [1, 2], (9,), (0, 1))
    assert (second.episode, second.columns["x"].tolist(), second.actions) == ("2", [3, 4, 5], (7, 8))


def test_a_single_episode_needs_no_number(file):
    np.savez(file, x=[1, 2], episode=["a", "a"])
    assert read(file)[0].episode is None


def test_words_stay_words_for_the_trace_to_refuse(file):
    np.savez(file, x=np.array(["fast", "slow"]))
    assert read(file)[0].columns["x"].tolist() == ["fast", "slow"]


def test_nothing_is_unpickled(file):
    np.savez(file, x=np.array([{"a": 1}, 2], dtype=object))
    code, text = refused(file)
    assert code == "D836" and "Python objects" in text


def test_an_archive_that_claims_too_much_is_refused_before_it_is_unpacked(file):
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive, archive.open("x.npy", "w") as member:
        member.write(head((2**27 + 1,), "|u1"))
        for _ in range(2**7):
            member.write(bytes(2**20))
    assert file.stat().st_size < 2**20
    assert refused(file)[0] == "D838"


@pytest.mark.parametrize("shape", [(2**40,), (2**20, 2**20, 2**20), (3,)])
def test_a_head_that_claims_more_than_the_body_holds_is_refused(file, shape):
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("x.npy", head(shape) + bytes(16))
    code, _ = refused(file)
    assert code == ("D836" if shape == (3,) else "D838")


def test_an_array_that_comes_twice_is_refused(file):
    with pytest.warns(UserWarning, match="Duplicate"), zipfile.ZipFile(file, "w") as archive:
        for _ in range(2):
            archive.writestr("x.npy", head((1,)) + bytes(8))
    assert refused(file)[0] == "D835"


@pytest.mark.parametrize(
    ("arrays", "code", "words"),
    [
        ({"x": np.zeros((2, 2))}, "D837", "signal 'x' is an array of shape (2, 2)"),
        ({"x": np.float64(3)}, "D837", "signal 'x'"),
        ({"x": np.zeros(2, dtype=complex)}, "D837", "complex128"),
        ({"x": [1, 2], "y": [1]}, "D805", "'y' has 1 sample"),
        ({"x": [1, 2], "states": 3}, "D837", "'states'"),
        ({"x": [1, 2], "actions": [1, 2]}, "D839", "2 actions for 2 samples"),
        ({"x": [1, 2], "episode": [0]}, "D805", "'episode' has 1"),
        ({"x": [1, 2, 3], "episode": [0, 1, 1], "actions": [1, 2]}, "D839", "3 samples in 2 episodes"),
        ({"x": []}, "D803", "no samples"),
        ({}, "D803", "no samples"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(file, arrays, code, words):
    np.savez(file, **arrays)
    found, text = refused(file)
    assert found == code and words in text


@pytest.mark.parametrize(
    "data", [b"x,y\n1,2\n", b"PK\x03\x04", b"PK\x05\x06" + bytes(18), b"\x93NUMPY\x01\0", bytes(100)]
)
def test_what_is_no_archive_is_refused(file, data):
    file.write_bytes(data)
    assert refused(file)[0] in ("D836", "D803")


@given(data=st.data())
def test_a_damaged_archive_is_read_or_refused(data, tmp_path_factory):
    file = tmp_path_factory.mktemp("npz") / "d.npz"
    np.savez(file, x=np.arange(4), states=np.arange(4))
    content = bytearray(file.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    file.write_bytes(content[: data.draw(st.integers(1, len(content)))])
    try:
        assert read(file)[0].n_samples > 0
    except DataError as error:
        assert all(d.file == str(file) for d in error.diagnostics)


def test_whole_time_stamps_keep_every_nanosecond(file):
    stamps = [1700000000123456789, 1700000000123456790]
    np.savez(file, time=np.array(stamps), x=[1, 2])
    assert read(file)[0].time.tolist() == stamps
