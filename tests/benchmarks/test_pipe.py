"""The rows of the pipe benchmark are a recording, and its figures are those of a process that ended well."""

from tests.benchmarks.pipe import HEADER, SPEC, measured, rows


def test_rows_go_on_where_the_last_block_ended():
    blocks = list(rows(4_000_000))
    lines = b"".join(blocks).splitlines()
    assert [int(line.split(b",")[0]) for line in lines[::1000]] == list(range(0, 10 * len(lines), 10_000))
    assert {line.count(b",") for line in lines} == {HEADER.count(b",")}


def test_a_run_is_measured(tmp_path):
    spec = tmp_path / "pipe.stl"
    spec.write_text(SPEC)
    sent, seconds, peak = measured(1_000_000, spec)
    assert sent > 1_000_000 and seconds > 0 and peak > 2**20
