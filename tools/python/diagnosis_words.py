"""What the page of a crane's diagnosis says above its pictures: the answer, what to do next, of what it was made, and the causes as a
table; of diagnosis.json and summary.txt."""

import datetime
import os
import re
from pathlib import Path

from effect_words import manual_page, version, words_of
from themed_page import escaped, printed, table

SHOWN = 0.01  # probability from which a cause stands in the table; the first one does in any case
NOISE_ALONE = 1.1  # largest residual variance ratio of noise alone (diagnosis/fit.h): a share of what parameters leave then is none of the gap
NOTHING = "nothing is missing: the nominal machine, its parameters within their spread"
UNKNOWN = "outside the catalogue (unknown)"
HEADS = ("Cause", "Probability", "Size (90 % interval)", "Share of the gap explained, fitted records", "Validation")
NONE = "-"  # of a cell

STYLE = """
a { color: #0b5cad; }
h1 { font-weight: 600; line-height: 1.35; }
.next { font-size: 1.05em; color: inherit; }
.faint { color: #5d6670; font-size: .9em; }
.causes table { font-size: .88em; }
.causes th, .causes td { padding: .3em 1em .3em 0; vertical-align: top; }
.causes td div + div { margin-top: .15em; }
.causes td:nth-child(2), .causes td:nth-child(4) { white-space: nowrap; }
.causes td span { white-space: nowrap; }
.causes td:nth-child(1) { min-width: 11em; } .causes td:nth-child(3) { min-width: 17em; } .causes td:nth-child(5) { min-width: 17em; }
@media (max-width: 600px) {
  h1 { font-size: 1.15em; }
  .causes thead, .causes .none { display: none; }
  .causes table, .causes tbody, .causes tr, .causes td { display: block; padding: 0; border: 0; }
  .causes td:nth-child(n) { white-space: normal; min-width: 0; }
  .causes tr { border-bottom: 1px solid #e4e4e4; padding: .5em 0; }
  .causes td + td { margin-top: .35em; }
  .causes td + td::before { content: attr(data-head) ": "; font-weight: 600; }
}
@media (prefers-color-scheme: dark) { a { color: #6cb0ff; } .causes tr { border-color: #30363d; } .faint { color: #a3acb5; } }
@media print { a { color: #0b5cad; } .faint { color: #444; } }
"""


def alternatives(cause):
    """Sets of effects, of which these records tell none from another."""
    return [cause["effects"], *cause.get("or", [])]


def cause_name(cause):
    if not cause["effects"]:
        return "only parameters are off"
    return " or ".join(" with ".join(effects) for effects in alternatives(cause))


def number(value):
    """Three significant digits, with an exponent where people would write one; JSON has null for what is no number."""
    if value is None:
        return "-"
    text = f"{value:.3g}"
    mantissa, _, exponent = text.partition("e")
    if not exponent:
        return text
    return f"{float(text):.0f}" if 0 < int(exponent) < 6 else f"{mantissa}e{int(exponent)}"


def with_unit(text, unit):
    return text if unit == "-" else f"{text} {printed(unit)}"


def linked(name):
    page = manual_page(name)
    return f'<a href="{escaped(page.as_uri())}">{escaped(name)}</a>' if page else escaped(name)


class Sentences:
    """Of a diagnosis: names of effects lead to their pages, and the first time say what they are."""

    def __init__(self, found):
        names = set(found.get("effects", {}))
        for cause in found["causes"]:
            names.update(name for effects in alternatives(cause) for name in effects)
            names.update(name for other in cause.get("cannot_be_told_from", []) for name in re.split(" with | or ", other["cause"]))
        names.update(name for one in found.get("unseen", []) for name in re.split(" with | or ", one["cause"]) if name)
        # No part of a path, as a log's may be.
        self.name = re.compile(r"(?<![\w/.-])(?:" + "|".join(sorted(map(re.escape, names), key=len, reverse=True)) + r")(?![\w/-]|\.\w)") if names else None
        self.told = set()

    def html(self, text):
        if self.name is None:
            return escaped(text)
        parts, end = [], 0
        for found in self.name.finditer(text):
            name = found.group()
            words = "" if name in self.told else words_of(name)
            self.told.add(name)
            parts += [escaped(text[end:found.start()]), linked(name), escaped(f" ({words})") if words else ""]
            end = found.end()
        return "".join([*parts, escaped(text[end:])])


def proposals(found, summary):
    """What the summary proposes to do next, a sentence each."""
    said = [f"Next manoeuvre: {line.removeprefix('Next manoeuvre').strip()}" for line in summary.splitlines() if line.startswith("Next manoeuvre ")]
    for apart in found.get("told_apart_by", []):
        said.append(f"What would tell it from {apart['from']}? {apart['advice'][:1].upper()}{apart['advice'][1:]}.")
    return said


