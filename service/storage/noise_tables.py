"""The table of what the rests of sessions say of their sensors' noise."""

from datetime import datetime

from sqlalchemy import ForeignKey, String
from sqlalchemy.orm import Mapped, mapped_column

from service.storage.tables import Base


class SessionNoiseRow(Base):
    """imu-noise/1 of one session, with the curves; deflated. The terms are parameters of its history."""

    __tablename__ = "session_noise"
    session_id: Mapped[str] = mapped_column(ForeignKey("sessions.id"), primary_key=True)
    document: Mapped[bytes]
    estimator_version: Mapped[str] = mapped_column(String(40))
    made_at: Mapped[datetime]
