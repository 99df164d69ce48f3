"""Freed memory is kept for the next evaluation, and asking for it twice does no more."""

import tracemalloc

from stlspec.semantics.memory import keep_freed_memory


def test_keeping_freed_memory_holds_on_to_nothing_itself():
    keep_freed_memory.cache_clear()
    tracemalloc.start()
    try:
        keep_freed_memory()
        keep_freed_memory()
        current, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert current < 100_000
    assert keep_freed_memory.cache_info().misses == 1
