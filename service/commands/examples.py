"""Examples in the help of every command: lines to type, each with its purpose.

A line belongs to the command whose words it begins with, and to its group.
"""

from collections.abc import Iterator

PROGRAM = "imu-health"
LINES = """
serve --demo  # a fleet of simulated units to look at
fill --units 1000 --data-folder large  # a large fleet to try, then: serve --data-folder large
serve --data-folder my-units --port 8080  # your own, on another port
calibrate session.json  # every sensor's parameters with their uncertainties
calibrate sessions/*.json --json  # one object a line, for a program
diagnose session.json  # which physical cause the readings show
diagnose latest.json --history first.json --history second.json  # against the unit's earlier sessions
template --unit BA-017 --out next.xlsx  # made like the unit's last session
template --kind gyroscope --sensors 4 --out gyros.xlsx  # for a block that nobody knows yet
template --unit BA-017 --lang ru --out next.xlsx  # with its sheets and hints in Russian
upload session.xlsx  # stored, judged against the unit's reference
upload after-transport.json --check  # judged and kept, and the due date stays
upload bench.csv --mapping bench-3.json  # a table of your own layout
upload corrected.json --supersedes 3f9a0c5be1d24786aa10 --by "K. Ito" --why "measured on BA-018"  # for another one
fleet --stand S1 --due-before 2026-12-01  # what one stand has to measure until then
fleet | jq -r 'select(.verdict == "fail") | .serial'  # in a pipe: one unit a line
history BA-017 --sensor A3 --parameter bias  # how one parameter moved
history BA-017 --since 2026-01-01 --format jsonl > history.jsonl  # for a program
units import register.csv --by "K. Ito"  # units before they are measured, their locations and custodians
units enter BA-901 --type RA-6 --location "Hangar 2" --by "K. Ito"  # one unit
units move BA-017 --location "Hangar 3" --custodian "M. Sato" --by "K. Ito"  # kept in its history
units retire BA-017 --why "scrapped" --by "K. Ito"  # out of fleet, due dates and alarms; its records stay
units return BA-017 --why "repaired after all" --by "K. Ito"  # back into use
units show BA-017  # where it is, and where it was
units export --out register.csv  # to change and import again
due --when overdue --location "Hangar 2"  # what must come back from there
due --when 2026-12 --format jsonl  # a month, for a program
report --format xlsx --out fleet.xlsx  # the fleet as a workbook
report status BA-017 --out status.pdf  # one page to hand over with the unit
report label BA-017 --out label.pdf  # due date and QR code, to stick on the unit
usable BA-017 && echo "may fly"  # the exit code says it
flags --assigned me  # what you are to look after
flags acknowledge 3 --by "K. Ito" --why "replacement ordered"  # somebody knows of it
flags resolve 3 --by "K. Ito" --why "A3 replaced"  # the matter is settled
flags assign 3 5 --to "M. Sato" --by "K. Ito"  # given to somebody
stand-affected ODG-1 --since 2026-01-01  # what to look at again where the stand was found bad
models  # what was accepted, newest first
models accept stand S1 beta-eccentricity --by "K. Ito" --why "encoder looked at"  # every session on it is computed anew
models show 7  # how far that is, and what moved
models withdraw 7 --by "K. Ito" --why "encoder was replaced"  # and back again
service BA-017 repair --sensor A3 --at 2026-03-10 --by "K. Ito"  # the next session is the new reference
session withdraw 3f9a0c5be1d24786aa10 --by "K. Ito" --why "another unit was on the stand"  # it counts no more
session accept 3f9a0c5be1d24786aa10 --by "K. Ito" --why "it was the right unit after all"  # it counts again
session reference 3f9a0c5be1d24786aa10 --by "K. Ito" --why "first one at rest"  # later ones are judged against it
withdraw-service 4 --by "K. Ito" --why "done on BA-018"  # it is no break any more
note BA-017 "dropped on the hangar floor" --by "K. Ito"  # on the unit's history
note 3f9a0c5be1d24786aa10 "the room was warm" --by "K. Ito"  # on a session
attach photo.jpg protocol.pdf --to BA-017 --by "K. Ito" --text "connector J2"  # kept as they are
certificate 3f9a0c5be1d24786aa10 --out certificate.pdf  # for people
certificate 3f9a0c5be1d24786aa10 --format dcc --out certificate.xml  # for programs
verify certificate.xml session.json  # every number again from the session's file, without a service
verify certificate.xml session.json --trust seal-certificate.pem --schema schema  # whose seal it is, and PTB's schema
sign 3f9a0c5be1d24786aa10 --meaning reviewed  # then --meaning approved, by somebody else
seal trial --out seal.p12  # a key to try the seal with
customer BA-017 "Northern Airways" --address "2 Field Road, Oslo" --by "K. Ito"  # whom its certificates name
stand-certificate S1 --number K-2026-114 --issued-by PTB --issued-on 2026-02-01 --valid-until 2028-02-01 --by "K. Ito"
stand-dcc S1 certificate.xml --by "K. Ito"  # number, days and uncertainties from the document
correction 3f9a0c5be1d24786aa10 --out correction.json  # formula, numbers, a worked example
export 3f9a0c5be1d24786aa10 --system px4 --out unit.params  # parameters of a flight controller
simulate --unit BA-900 --sessions 3 --drift A3.bias=30 --out sessions  # a unit whose truth is known
simulate --programme in-service --drift A3.bias=200 --out sessions  # a flight of the same block
simulate --hide hysteresis --sensor A2 --out sessions  # a cause for `diagnose` to find
simulate --hide random --seed 7 --answer answer.json --out sessions  # one to guess, and the answer beside it
plan --sensors 6 --positions 12  # what a session would tell, before it is measured
plan session.json --minutes 40  # the next one like this, in the time that there is
ready first-minutes.json --duration 120  # is the unit warm and still enough to begin?
missing session.json  # positions that the session still lacks
parity flight.json --reference session.json  # which sensor has drifted since
recalibrate BA-017  # its sessions under the model in force
recalibrate --all --workers 4  # every session that another model concerns since
jobs  # long work, the newest first
jobs recalibrate --scope stand --name S1 --by "K. Ito"  # computed again beside the requests
jobs report --format xlsx --by "K. Ito"  # the fleet's workbook
jobs show 12 --wait --out fleet.xlsx  # stay until it is there
jobs cancel 12 --by "K. Ito"  # what was done stays
user add k.ito --role admin --name "K. Ito"  # prints the link for a password
user link k.ito  # another password
user connect k.ito 8f3a2c  # the same person at the provider
user change k.ito --role engineer  # another role
user change k.ito --inactive  # may not sign in any more
user list  # every account
token add bench-3 --role crew --label "bench 3"  # prints the secret, once
token revoke 2  # lets nobody in any more
token list  # what they are for, until when, last used
audit list --subject BA-017  # who did what to it
audit verify  # whether the trail is as it was written
open BA-017  # its page
doctor  # before you ask somebody
db upgrade  # the schema of this version
db downgrade 0011  # says first what would be lost, and asks
backup /backups/today.backup  # while the service runs
backup write /backups/today.backup  # the same, said in full
backup verify /backups/today.backup  # whether it can be restored
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
