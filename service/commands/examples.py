"""Examples in the help of every command: lines to type, each with its purpose.

A line belongs to the command whose words it begins with, and to its group.
"""

from collections.abc import Iterator

PROGRAM = "imu-health"
LINES = """
serve --demo  # a fleet of simulated units to look at
serve --data-folder my-units --port 8080  # your own, on another port
calibrate session.json  # every sensor's parameters with their uncertainties
calibrate sessions/*.json --json  # one object a line, for a program
diagnose session.json  # which physical cause the readings show
diagnose latest.json --history first.json --history second.json  # against the unit's earlier sessions
template --unit BA-017 --out next.xlsx  # made like the unit's last session
template --kind gyroscope --sensors 4 --out gyros.xlsx  # for a block that nobody knows yet
template --sensors 4 --out four.xlsx  # for a block of accelerometers
upload session.xlsx  # stored, judged against the unit's reference
upload after-transport.json --check  # judged and kept, and the due date stays
upload bench.csv --mapping bench-3.json  # a table of your own layout
fleet --stand S1 --due-before 2026-12-01  # what one stand has to measure until then
fleet | jq -r 'select(.verdict == "fail") | .serial'  # in a pipe: one unit a line
history BA-017 --sensor A3 --parameter bias  # how one parameter moved
history BA-017 --since 2026-01-01 --json > history.jsonl  # for a program
report --format xlsx --out fleet.xlsx  # the fleet as a workbook
usable BA-017 && echo "may fly"  # the exit code says it
flags --assigned me  # what you are to look after
verify certificate.xml session.json  # every number again from the session's file, without a service
verify certificate.xml session.json --trust seal-certificate.pem --schema schema  # whose seal it is, and PTB's schema
export 3f9a0c5be1d24786aa10 --system px4 --out unit.params  # parameters of a flight controller
simulate --unit BA-900 --sessions 3 --drift A3.bias=30 --out sessions  # a unit whose truth is known
simulate --programme in-service --drift A3.bias=200 --out sessions  # a flight of the same block
simulate --hide hysteresis --sensor A2 --out sessions  # a cause for `diagnose` to find
simulate --hide random --seed 7 --answer answer.json --out sessions  # one to guess, and the answer beside it
plan --sensors 6 --positions 12  # what a session would tell, before it is measured
parity flight.json --reference session.json  # which sensor has drifted since
recalibrate BA-017  # its sessions under the model in force
recalibrate --all --workers 4  # every session that another model concerns since
user add k.ito --role admin --name "K. Ito"  # prints the link for a password
user change k.ito --link  # another password
user change k.ito --subject 8f3a2c  # the same person at the provider
user change k.ito --role engineer  # another role
user change k.ito --inactive  # may not sign in any more
user list  # every account
user list --tokens  # what tokens are for, until when, last used
token add bench-3 --role crew --label "bench 3"  # prints the secret, once
token revoke 2  # lets nobody in any more
doctor  # before you ask somebody
db upgrade  # the schema of this version
db upgrade --back-to 0011  # says first what would be lost, and asks
backup /backups/today.backup  # while the service runs
backup /backups/today.backup --check  # whether it can be restored
restore /backups/today.backup --data-folder /data  # into an empty database
"""


def examples_of(words: str) -> tuple[tuple[str, str], ...]:
    """Lines of a command or of a group of commands, with their purposes."""
    return tuple(pair for pair in _pairs() if f"{pair[0]} ".startswith(f"{words} "))


def _pairs() -> Iterator[tuple[str, str]]:
    for line in LINES.strip().splitlines():
        command, _, purpose = line.partition("  # ")
        yield command, purpose


def help_of(words: str) -> str:
    """The examples as the end of a help text, in Markdown."""
    lines = (
        f"* `{PROGRAM} {command}`" + (f" — {purpose}" if purpose else "") for command, purpose in examples_of(words)
    )
    return "\n\n".join(["Examples:", *lines])
