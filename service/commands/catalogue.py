"""Every command of `imu-health`: its module, and its line in the list of commands.

The list is shown, and a name completed, without importing any command; `tests/service/commands/test_start_up.py`
compares the texts with the commands' own help.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class CommandEntry:
    """One command."""

    home: str
    """Module below `service.commands`, and its function or group."""
    says: str
    """First paragraph of its help."""


CATALOGUE = {
    "serve": CommandEntry("serve.serve", "Start the service: schema brought up to date, pages and API on one address."),
    "calibrate": CommandEntry(
        "calibrate.calibrate_files",
        "Calibrate session files: scale factor, bias, quadratic term and axis of every sensor, with uncertainties.",
    ),
    "diagnose": CommandEntry(
        "diagnose.diagnose_files",
        "Say what the simulation gets wrong: the cause with its size, what else it could be, and what cannot be seen.",
    ),
    "template": CommandEntry(
        "documents.write_template",
        "Write a workbook to fill in: sensors, stand and schedule are there; `imu-health upload` takes it as it is.",
    ),
    "upload": CommandEntry(
        "upload.upload_files",
        "Upload session files and print the verdict of each; a file that is already there is stored once. Exit code 2 "
        "where one of them was not stored.",
    ),
    "fleet": CommandEntry(
        "fleet.fleet",
        "Show every unit with its condition, the worst first; some of them by stand or due date.",
    ),
    "history": CommandEntry(
        "fleet.history",
        "Show the parameters of a unit through time, each beside its reference and its tolerance.",
    ),
    "report": CommandEntry("documents.report", "Write the fleet's condition as a file for other programs."),
    "usable": CommandEntry(
        "fleet.usable",
        "Say whether a unit may be used: exit code 0 for yes, 1 for no, for a unit nobody knows, and in doubt.",
    ),
    "flags": CommandEntry("fleet.flags", "Show flags; without a state those that are open."),
    "verify": CommandEntry(
        "verify.verify_certificate",
        "Compute a certificate's every number again from the session's file: 0 agrees, 1 differs, 2 cannot be checked.",
    ),
    "export": CommandEntry(
        "documents.export", "Write the correction as parameters of PX4, ArduPilot, Kalibr or ROS 2."
    ),
    "simulate": CommandEntry(
        "simulate.simulate_files",
        "Write session files of a simulated block: six accelerometers on a two-axis stand unless told otherwise.",
    ),
    "plan": CommandEntry(
        "plan.plan_session",
        "Plan a session: elevation, positions, expected uncertainty of every parameter, and what it cannot see.",
    ),
    "parity": CommandEntry(
        "parity.parity",
        "Judge a recording in service by what the redundant sensors say of one another; no stand needed.",
    ),
    "recalibrate": CommandEntry(
        "recalibrate.recalibrate_units",
        "Compute stored sessions again under the model in force; what was computed before stays readable.",
    ),
    "user": CommandEntry("accounts.user", "Make and change accounts."),
    "token": CommandEntry("accounts.token", "Make and revoke tokens."),
    "doctor": CommandEntry(
        "doctor.doctor",
        "Look at everything the service needs on this machine, and say what to do; exit code 1 where something fails.",
    ),
    "db": CommandEntry("database.database", "Bring the database's schema up or down."),
    "backup": CommandEntry(
        "database.backup",
        "Write all that is stored into one file, while the service runs; it is there whole or not at all.",
    ),
    "restore": CommandEntry(
        "database.restore_backup",
        "Put a backup into an empty database, of either kind, and an empty data folder. Everybody must sign in again.",
    ),
}
