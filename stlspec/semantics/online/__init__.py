"""Online monitoring: what is known of a requirement while samples still come."""

from stlspec.semantics.online.every import Known
from stlspec.semantics.online.interval import Enclosed, interval_evaluate
from stlspec.semantics.online.monitor import Final, Monitor, Open, late_warnings, make_monitor
from stlspec.semantics.online.program import Standing

__all__ = [
    "Enclosed",
    "Final",
    "Known",
    "Monitor",
    "Open",
    "Standing",
    "interval_evaluate",
    "late_warnings",
    "make_monitor",
]
