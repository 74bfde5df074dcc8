"""Draws the record of an acceptance test: record.json of `slewlab accept --record` becomes record.html beside it, for people
and for paper.

    acceptance_record.py RECORD_DIR
"""

import json
import sys
from pathlib import Path

from themed_page import escaped, page, printed, table
from whole_file import growing

STYLE = """
td.words { min-width: 16em; }
.verdict { font-size: 1.15em; font-weight: 600; } .number { white-space: nowrap; }
dl { display: grid; grid-template-columns: max-content minmax(0, 1fr); gap: .2em 1.2em; margin: .4em 0; }
dt { font-weight: 600; } dd { margin: 0; overflow-wrap: anywhere; white-space: pre-line; }
tr:target { outline: 2px solid var(--accent); } section { break-inside: avoid-page; }
.signatures td { height: 3.2em; min-width: 11em; }
@media (max-width: 600px) { dl { grid-template-columns: minmax(0, 1fr); } dd { margin-bottom: .4em; } }
"""
STATES = {"met": "good", "not met": "bad", "not shown": "warn"}
VERDICTS = {"pass": "good", "fail": "bad", "not applicable": "faint"}


def shown(word, classes):
    return f'<span class="{classes[word]}">{escaped(word)}</span>'


def number(value):
    return "" if value is None else f"{value:.4g}"


def anchor(*names):
    return "-".join(names).replace(" ", "_")


def verdict_of(record, test, check):
    for each in record["tests"]:
        if each["name"] == test:
            return next((one["verdict"] for one in each["checks"] if one["name"] == check), "not applicable")
    return "not applicable"


def requirement_rows(record):
    for each in record["requirements"]:
        evidence = "<br>".join(f'<a href="#{anchor(one["test"], one["check"])}">{escaped(one["test"])}, {escaped(one["check"])}</a> '
                               + shown(verdict_of(record, one["test"], one["check"]), VERDICTS) for one in each["shown_by"])
        state = shown(each["state"], STATES) + (", deviation agreed" if each["deviation"] else "")
        why = "".join(f"<div class=small>{escaped(reason)}</div>" for reason in each["reasons"])
        yield [f"<b>{escaped(each['name'])}</b>", f"<td class=words>{escaped(each['text'])}</td>", escaped(each["source"]), evidence, state + why]


def test_section(each):
    rows = []
    for check in each["checks"]:
        measured = f"{number(check['measured'])} {escaped(printed(check['unit']))}" if check["measured"] is not None else ""
        limit = f"{number(check['limit'])} {escaped(printed(check['unit']))}" if check["limit"] is not None else ""
        rows.append(f'<tr id="{anchor(each["name"], check["name"])}"><td>{escaped(check["name"])}</td><td>{shown(check["verdict"], VERDICTS)}</td>'
                    f"<td class=number>{measured}</td><td class=number>{limit}</td>"
                    f"<td class=number>{number(check['time'])}</td><td class=words>{escaped(check['reason'])}</td></tr>")
    heads = "".join(f"<th scope=col>{head}</th>" for head in ("check", "verdict", "measured", "limit", "at [s]", "in words"))
    no_verdict = f"<p class=bad>No verdict: {escaped(each['no_verdict'])}</p>" if each["no_verdict"] else ""
    facts = {"scenario": each["scenario"], "case": each["case"], "configuration": each["configuration_hash"], "log": each["log_digest"],
             "seed": each["seed"], "run's folder": each["folder"], "again": each["command"]}
    return (f'<section><h3 id="{anchor(each["name"])}">{escaped(each["name"])}: {escaped(each["purpose"])}</h3>{facts_list(facts)}{no_verdict}'
            f"<div class=wide><table><thead><tr>{heads}</tr></thead><tbody>{''.join(rows)}</tbody></table></div></section>")


def facts_list(facts):
    return "<dl>" + "".join(f"<dt>{escaped(name)}</dt><dd>{escaped(value)}</dd>" for name, value in facts.items()) + "</dl>"


