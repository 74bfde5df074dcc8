"""The manual as a site: it is made without a warning, so that no link or anchor leads nowhere; every page, every name of the
Python package and every header is in it; its search knows them; a page loads nothing from a network."""

import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from run_log import REPOSITORY

sys.path.insert(0, str(REPOSITORY / "tools" / "site"))
import build_site  # noqa: E402
import cpp_reference  # noqa: E402

HEADER = '''// How far it is.
// In a straight line.
#pragma once

#include <vector>

namespace slewlab::sim {

// [m] along `axis`; "}" is no bracket.
inline constexpr const char* kEnd = "}";

// Never called.

struct Way {
  double length = 0.0;  // [m]
  double twice() const { return 2.0 * length; }
};

// Sum of lengths [m].
// Throws where there is none.
double sum(const std::vector<Way>& ways,
           double from = 0.0);
double sum(double one, double other);

enum { first, second };

}  // namespace slewlab::sim
'''


class CppReferenceTest(unittest.TestCase):
    def read(self, text):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "way.h"
            path.write_text(text)
            return cpp_reference.read_header(path)

    def test_names_comments_and_declarations_are_those_of_the_header(self):
        header = self.read(HEADER)
        self.assertEqual(header.about, "How far it is.\nIn a straight line.")
        self.assertEqual([d.name for d in header.declarations], ["kEnd", "Way", "sum", "sum", "first"])
        self.assertEqual([d.comment for d in header.declarations],
                         ['[m] along `axis`; "}" is no bracket.', "", "Sum of lengths [m].\nThrows where there is none.", "", ""])
        self.assertTrue(header.declarations[1].code.endswith("length; }\n};"))
        self.assertIn("double from = 0.0);", header.declarations[2].code)
        self.assertEqual(cpp_reference.as_text("[m] along `an_axis` a*b"), r"\[m\] along `an_axis` a\*b")

    def test_a_declaration_without_an_end_is_told_with_its_line(self):
        with self.assertRaisesRegex(cpp_reference.HeaderNotUnderstood, r"way.h:3: .*expected that of the declaration of line 2"):
            self.read("#pragma once\nstruct Way {\n  int a;\n")


class SiteTest(unittest.TestCase):
    def test_the_index_has_to_have_the_four_kinds(self):
        with self.assertRaisesRegex(build_site.SiteFailed, "no heading 'How to', expected the four kinds"):
            build_site.index_page("# The manual\n\n## Tutorials\n\n[first](first.md)\n")

    def test_it_is_whole_and_stands_alone(self):
        with tempfile.TemporaryDirectory() as folder:
            site = Path(folder) / "site"
            made = subprocess.run([sys.executable, REPOSITORY / "tools" / "site" / "build_site.py", "--out", site, "--work", Path(folder) / "work",
                                   "--python", os.environ["SLEWLAB_PYTHON_MESSAGES"]],
                                  stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=550)
            self.assertEqual(made.returncode, 0, made.stdout + made.stderr)  # Sphinx warns of every link that leads nowhere
            for page in (REPOSITORY / "docs").rglob("*.md"):
                self.assertTrue((site / page.relative_to(REPOSITORY / "docs")).with_suffix(".html").is_file(), page)
            python = (site / "api" / "python.html").read_text(encoding="utf-8")
            for name in build_site.exported_names():
                self.assertTrue(name.startswith("_") or f'id="slewlab.{name}"' in python, name)
            library = "".join(page.read_text(encoding="utf-8") for page in (site / "api" / "cpp").glob("*.html"))
            for headers in build_site.rooms().values():
                for header in headers:
                    self.assertTrue(str(header.relative_to(REPOSITORY)) in library, header)
            index = (site / "searchindex.js").read_text(encoding="utf-8")
            self.assertEqual([word for word in ("sidelead", "bristl", "run_closed_loop", "state_spac") if word not in index], [])
            for page in site.rglob("*.html"):
                text = page.read_text(encoding="utf-8")
                loaded = re.findall(r'<(?:script|img|link)\b[^>]*?(?:src|href)="(https?:[^"]*|//[^"]*)"', text)
                self.assertEqual(loaded, [], page)


if __name__ == "__main__":
    unittest.main()
