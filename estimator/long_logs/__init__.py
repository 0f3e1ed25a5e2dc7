"""Raw logs that are too long to be held: averaged part by part, to the same positions as `estimator.static` gives.

Of a rest only sums are kept: over its blocks and quarters, of squares, and how often a channel is at its end. A log is
gone through twice: first for its labels or, where it has none, for where the block stands still.
"""

from estimator.long_logs.average import LongLog, average_long

__all__ = ["LongLog", "average_long"]