def date_text(files):
    """When the newest of the logs was written; empty where one of them is not there. No clock: the same inputs give the same page."""
    try:
        newest = max(os.stat(Path(file) / "run.lcmlog" if os.path.isdir(file) else file).st_mtime for file in files)
    except (OSError, ValueError):
        return ""
    return datetime.datetime.fromtimestamp(newest, datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC")


def origin(found):
    """Of what the answer was made, and by what."""
    fitted, unseen = found.get("logs", []), found.get("unseen_logs", [])
    logs = ", ".join([*fitted, *(f"{name} (not fitted)" for name in unseen)])
    told = [("Logs", logs), ("newest log written", date_text(fitted + unseen)), ("crane", found.get("crane", "")),
            ("controller", found.get("controller", "not given")), ("page by", version())]
    return f'<p class="faint origin">{" · ".join(f"{what}: {escaped(value)}" for what, value in told if value)}</p>'


def lines(texts, faint=False):
    return "".join(f"<div{' class=faint' if faint else ''}>{text}</div>" for text in texts)


def cause_cell(cause, has_gap):
    if not cause["effects"]:
        return cause_name(cause) if has_gap else NOTHING
    sets = alternatives(cause)
    names = list(dict.fromkeys(name for effects in sets for name in effects))
    told = [escaped(f"{name}: {words_of(name)}" if len(names) > 1 else words_of(name)) for name in names if words_of(name)]
    text = " or ".join(" with ".join(map(linked, effects)) for effects in sets)
    remarks = ["indistinguishable in these records"] if len(sets) > 1 else []
    others = [f"{other['cause']} (signature {100 * other['signature_apart']:.1f} % apart)" for other in cause.get("cannot_be_told_from", [])]
    if others:
        remarks.append(escaped(f"these records cannot tell it from {', '.join(others)}"))
    return f"<b>{text}</b>" + lines(told + remarks, faint=True)


def sizes_cell(cause):
    is_one = len(cause["effects"]) == 1 and not cause.get("or")
    told = []
    for size in cause.get("sizes", []):
        name = size["parameter"].removeprefix(f"{cause['effects'][0]}.") if is_one else size["parameter"]
        value = with_unit(number(size["value"]), size["unit"])
        told.append(f"{escaped(name)} <span>{escaped(value)}</span> <span>({number(size['low_90'])} to {number(size['high_90'])})</span>")
    return lines(told) or NONE


def changed(before, after, unit=""):
    return escaped(f"{number(before)} \u2192 {number(after)}" + (f" {printed(unit)}" if unit else ""))


def validation_lines(validation):
    nominal, parameters, cause = (validation[name]["residual_variance_ratio"] for name in ("nominal", "parameters", "cause"))
    verdict = "it holds" if validation["holds"] else "<b>it does not hold</b>"
    return f"{verdict}: residual variance ratio {changed(nominal, cause)} (parameters alone {number(parameters)})"


def validation_cell(found, cause, is_first):
    told = []
    if cause.get("validation"):
        told.append(f"On data that were not fitted {validation_lines(cause['validation'])}")
    for one in found.get("unseen", []):
        if one["cause"] and one["cause"] in (cause_name(cause), *(" with ".join(effects) for effects in alternatives(cause))):
            torque = one["missing_torque_rms_nm"]
            told.append(f"On {escaped(one['log'])}, which had no part in the answer, {validation_lines(one['validation'])}, "
                        f"missing torque {changed(torque['nominal'], torque['cause'], 'Nm')} RMS")
    if is_first and found.get("gaps"):
        told.append(escaped(f"RMS error on {found['gaps_on']}{'' if found['gap'] else ', of the nominal machine'}:"))
        for gap in found["gaps"]:
            error = changed(gap["before"], gap["after"], gap["unit"]) if found["gap"] else escaped(f"{number(gap['before'])} {printed(gap['unit'])}")
            told.append(f"{escaped(gap['signal'])} {error}")
    if not told and not cause["effects"]:
        return NONE
    return lines(told) or "not validated"


def row_of(*cells):
    """Each cell knows its head, for windows in which they stand below each other."""
    return [f"<td{' class=none' if cell == NONE else ''} data-head=\"{head}\">{cell}</td>" for head, cell in zip(HEADS, cells)]


def cause_table(found):
    """The likeliest first, with every size."""
    causes = [cause for place, cause in enumerate(found["causes"]) if place == 0 or cause["probability"] >= SHOWN]
    rows = [(found["probability_unknown"], UNKNOWN, NONE, NONE, NONE)]
    if found.get("probability_hidden", 0.0) >= SHOWN:
        rows.append((found["probability_hidden"], "an effect that is too small for these records", NONE, NONE, NONE))
    for cause in causes:
        is_told = cause["effects"] and "explained_share" in cause and found.get("residual_variance_ratio_parameters", NOISE_ALONE + 1.0) > NOISE_ALONE
        share = f"{100 * cause['explained_share']:.1f} %" if is_told else NONE
        rows.append((cause["probability"], cause_cell(cause, found.get("gap", True)), sizes_cell(cause), share, validation_cell(found, cause, cause is causes[0])))
    rows.sort(key=lambda row: row[0], reverse=True)
    less = "" if len(causes) == len(found["causes"]) else f"<p class=faint>Causes of less than {100 * SHOWN:.0f} % are left out.</p>"
    cells = [row_of(what, f"{100 * probability:.1f} %", *others) for probability, what, *others in rows]
    return f"<div class=causes>{table(HEADS, cells)}</div>{less}"


def head(found, summary, directory):
    """All that stands above the summary."""
    sentences = Sentences(found)
    answer = sentences.html(summary.partition("\n")[0].strip())
    said = [sentences.html(text) for text in proposals(found, summary)]
    if os.path.isfile(os.path.join(directory, "next_manoeuvre.yaml")):
        said = [text.replace("next_manoeuvre.yaml", '<a href="next_manoeuvre.yaml">next_manoeuvre.yaml</a>', 1) for text in said]
    return (f"<h1>{answer}</h1>" + "".join(f"<p class=next>{text}</p>" for text in said) + origin(found) + cause_table(found))
