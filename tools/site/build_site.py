"""The manual as a site: `tools/docs`. docs/*.md stay what they are; a copy is laid out for Sphinx, with the notebooks as
pages and with the reference of the Python package (from its docstrings) and of the C++ headers (from their comments).
The site needs no network: its search runs in the browser, over file:// as well.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from cpp_reference import HeaderNotUnderstood, room_page

REPOSITORY = Path(__file__).resolve().parents[2]
DOCS = REPOSITORY / "docs"
ROOMS = ("common", "msgs", "controller", "sim", "diagnosis")  # those of the installed library
LINK = re.compile(r"(?<!\!)\[([^\]]*)\]\(([^)#\s]+)(#[^)\s]*)?\)")
FENCE = re.compile(r"^(```|~~~).*?^\1", re.DOTALL | re.MULTILINE)

# Pages that stand outside docs/, under their names in the site.
OTHER_PAGES = {"README.md": "overview.md", "CHANGELOG.md": "changelog.md", "CONTRIBUTING.md": "contributing.md"}
# The index's headings, in its order, and what the site adds to them.
KINDS = {"Tutorials": [], "How to": [], "Reference": ["api/python.md", "api/cpp.md"], "Explanation": []}
ASIDE = ["overview.md", "benchmarks.md", "history/diagnosis.md", "history/robustness.md", "history/step.md", "changelog.md", "contributing.md"]


class SiteFailed(Exception):
    """What could not be made, in words."""


def place_in_site(target):
    """Where a file of the repository stands in the site; None for what has no page there."""
    relative = target.relative_to(REPOSITORY)
    if str(relative) in OTHER_PAGES:
        return Path(OTHER_PAGES[str(relative)])
    if target.suffix == ".ipynb":
        return Path("tutorials") / f"{target.stem}.md"
    if target.is_dir() and (target / "README.md").exists():
        return place_in_site(target / "README.md")
    if target == REPOSITORY / "examples" / "notebooks":
        return Path("README.md")
    return relative.relative_to("docs") if relative.is_relative_to("docs") and target.is_file() else None


def with_links_of_the_site(text, page):
    """The text of `page` with links as they are in the site. What has no page there is named, with its place in the tree."""
    here = place_in_site(page).parent

    def changed(match):
        words, address, anchor = match.group(1), match.group(2), match.group(3) or ""
        if "://" in address or address.startswith("mailto:"):
            return match.group(0)
        target = (page.parent / address).resolve()
        place = place_in_site(target)
        if place is None:
            name = str(target.relative_to(REPOSITORY))
            return f"`{name}`" if words.strip("`") == name else f"{words} (`{name}`)"
        return f"[{words}]({os.path.relpath(place, here)}{anchor})"

    pieces, end = [], 0
    for fence in FENCE.finditer(text):
        pieces += [LINK.sub(changed, text[end:fence.start()]), fence.group(0)]
        end = fence.end()
    text = "".join([*pieces, LINK.sub(changed, text[end:])])
    text = text.replace("```mermaid", "```none")  # a diagram in words; drawn where a viewer knows the language
    return re.sub(r"(!\[[^\]]*\]\()docs/", r"\1", text) if page.parent == REPOSITORY else text


def notebook_page(notebook):
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    pieces = []
    for cell in cells:
        text = "".join(cell["source"]).strip()
        pieces.append(text if cell["cell_type"] == "markdown" else f"```python\n{text}\n```")
    return "\n\n".join(pieces) + "\n"


def sections(index):
    """{heading: [page, ...]} of the index's lists, in the order of its links."""
    found = {}
    for heading, text in re.findall(r"^## (.+?)\n(.*?)(?=^## |\Z)", index, re.DOTALL | re.MULTILINE):
        pages = [address for _, address, _ in LINK.findall(text) if address.endswith(".md")]
        found[heading] = list(dict.fromkeys(pages))
    return found


def toctree(caption, pages):
    return "\n".join(["", "```{toctree}", ":hidden:", ":titlesonly:", f":caption: {caption}", "", *pages, "```", ""])


def index_page(text):
    """The index with the site's table of contents: the four kinds, each with its pages, every page once."""
    by_heading, placed, trees = sections(text), set(ASIDE), []
    for kind, more in KINDS.items():
        if kind not in by_heading:
            raise SiteFailed(f"docs/README.md: found no heading '{kind}', expected the four kinds {', '.join(KINDS)}")
        pages = [page for page in by_heading[kind] + more if page not in placed]
        placed.update(pages)
        trees.append(toctree(kind, pages))
    return text + "".join(trees) + toctree("Beside the manual", ASIDE)


