"""The form of the C++ sources (tools/format), and slips that clang-tidy finds. It takes seconds a file where a header is large,
so that the suite looks at the two rooms that everything stands on; tools/tidy looks at all of them."""

import ast
import re
import runpy
import subprocess
import tempfile
import unittest
from pathlib import Path

import yaml

from run_log import REPOSITORY
from sanitizer import ENVIRONMENT_OF_OTHERS

ROOMS = ("common", "controller", "diagnosis", "examples", "msgs", "sim", "tools")
MOST_LINES = 100  # of a function, its name and arguments left out


class FormatTest(unittest.TestCase):
    def test_the_sources_have_their_form(self):
        ended = subprocess.run([REPOSITORY / "tools" / "format", "--check"], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=300, env=ENVIRONMENT_OF_OTHERS)
        self.assertEqual((ended.returncode, ended.stdout + ended.stderr), (0, ""))

    def test_spaces_change_within_a_line_and_nothing_else_does(self):
        merged = runpy.run_path(str(REPOSITORY / "tools" / "format"))["merged"]
        text = b"int  a=1; // one\nint b = f(1,\n  2);   \nint table[]{10,   2};\n"
        # As clang-format tells it: (offset, length, blanks).
        replacements = [(3, 2, b" "), (6, 0, b" "), (7, 0, b" "), (9, 1, b"  "), (29, 3, b" "), (55, 3, b" ")]
        self.assertEqual(merged(text, replacements), b"int  a = 1;  // one\nint b = f(1,\n  2);\nint table[]{10,   2};\n")


def long_blocks(text):
    """Where blocks of braces begin that have more than MOST_LINES and are no scope of names. A block's end stands as far from the
    margin as the statement that opens it."""
    lines, found = text.splitlines(), []
    for opening, line in enumerate(lines):
        if not line.endswith("{"):
            continue
        first = opening
        while first > 0 and re.search(r"[^;{}>:\s]$", lines[first - 1]) and not lines[first - 1].lstrip().startswith(("//", "#")):
            first -= 1
        if re.match(r"\s*(export )?(namespace|extern|class|struct|union|enum)\b", lines[first]):
            continue
        end = re.compile(" {0,%d}}" % (len(lines[first]) - len(lines[first].lstrip())))
        last = next((i for i in range(opening + 1, len(lines)) if end.match(lines[i])), opening)
        if last - opening - 1 > MOST_LINES:
            found.append(first + 1)
    return found


def long_functions(path):
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        return long_blocks(text)
    return [node.lineno for node in ast.walk(ast.parse(text))
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) and node.end_lineno - node.lineno > MOST_LINES]


class LengthTest(unittest.TestCase):
    def test_a_block_that_is_too_long_is_noticed(self):
        body = "  f();\n" * (MOST_LINES + 1)
        self.assertEqual(long_blocks("int g() { return 1; }\nvoid h() {\n" + body + "}\n"), [2])
        self.assertEqual(long_blocks("int h(int a,\n      int b) {\n" + body + "}\n"), [1])
        self.assertEqual(long_blocks("namespace a {\n" + body + "}\nvoid h() {\n" + body[7:] + "}\n"), [])

    def test_no_function_is_long(self):
        sources = [path for room in ROOMS for path in sorted((REPOSITORY / room).rglob("*"))
                   if path.suffix in (".h", ".cpp", ".c", ".py", ".js") and not {"vendor", "fmi"} & set(path.parts)]
        self.assertGreater(len(sources), 300)
        self.assertEqual([f"{path.relative_to(REPOSITORY)}:{line}" for path in sources for line in long_functions(path)], [])


def defined_types(text):
    """Names of the classes, structures and enumerations that a source defines for every other one to see: those of a scope without a name are its own."""
    scopes, names = [], []
    for line in text.splitlines():
        if scope := re.match(r"namespace\b(.*)\{", line):
            scopes.append(scope[1].strip())
        elif re.match(r"\}\s*// namespace", line):
            scopes.pop()
        elif (kind := re.match(r"(?:struct|class|enum class) (?:alignas\([^)]*\) )?(\w+)(?!\w|::)[^;]*\{", line)) and all(scopes):
            names.append("::".join([*scopes, kind[1]]))
    return names


