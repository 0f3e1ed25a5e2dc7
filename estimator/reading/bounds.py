"""The numbers that a session file may hold, each with its reason: one table, for reading and for a page of results.

Generous: any instrument that is calibrated passes. They keep squares, fourth powers and quotients of what passes far
within the range of floating-point numbers, so that no later step overflows or divides by what is as good as nothing.
"""

from dataclasses import dataclass

from estimator.reading.interval import Interval


@dataclass(frozen=True)
class Bound:
    """The bounds of one field or column, and why."""

    field: str
    within: Interval
    reason: str

    @property
    def row(self) -> str:
        """The row of the table in benchmarks/results/bounds.md."""
        least, zero = (self.within.smallest, "yes") if 0 in self.within else (self.within.low, "no")
        ends = f"{self.within.low:g} to {self.within.high:g}"
        return f"| `{self.field}` | {self.within.unit} | {ends} | {least:g} | {zero} | {self.reason} |"


ANGLE = "ten degrees, beyond which a stand is none; the best are known to 0.01"
COMPONENT = Interval(-2, 2)
BOUNDS = (
    Bound("site.latitude_deg", Interval(-90, 90, "degrees"), "there is no other"),
    Bound("site.height_m", Interval(-500, 9000, "m"), "the Earth's surface, from the Dead Sea to Everest"),
    Bound("site.gravity_m_s2", Interval(9.7, 9.9, "m/s²"), "the Earth's surface has 9.764 to 9.834"),
    Bound("stand.alpha_deg", Interval(-90, 90, "degrees"), "an elevation"),
    Bound("stand.chi_deg", Interval(-90, 90, "degrees"), "an elevation"),
    Bound("stand.sigma_arcsec", Interval(0, 36_000, "arcsec", 1e-6), ANGLE),
    Bound("stand.sigma_count_time_s", Interval(0, 1000, "s", 1e-18), "a quarter of an hour; no clock is better"),
    Bound("mounting", COMPONENT, "the elements of a rotation; their size is checked more closely"),
    Bound("sensors[].nominal_axis", COMPONENT, "components of a unit vector; its length is checked more closely"),
    Bound(
        "sensors[].nominal_scale",
        Interval(1e-12, 1e18),
        "from a picovolt per m/s² to a count of 64 bits; pulse gyros have up to 1e12 per rad",
    ),
    Bound("sensors[].nominal_offset", Interval(-1e20, 1e20), "half the range of a count of 64 bits is 1e19"),
    Bound(
        "sensors[].bias_repeatability_m_s2",
        Interval(0, 100, "m/s²", 1e-15),
        "ten g; a superconducting gravimeter has 1e-11",
    ),
    Bound(
        "sensors[].bias_repeatability_rad_s",
        Interval(0, 100, "rad/s", 1e-18),
        "16 turns a second; the largest ring lasers have 1e-13",
    ),
    Bound("sensors[].position_m", Interval(-100, 100, "m"), "no block is larger, nor measured from farther away"),
    Bound(
        "time_since_power_on_s",
        Interval(0, 1.6e7, "s"),
        "half a year: what is on for longer has settled, and its power-on is a slip",
    ),
    Bound("count_time_s", Interval(1e-9, 1e6, "s"), "from a nanosecond to twelve days"),
    Bound("sample_rate_hz", Interval(1e-6, 1e9, "Hz"), "from a sample in twelve days to a gigahertz"),
    Bound("direction_sigma_deg", Interval(1e-9, 180, "degrees"), "more than half a turn states nothing"),
    Bound("<sensor>", Interval(-1e20, 1e20), "a count of 64 bits has 2e19"),
    Bound("<sensor>_se", Interval(1e-24, 1e20), "a picovolt per m/s² times the best resolution known"),
    Bound("beta_deg", Interval(-720, 720, "degrees"), "two turns of the head either way; 999 is a slip, not 279"),
    Bound("time_s", Interval(-1e12, 1e12, "s"), "seconds, or what a clock in milliseconds since 1970 said until 2001"),
    Bound("temperature_c", Interval(-100, 200, "°C"), "where electronics work"),
    Bound("vibration_m_s2", Interval(0, 1e4, "m/s²"), "a thousand g"),
    Bound("tilt_se_deg", Interval(0, 10, "degrees"), "a block that tilts by more is not at rest"),
    Bound("turn_angle_deg", Interval(-3.6e7, 3.6e7, "degrees"), "a hundred thousand turns"),
    Bound("turn_rate_deg_s", Interval(-36_000, 36_000, "deg/s"), "a hundred turns a second"),
    Bound("position", Interval(-1, 1e9), "the number of a position; −1 where a row belongs to none"),
    Bound("direction_x…z", Interval(-1e6, 1e6), "components of a direction in any unit; its length is checked"),
)
"""Every number of the contract; ``stand.sigma_arcsec`` means each that it holds."""
WITHIN = {bound.field: bound.within for bound in BOUNDS}
"""Field → the numbers that it may hold."""
