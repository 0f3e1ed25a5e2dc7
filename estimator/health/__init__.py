"""Health: from parameters to decisions."""

from estimator.health.decision import ParameterJudgement, judge

__all__ = ["ParameterJudgement", "judge"]