def python_reference(names):
    return "\n".join(["# The Python package", "", "Made from the package's own docstrings; how to use it is in [python.md](../python.md).",
                      "", "```{eval-rst}", ".. automodule:: slewlab", "   :no-members:", "",
                      *(f".. autodata:: slewlab.{name}\n" if name == "Controller" else
                        f".. autoclass:: slewlab.{name}\n   :members:\n   :undoc-members:\n" if name[0].isupper() else
                        f".. autofunction:: slewlab.{name}\n" for name in names if not name.startswith("_")), "```", ""])


def rooms():
    """{folder: its headers} of the library."""
    found = {}
    for room in ROOMS:
        for header in sorted((REPOSITORY / room).rglob("*.h")):
            found.setdefault(header.parent.relative_to(REPOSITORY), []).append(header)
    return found


def lay_out(source):
    """docs/ and what belongs to it, as Sphinx takes it."""
    for page in sorted(DOCS.rglob("*")):
        place = source / page.relative_to(DOCS)
        if page.is_dir():
            place.mkdir(parents=True, exist_ok=True)
        elif page.suffix == ".md":
            text = with_links_of_the_site(page.read_text(encoding="utf-8"), page)
            place.write_text(index_page(text) if page == DOCS / "README.md" else text, encoding="utf-8")
        else:
            shutil.copy(page, place)
    for name, place in OTHER_PAGES.items():
        (source / place).write_text(with_links_of_the_site((REPOSITORY / name).read_text(encoding="utf-8"), REPOSITORY / name), encoding="utf-8")
    effects = sorted(page.name for page in (DOCS / "effects").glob("*.md") if page.name != "README.md")
    with (source / "effects" / "README.md").open("a", encoding="utf-8") as page:
        page.write(toctree("Effects", effects))
    (source / "tutorials").mkdir()
    for notebook in sorted((REPOSITORY / "examples" / "notebooks").glob("*.ipynb")):
        (source / "tutorials" / f"{notebook.stem}.md").write_text(notebook_page(notebook), encoding="utf-8")

    reference = source / "api"
    (reference / "cpp").mkdir(parents=True)
    (reference / "python.md").write_text(python_reference(exported_names()), encoding="utf-8")
    pages = []
    for folder, headers in rooms().items():
        page = "_".join(folder.parts) + ".md"
        (reference / "cpp" / page).write_text(room_page(f"{folder}/", headers, REPOSITORY), encoding="utf-8")
        pages.append(f"cpp/{page}")
    (reference / "cpp.md").write_text(
        "# The C++ library\n\nA page per folder of headers, made from their comments; where to begin is in [library.md](../library.md).\n\n"
        + "```{toctree}\n:titlesonly:\n\n" + "\n".join(pages) + "\n```\n", encoding="utf-8")


def exported_names():
    text = (REPOSITORY / "tools" / "python" / "package" / "slewlab" / "__init__.py").read_text(encoding="utf-8")
    return re.findall(r'"(\w+)"', re.search(r"__all__ = \[(.*?)\]", text, re.DOTALL).group(1))


def build(work, site, python):
    """The site as a folder; everything that Sphinx warns of fails it."""
    shutil.rmtree(work, ignore_errors=True)
    source = work / "source"
    source.mkdir(parents=True)
    lay_out(source)
    environment = os.environ | {"SLEWLAB_SITE_REPOSITORY": str(REPOSITORY), "SLEWLAB_SITE_PYTHON": str(python)}
    partial = work / "site.partial"
    ended = subprocess.run([sys.executable, "-m", "sphinx", "--quiet", "--fail-on-warning", "-c", REPOSITORY / "tools" / "site",
                            "-d", work / "doctrees", source, partial], env=environment, stdin=subprocess.DEVNULL,
                           capture_output=True, text=True)
    if ended.returncode != 0:
        raise SiteFailed(f"Sphinx found:\n{ended.stdout}{ended.stderr}")
    (partial / "index.html").write_text('<!doctype html><meta charset="utf-8"><title>slewlab</title>'
                                        '<meta http-equiv="refresh" content="0; url=README.html"><a href="README.html">The manual</a>\n', encoding="utf-8")
    shutil.rmtree(site, ignore_errors=True)
    partial.rename(site)


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="tools/docs", description="The manual as a site, with search and the API reference; no network.")
    parser.add_argument("--out", type=Path, default=REPOSITORY / "build" / "site", help="the folder of the site (default: build/site)")
    parser.add_argument("--python", type=Path, default=REPOSITORY / "build" / "release" / "python", help="where the package slewlab was built")
    parser.add_argument("--work", type=Path, default=REPOSITORY / "build" / "site_work", help="a folder for what is made on the way; it is emptied")
    options = parser.parse_args(arguments)
    try:
        build(options.work.resolve(), options.out.resolve(), options.python.resolve())
    except (HeaderNotUnderstood, SiteFailed) as problem:
        print(f"docs: {problem}", file=sys.stderr)
        return 1
    print(f"{options.out}/index.html: the manual; it opens from the disk")
    return 0


if __name__ == "__main__":
    sys.exit(main())
