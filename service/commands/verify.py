"""`imu-health verify`: a certificate beside its session's file, without the service that issued it."""

from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import typer

from service.commands.console import AsJson, print_json, usable
from service.commands.speech import FAILED, UNUSABLE, translated
from service.papers.verifying.records import Outcome, RawFile, Verification
from service.papers.verifying.verify import Beside, verify

EXIT = {Outcome.AGREES: 0, Outcome.DIFFERS: FAILED, Outcome.NOT_CHECKED: UNUSABLE}
Certificate = Annotated[
    Path, typer.Argument(metavar="CERTIFICATE", help="The Digital Calibration Certificate, XML.", show_default=False)
]
Raw = Annotated[Path, typer.Argument(metavar="FILE", help="The session's file as uploaded.", show_default=False)]
Schema = Annotated[
    Path | None, typer.Option(help="Folder of PTB's schemas, with dcc/v3.3.0/dcc.xsd in it.", show_default=False)
]
Trust = Annotated[Path | None, typer.Option(help="The laboratory's certificate of its seal, PEM.", show_default=False)]
Reference = Annotated[
    Path | None, typer.Option(help="File of the session that it is judged against.", show_default=False)
]


def verify_certificate(
    certificate: Certificate,
    file: Raw,
    schema: Schema = None,
    trust: Trust = None,
    reference: Reference = None,
    as_json: AsJson = False,
) -> None:
    """Compute a certificate's every number again from the session's file: 0 agrees, 1 differs, 2 cannot be checked."""
    with usable(certificate):
        content = certificate.read_bytes()
    with usable(trust or certificate):
        trusted = None if trust is None else trust.read_bytes()
    beside = Beside(schema, trusted, None if reference is None else _read(reference))
    found = verify(content, _read(file), beside, datetime.now(UTC))
    print_json(_document(found)) if as_json else _print(found)
    raise typer.Exit(EXIT[found.outcome])


def _read(file: Path) -> RawFile:
    with usable(file):
        return RawFile(file.name, file.read_bytes())


def _document(found: Verification) -> dict[str, object]:
    checks = [{"subject": c.subject, "outcome": c.outcome.value, "says": list(c.says)} for c in found.checks]
    return {"format": "imu-verification/1", "outcome": found.outcome.value, "checks": checks}


def _print(found: Verification) -> None:
    for check in found.checks:
        typer.echo(f"{check.subject}: {check.outcome.value}")
        for line in check.says:
            typer.echo(f"    {translated(line)}")
    typer.echo(found.outcome.value)