class DefinitionTest(unittest.TestCase):
    """Two types of one name and scope are one to the linker: where one of them has a destructor, it ends objects of the other."""

    def test_what_a_source_has_to_itself_is_no_definition_for_others(self):
        scope = "namespace a::b {{\nnamespace {{\nstruct C {{\n}};\n}}  // namespace\n{}}}  // namespace a::b\n"
        self.assertEqual(defined_types(scope.format("")), [])
        self.assertEqual(defined_types(scope.format("class C;\nstruct D::E {\n};\n")), [])
        self.assertEqual(defined_types(scope.format("class C : public D {\n};\nenum class F { g };\n")), ["a::b::C", "a::b::F"])

    def test_no_name_is_defined_twice(self):
        def definitions(room):
            for path in sorted((REPOSITORY / room).rglob("*")):
                if path.suffix in (".h", ".cpp"):
                    yield from ((name, str(path.relative_to(REPOSITORY))) for name in defined_types(path.read_text(encoding="utf-8")))

        where = {}
        for name, file in (each for room in ROOMS for each in definitions(room)):
            where.setdefault(name, []).append(file)
        for name, file in definitions("tests"):  # which are programs of their own, with one library or another
            if name in where:
                where[name].append(file)
        self.assertGreater(len(where), 500)
        self.assertEqual({name: files for name, files in where.items() if len(files) > 1}, {})


class TidyTest(unittest.TestCase):
    def run_tidy(self, *words, timeout=60):
        return subprocess.run([REPOSITORY / "tools" / "tidy", *words], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=timeout, env=ENVIRONMENT_OF_OTHERS)

    def test_clang_tidy_finds_no_slip(self):
        ended = self.run_tidy("-j", "1", "common", "controller", timeout=550)  # another test runs beside
        self.assertEqual((ended.returncode, ended.stdout), (0, ""), ended.stderr[-2000:])
        self.assertRegex(ended.stderr, r"(\d\d)/\1 \S+, 0 found\n$")

    def test_words_that_name_no_source_are_refused(self):
        for words, said in ((["nowhere"], "tidy: nowhere: there is no such file or folder; expected a room"),
                            (["common/unit.h"], "tidy: common/unit.h: a header is looked at with the sources that include it"),
                            (["README.md"], "tidy: README.md: no C or C++ source of the project"),
                            (["-j", "0"], "tidy: -j: found '0', expected how many files"),
                            (["--fix"], "tidy: usage: tools/tidy")):
            ended = self.run_tidy(*words)
            self.assertEqual((ended.returncode, ended.stdout), (2, ""))
            self.assertIn(said, ended.stderr)

    def test_a_slip_is_told_with_its_place(self):
        tidy = runpy.run_path(str(REPOSITORY / "tools" / "tidy"))
        tidy["configure"]()
        with tempfile.TemporaryDirectory(dir=tidy["BUILD"]) as folder:  # below .clang-tidy
            source = Path(folder) / "slips.cpp"
            source.write_text("int* none() { return 0; }\nint half(int a) { return a - a; }\n", encoding="utf-8")
            found = tidy["Tidier"]().look(source)
        self.assertEqual([finding.split("\n")[0].rsplit(" [")[1].split(",")[0] for finding in found], ["modernize-use-nullptr", "misc-redundant-expression"])
        self.assertTrue(found[1].startswith(f"{source}:2:28: error: "), found[1])


class HostedTest(unittest.TestCase):
    def test_a_hosted_ci_calls_scripts_that_are_there(self):
        jobs = yaml.safe_load((REPOSITORY / ".github" / "workflows" / "test.yml").read_text(encoding="utf-8"))["jobs"]
        called = {step["run"].split()[0] for job in jobs.values() for step in job["steps"] if step.get("run", "").startswith("tools/")}
        self.assertLessEqual({"tools/test", "tools/sanitize", "tools/tidy", "tools/compare-compilers", "tools/docs", "tools/wheel"}, called)
        self.assertEqual([script for script in called if not (REPOSITORY / script).is_file()], [])


if __name__ == "__main__":
    unittest.main()
