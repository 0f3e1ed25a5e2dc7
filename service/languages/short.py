"""Words on their own, which extraction cannot tell from keys. They are translated wherever such a value is shown."""

WORDS = tuple(
    word.strip()
    for line in """
    pass | fail | conditional pass | conditional fail | undecidable | reference | no session | not judged
    accepted | questioned | withdrawn | superseded | simulated | none | overdue | repeat | again | fit | unfit
    raised | acknowledged | resolved | open | waiting | done | failed | delivered
    scale factor | scale | bias | quadratic term | quadratic | input axis | axis | misalignment | zero
    accelerometer | gyroscope | gyro | accelerometers | gyros | gyroscopes | sensors | everything
    unit | unit type | stand | session | block | type | lot | position | row | record | service
    two axis stand | arbitrary orientations | rotation alignment | rate table | in service
    direct | flipped | as found | as left | maximum likelihood | closed form | turntable | analytic
    adjustment | repair | sensor swap | new reference | note
    viewer | crew | engineer | admin | demonstration | nobody
    nothing wrong | unexplained | diagnosis | cause | sensor | fixture | temperature | vibration | gravity
    time | history | both runs | positions | turn | rotation | both | neither | epoch | margin
    direct run | flipped run | allowed | before | after | yes | no | proposed | default | environment | start
    rms | residual | flag | drift | risk | due | latitude | levelling | elevation | turn β | backwards
    Lower, −U | Upper, +U | shifted | parity | reviewed | approved | reviewed by | approved by | small | large
    password | diagnose | certificate | upload | customer | interval | tolerances | stage | recalibrate
    refuse | stand-certificate | question | acknowledge | resolve | assigned | check | attach
    Jan | Feb | Mar | Apr | May | Jun | Jul | Aug | Sep | Oct | Nov | Dec
    {first} and {last} | {first} or {last} | {first}; and {last}
    {unit} per {input} | {rate} a year | ppm | arcsec | degrees | missing | but
    a steady change of a parameter; a step is a sudden one
    state | since | who | where | what | view | page | name | address | revision | accepted | job
    by | condition | last session | sessions | why | measured | parameter | off reference | tolerance | location
    custodian | owner | retired | days | use | now | login | role | token | for | until | last used
    revoked | when | account | to | entered | moved | returned | running | cancelled | recalibration | report
    model | libraries | settings | folder | disk | database | clock | workers | secrets | seal | sign-in | message
    There is none. | No flag is open.
    No such file or directory | Permission denied | Is a directory | Not a directory
    """.strip().splitlines()
    for word in line.split("|")
)
MARGIN = "1 − (|y| + U)/T: 1 is no change, 0 the limit of a pass"
FROM_PYDANTIC = (
    "Field required",
    "Extra inputs are not permitted",
    "Input should be a valid string",
    "Input should be a valid integer",
    "Input should be a valid number",
    "Input should be a valid list",
    "Input should be a valid dictionary",
    "Input should be a valid boolean",
    "Input should be a finite number",
    "Input should be a valid integer, unable to parse string as an integer",
    "Input should be a valid number, unable to parse string as a number",
    "Input should be a valid boolean, unable to interpret input",
    "JSON decode error",
    "Input should have timezone info",
)
"""Errors of pydantic."""
FROM_HTTP = (
    "Bad Request",
    "Unauthorized",
    "Forbidden",
    "Not Found",
    "Method Not Allowed",
    "Request Timeout",
    "Conflict",
    "Misdirected Request",
    "Unprocessable Entity",
    "Unprocessable Content",
    "Content Too Large",
    "Request Entity Too Large",
    "Too Many Requests",
    "Internal Server Error",
    "Service Unavailable",
    "Insufficient Storage",
    "Not Implemented",
    "Bad Gateway",
    "Unsupported Media Type",
)
"""Titles of problems (RFC 9110)."""
FROM_JSON = (
    "Expecting value",
    "Expecting ',' delimiter",
    "Expecting ':' delimiter",
    "Expecting property name enclosed in double quotes",
    "Extra data",
    "Unterminated string starting at",
    "Invalid control character at",
    "Illegal trailing comma before end of object",
    "Illegal trailing comma before end of array",
)
"""Errors of Python's json."""
STANDING_ALONE = (*WORDS, MARGIN, *FROM_PYDANTIC, *FROM_HTTP, *FROM_JSON)
COUNTED = (
    *("accelerometer", "block", "byte", "column", "day", "flag", "gyro", "gyroscope", "orientation", "position"),
    *("problem", "reading", "row", "sensor", "session", "stand", "unit", "value"),
)
"""Things that are counted; all have a plural in s."""
NAMES = frozenset(
    (
        *("imu-health", "· imu-health", "OpenAPI", "Kalibr", "ROS 2", "imu-health {value}", "imu-health {version}"),
        *("about:blank", "https:", "private, no-cache", "Vary", "Cookie", "Connection", "openid profile email"),
        *("Liberation Sans", "Libertinus Serif", "General", "begins with", "yyyy-mm-dd hh:mm"),
        *("acc x", "acc y", "gyro x", "gyro y", "gyro z", "sin {value}", "cos {value}", "{value}.bias ({value})"),
        *("mounting{value}", "{value} ± {value} cm", "row {value}"),
    )
)
"""Not words: names of programs, headers, fonts, sensors and keys, and numbers."""