def tested_files(files):
    if files:
        yield table(["of", "file", "SHA-256"],
                    [[escaped(each["of"]), f"<td class=words>{escaped(each['file'])}", f"<td class=words><code>{escaped(each['sha256'])}</code>"]
                     for each in files])


def draw(record):
    states = [each["state"] for each in record["requirements"]]
    counts = ", ".join(f"{states.count(state)} {state}" for state in STATES if state in states)
    verdict = "accepted" if record["accepted"] else "NOT accepted"
    normal = [each for each in record["tests"] if each["case"] != "failure"]
    failures = [each for each in record["tests"] if each["case"] == "failure"]
    body = [f"<h1>{escaped(record['title'])}</h1>",
            f'<p class="verdict {"good" if record["accepted"] else "bad"}">{verdict}</p><p>{len(states)} requirements: {counts}. '
            f"{len(normal)} runs of normal operation, {len(failures)} of failures.</p>",
            "<h2>1 Object and configuration</h2>",
            facts_list({"system under test": record["system"], "controller": record["controller_command"], "plant": record["plant_command"],
                        "test plan": f"{record['plan']['file']} (digest {record['plan']['digest']})",
                        "limits": f"{record['limits']['file']} (digest {record['limits']['digest']})",
                        "software": record["versions"], "made": record["time"], "made again by": record["command"]}),
            *tested_files(record["files"]),
            "<h2>2 Test plan</h2>",
            table(["test", "purpose", "case", "scenario", "configuration", "seed"],
                  [[f'<a href="#{anchor(each["name"])}">{escaped(each["name"])}</a>', escaped(each["purpose"]), escaped(each["case"]),
                    escaped(each["scenario"]), f"<td class=number><code>{escaped(each['configuration_hash'])}</code>", f"<td class=number>{each['seed']}</td>"]
                   for each in record["tests"]]),
            "<h2>3 Requirements and what shows them</h2>",
            table(["", "requirement", "source", "shown by", "state"], list(requirement_rows(record))),
            "<h2>4 Deviations and findings</h2>"]
    if record["deviations"]:
        body.append(table(["requirement", "agreed deviation", "agreed by"],
                          [[escaped(each["requirement"]), escaped(each["text"]), escaped(each["agreed_by"])] for each in record["deviations"]]))
    else:
        body.append("<p>No deviation was agreed.</p>")
    if record["findings"]:
        body.append("<p class=bad>Checks that failed, and that no requirement names:</p>")
        body.append(table(["test", "check", "in words"], [[escaped(each[key]) for key in ("test", "check", "reason")] for each in record["findings"]]))
    else:
        body.append("<p>No check failed but those that a requirement above names.</p>" if "not met" in states else "<p>No check failed.</p>")
    if record["warnings"]:
        body.append("<p class=warn>To be known:</p><ul>" + "".join(f"<li>{escaped(each)}</li>" for each in record["warnings"]) + "</ul>")
    body.append("<h2>5 Results: normal operation</h2>" + "".join(map(test_section, normal)))
    if failures:
        body.append("<h2>6 Results: failures</h2>" + "".join(map(test_section, failures)))
    body.append("<h2>7 Signatures</h2>")
    body.append("<div class=wide><table class=signatures><thead><tr><th>role</th><th>name</th><th>place and date</th><th>signature</th></tr></thead><tbody>"
                + "".join(f"<tr><td>{role}</td><td></td><td></td><td></td></tr>" for role in ("tested by", "witnessed by")) + "</tbody></table></div>")
    return page(f"{record['title']}: {verdict}", "".join(body), STYLE)


def main(arguments):
    folder = Path(arguments[0])
    try:
        record = json.loads((folder / "record.json").read_text(encoding="utf-8"))
        with growing(folder / "record.html") as partial:
            partial.write_text(draw(record), encoding="utf-8")
    except OSError as error:
        print(error, file=sys.stderr)
        return 1
    print(f"record: {folder / 'record.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
