"""Evidence of many sessions: what no single session can show, pooled over a unit, a unit type or a stand."""

from estimator.groups.diagnose_group import diagnose_group, diagnose_statistics
from estimator.groups.results import GroupDiagnosis, GroupFinding
from estimator.groups.session_statistics import statistics_of
from estimator.groups.statistics import SessionStatistics
from estimator.groups.with_history import diagnose

__all__ = [
    "GroupDiagnosis",
    "GroupFinding",
    "SessionStatistics",
    "diagnose",
    "diagnose_group",
    "diagnose_statistics",
    "statistics_of",
]
