"""Messages by e-mail: a webhook whose address is ``mailto:crew@example.org`` is sent them as plain text."""

import smtplib
import ssl
from dataclasses import dataclass
from email.header import Header
from email.mime.text import MIMEText
from email.utils import format_datetime
from typing import Literal

from service.flags.records import Notice
from service.kit.text import in_one_line, without_control

SCHEME = "mailto:"
SECONDS = 10.0
"""Longest wait for each answer of the mail server."""


@dataclass(frozen=True)
class MailServer:
    """Server that accepts e-mail, and its sender."""

    host: str = ""
    """Name of the server; empty where no e-mail is sent."""
    port: int = 25
    sender: str = ""
    security: Literal["none", "starttls", "tls"] = "starttls"

    @property
    def is_there(self) -> bool:
        """Whether e-mail can be sent."""
        return bool(self.host and self.sender)


NO_MAIL = MailServer()


def send(server: MailServer, address: str, notice: Notice) -> tuple[bool, str]:
    """Whether the server accepted the message, and its answer."""
    try:
        with _connected(server) as client:
            client.send_message(_message(server, address, notice))
    except (OSError, smtplib.SMTPException) as fault:
        return False, in_one_line(f"{type(fault).__name__}: {fault}")
    return True, "accepted by the mail server"


def _connected(server: MailServer) -> smtplib.SMTP:
    if server.security == "tls":
        return smtplib.SMTP_SSL(server.host, server.port, timeout=SECONDS, context=ssl.create_default_context())
    client = smtplib.SMTP(server.host, server.port, timeout=SECONDS)
    if server.security == "starttls":
        client.starttls(context=ssl.create_default_context())
    return client


LONGEST_SUBJECT = 200
"""Characters."""


def _message(server: MailServer, address: str, notice: Notice) -> MIMEText:
    """The same at every attempt, by its identifier.

    The subject is always encoded: of a plain one, readers would decode what looks like an encoded word.
    """
    place = f"Unit {in_one_line(notice.unit)}, {notice.at:%Y-%m-%d %H:%M} UTC, {in_one_line(notice.who)}"
    message = MIMEText(f"{without_control(notice.text)}\n\n{place}\n", "plain", "utf-8")
    message["From"], message["To"] = server.sender, address
    message["Subject"] = Header(in_one_line(f"{notice.unit}: {notice.text}")[:LONGEST_SUBJECT], "utf-8").encode()
    message["Date"] = format_datetime(notice.at)
    message["Message-ID"] = f"<{notice.key}@imu-health>"
    return message
