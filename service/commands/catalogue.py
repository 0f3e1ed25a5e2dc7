"""Every command of `imu-health`: its module, and its line in the list of commands.

The list is shown, and a name completed, without importing any command; `tests/service/commands/test_start_up.py`
compares the texts with the commands' own help.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class CommandEntry:
    """One command."""

    home: str
    """Module below `service.commands`, and its function or group; none where the module has a table."""
    says: str
    """The first paragraph of its help."""


CATALOGUE = {
    "serve": CommandEntry("serve.serve", "Start the service: schema brought up to date, pages and API on one address."),
    "fill": CommandEntry(
        "fill.fill",
        "Fill an empty database with a large fleet of simulated units: sessions of three years, custody, retirement.",
    ),
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
        "Show every unit with its condition, the worst first; some of them by stand, type, due date or flag.",
    ),
    "history": CommandEntry(
        "fleet.history",
        "Show the parameters of a unit through time, each beside its reference and its tolerance.",
    ),
    "units": CommandEntry(
        "register",
        "Show the register of units; enter, move, retire and return them, import and export it as CSV.",
    ),
    "due": CommandEntry("register", "Show which units must be calibrated when, with where they are and who has them."),
    "report": CommandEntry("documents.report", "Write the fleet's condition as a file for other programs."),
    "usable": CommandEntry(
        "api",
        "Say whether a unit may be used: exit code 0 for yes, 1 for no, for a unit nobody knows, and in doubt.",
    ),
    "flags": CommandEntry("api", "Show what somebody must look after; give it to somebody, acknowledge or resolve it."),
    "views": CommandEntry("api", "List the views of the pages that were saved under a name, with their addresses."),
    "models": CommandEntry(
        "long_work",
        "Show accepted causes and what they moved; accept what sessions show together, or withdraw it.",
    ),
    "service": CommandEntry(
        "api",
        "Record a service: a break, after which the unit's next session is its new reference.",
    ),
    "session": CommandEntry(
        "api",
        "Withdraw a session, accept it again, or choose it as the reference of its time.",
    ),
    "withdraw-service": CommandEntry(
        "api",
        "Take a service back: it stays on record and is no break any more.",
    ),
    "note": CommandEntry("api", "Write a note on a unit's history, or on a session."),
    "attach": CommandEntry(
        "api",
        "Attach files to a unit or a session: photographs, protocols. They are kept as they are and never opened.",
    ),
    "certificate": CommandEntry("documents.certificate", "Write the certificate of a session."),
    "verify": CommandEntry(
        "verify.verify_certificate",
        "Compute a certificate's every number again from the session's file: 0 agrees, 1 differs, 2 cannot be checked.",
    ),
    "sign": CommandEntry(
        "documents.sign",
        "Sign the certificate of a session: reviewed, then approved by somebody else. Asks for your password.",
    ),
    "seal": CommandEntry("documents.seal", "The laboratory's electronic seal."),
    "customer": CommandEntry("api", "Record for whom a unit is calibrated; its certificates name them."),
    "stand-certificate": CommandEntry(
        "api",
        "Record the certificate of a stand's own calibration, which every session on it hangs on.",
    ),
    "stand-affected": CommandEntry(
        "api", "List every certificate whose numbers rest on a stand, for when it was found bad."
    ),
    "stand-dcc": CommandEntry("api", "Record a stand's certificate from its document."),
    "correction": CommandEntry(
        "documents.correction", "Write the correction that firmware applies to readings, as JSON."
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
    "ready": CommandEntry(
        "plan.ready",
        "Say whether a unit is warm and still enough to be measured, by the first minutes of a record: exit code 0 for "
        "ready, 1 for not yet.",
    ),
    "missing": CommandEntry(
        "plan.missing_positions",
        "Say which positions a session still lacks while it is measured: settings of the stand, or orientations to "
        "add.",
    ),
    "parity": CommandEntry(
        "parity.parity",
        "Judge a recording in service by what the redundant sensors say of one another; no stand needed.",
    ),
    "recalibrate": CommandEntry(
        "recalibrate.recalibrate_units",
        "Compute stored sessions again under the model in force; what was computed before stays readable.",
    ),
    "jobs": CommandEntry("long_work", "Show work that takes long: ask for it, look how far it has come, cancel it."),
    "user": CommandEntry("accounts.user", "Make and change accounts."),
    "token": CommandEntry("accounts.token", "Make and revoke tokens."),
    "audit": CommandEntry("accounts.audit", "Read and check the audit trail."),
    "open": CommandEntry(
        "api",
        "Open the page of a unit or a session in the browser, and print its address; without one the fleet.",
    ),
    "doctor": CommandEntry(
        "doctor.doctor",
        "Look at everything the service needs on this machine, and say what to do; exit code 1 where something fails.",
    ),
    "db": CommandEntry("database.database", "Bring the database's schema up or down."),
    "backup": CommandEntry(
        "database.backup",
        "Write all that is stored into one file, while the service runs: `imu-health backup FILE`.",
    ),
    "restore": CommandEntry(
        "database.restore_backup",
        "Put a backup into an empty database, of either kind, and an empty data folder. Everybody must sign in again.",
    ),
}
