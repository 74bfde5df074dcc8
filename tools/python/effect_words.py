"""What an effect is in words and where the manual has its page, and which slewlab it is: the command itself is asked."""

import functools
import json
import subprocess

from run_log import REPOSITORY, slewlab_program


def said(*words):
    """By the command; nothing where there is none."""
    try:
        ended = subprocess.run([slewlab_program(), *words], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    except OSError:
        return ""
    return ended.stdout if ended.returncode == 0 else ""


def version():
    """"slewlab 0.2.0"; empty where there is no command to ask."""
    return said("--version").partition("\n")[0].strip()


@functools.cache
def machine_effects():
    """{name: words} of the catalogue."""
    schema = json.loads(said("schema", "crane") or "{}")
    kinds = schema.get("properties", {}).get("effects", {}).get("items", {}).get("anyOf", [])
    return {kind["properties"]["effect"]["const"]: kind["description"] for kind in kinds if "description" in kind}


def manual_page(name):
    """None where the manual is not beside the programs, as in an installation, or has no such page."""
    page = REPOSITORY / "docs" / "effects" / f"{name}.md"
    return page if page.is_file() else None


def words_of(name):
    """"commands get lost on the way to the drives"; of a controller's effect as its page says it; empty where neither is there."""
    if name in machine_effects():
        return machine_effects()[name]
    page = manual_page(name)
    if page is None:
        return ""
    lines = [line for line in page.read_text(encoding="utf-8").splitlines() if line.strip()]
    return lines[1].partition(": ")[2].rstrip(".") if len(lines) > 1 else ""
