"""Messages by e-mail: a webhook whose address is ``mailto:crew@example.org`` is sent them as plain text."""

import smtplib
import ssl
from dataclasses import dataclass
from email.message import EmailMessage
from email.utils import format_datetime
from typing import Literal

from service.flags.records import Notice

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
        return False, f"{type(fault).__name__}: {fault}"
    return True, "accepted by the mail server"


def _connected(server: MailServer) -> smtplib.SMTP:
    if server.security == "tls":
        return smtplib.SMTP_SSL(server.host, server.port, timeout=SECONDS, context=ssl.create_default_context())
    client = smtplib.SMTP(server.host, server.port, timeout=SECONDS)
    if server.security == "starttls":
        client.starttls(context=ssl.create_default_context())
    return client


def _message(server: MailServer, address: str, notice: Notice) -> EmailMessage:
    """The message of a notice; its identifier is the same at every attempt."""
    message = EmailMessage()
    message["From"], message["To"] = server.sender, address
    message["Subject"] = f"{notice.unit}: {notice.text}".replace("\n", " ")[:200]
    message["Date"] = format_datetime(notice.at)
    message["Message-ID"] = f"<{notice.key}@imu-health>"
    message.set_content(f"{notice.text}\n\nUnit {notice.unit}, {notice.at:%Y-%m-%d %H:%M} UTC, {notice.who}\n")
    return message
