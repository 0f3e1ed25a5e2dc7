"""A diagnosis as Markdown, in people's units."""

from collections.abc import Iterable, Iterator, Sequence

from estimator.diagnosis import Finding
from estimator.diagnosis.results import Diagnosis, Gain, Score
from service.diagnosis.words.amplitudes import amplitude_measure
from service.kit.measures import measured, number

NOTHING = "Nothing wrong found."
MOST = 5
"""Sensors of one cause whose amplitudes are listed, the most evident first; the command prints a diagnosis whole."""


def table(head: Sequence[str], body: Iterable[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = [head, ["---"] * len(head), *body]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines)


def summary(diagnosis: Diagnosis) -> str:
    """The answer in one line: names with their sensors, what stays unexplained, and errors stated wrongly."""
    named = [f"`{f.cause}`{many(f)}{doubt(f)}" for f in diagnosis.findings]
    unexplained = [f"unexplained structure in {spoken([s for x in diagnosis.structures for s in x.sensors])}"]
    noise = [f"stated errors of {n.kind}s × {n.factor:.2g}" for n in diagnosis.noise]
    return "; ".join([*named, *(unexplained if diagnosis.structures else []), *noise]) or NOTHING


def many(finding: Finding) -> str:
    """`` (Gx, Gy)``; a count where there are many, and of those that share one course with all that follow it."""
    if finding.shared is not None:
        return f" ({len(finding.sensors) + len(finding.shared.more)} sensors together)"
    different = list(dict.fromkeys(finding.sensors))
    return f" ({spoken(different)})" if different else ""


def spoken(names: Sequence[str]) -> str:
    """A few names, or their number."""
    different = list(dict.fromkeys(names))
    return ", ".join(different) if 0 < len(different) <= 4 else f"{len(different)} sensors" if different else "all"


def doubt(finding: Finding) -> str:
    """The causes that fit as well, in words."""
    return f", or {', '.join(finding.alternatives[:3])}" if finding.alternatives else ""


def amplitudes(finding: Finding) -> Iterator[tuple[str, ...]]:
    """A line a sensor: its amplitudes ± one sigma."""
    places = finding.sensors or ("all",)
    each = len(finding.amplitude) // len(places)
    for k, sensor in enumerate(places):
        part = slice(k * each, (k + 1) * each)
        shown = zip(finding.amplitude[part], finding.sigma[part], finding.units[part], strict=True)
        yield sensor, *(measured(v, s, amplitude_measure(finding.cause, u, max(abs(v), s))) for v, s, u in shown)


def evidence(finding: Finding) -> str:
    """The certainty of a finding, in words."""
    shape = ", ".join(f"{number(v)} {unit}" for unit, v in finding.nonlinear.items())
    fits = f" Fits as well: {', '.join(finding.alternatives)}." if finding.alternatives else ""
    where = f" ({shape}, of {finding.sensors[0]})" if shape and finding.sensors else ""
    chance = "below 1e-12" if finding.p_value < 1e-12 else f"{finding.p_value:.1g}"
    return f"strength {finding.strength:.1f} standard errors, family-wise p {chance}{where}.{fits}"


def finding_section(finding: Finding) -> str:
    """One named cause."""
    rows = list(amplitudes(finding))
    head = ["sensor", *(f"k{k}" for k in range(1, max(len(r) for r in rows)))]
    more = [(f"and {len(rows) - MOST} more", *[""] * (len(head) - 1))] if len(rows) > MOST else []
    amounts = table(head, [*rows[:MOST], *more]) if len(head) > 1 else ""
    return f"**`{finding.cause}`**: {finding.sentence} {evidence(finding)}\n\n{amounts}".strip()


def unexplained(diagnosis: Diagnosis) -> str:
    """The place of structure without a name, in words."""
    lines = [f"* {spoken(s.sensors)}: {s.where}, strength {float(s.strength):.1f}" for s in diagnosis.structures]
    return "Unexplained:\n\n" + "\n".join(lines) if lines else ""


def misjudged(diagnosis: Diagnosis) -> str:
    """The stated errors that the readings contradict, in words."""
    return " ".join(
        f"The stated standard errors of the {n.kind}s would have to be multiplied by {n.factor:.2g}."
        for n in diagnosis.noise
    )


def gain_table(gain: Gain) -> str:
    """Held-out positions before and after."""

    def row(label: str, score: Score) -> tuple[str, ...]:
        return label, f"{1e3 * score.rms:.3f}", f"{score.chi2_per_dof:.2f}", f"{score.log_score:.2f}"

    body = (row("baseline", gain.before), row("with the causes", gain.after))
    return table(("held-out positions", "rms, 1e-3 SI", "χ²/dof", "log score"), body)


def section(diagnosis: Diagnosis) -> str:
    """The words on one session, without its picture."""
    parts = [*(finding_section(f) for f in diagnosis.findings), unexplained(diagnosis), misjudged(diagnosis)]
    said = [p for p in parts if p] or [NOTHING]
    return "\n\n".join([*said, gain_table(diagnosis.gain)])
