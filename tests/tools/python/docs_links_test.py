"""Every page is found from the manual's index, and every link leads to a file that is there."""

import re
import unittest

from run_log import REPOSITORY

LINK = re.compile(r"\[[^\]]*\]\(([^)#\s]+)(#[^)\s]*)?\)")


def links(page):
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    for target, _ in LINK.findall(text):
        if "://" not in target and not target.startswith("mailto:"):
            yield (page.parent / target).resolve()


class DocsLinksTest(unittest.TestCase):
    def setUp(self):
        self.pages = sorted((REPOSITORY / "docs").rglob("*.md"))
        self.entrances = [REPOSITORY / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")]

    def test_every_link_leads_somewhere(self):
        for page in [*self.entrances, *self.pages]:
            for target in links(page):
                self.assertTrue(target.exists(), f"{page}: {target}")

    def test_every_page_is_reached_from_the_index(self):
        reached, open_pages = set(), [REPOSITORY / "docs" / "README.md"]
        while open_pages:
            page = open_pages.pop()
            if page in reached or page.suffix != ".md" or not page.exists():
                continue
            reached.add(page)
            open_pages += [target / "README.md" if target.is_dir() else target for target in links(page)]
        self.assertEqual([str(page) for page in self.pages if page.resolve() not in reached], [])

    def test_the_readme_is_short(self):
        self.assertLessEqual(len((REPOSITORY / "README.md").read_text(encoding="utf-8").splitlines()), 150)


if __name__ == "__main__":
    unittest.main()
