"""Health: from parameters to decisions."""

from estimator.health.decision import Judgement, judge

__all__ = ["Judgement", "judge"]
