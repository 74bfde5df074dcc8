"""The reference of the C++ library, made from its headers: per header what its opening comment says, and per declaration
its name, the comment above it and the declaration itself, whose members carry their own comments with units.

No parser of C++: headers are as clang-format leaves them, so that a declaration of a namespace begins at the line's first
character and ends where its brackets are closed.
"""

import re
from dataclasses import dataclass, field

NAME = (
    re.compile(r"^(?:template <.*?>\s*)?(?:struct|class|enum class|enum|concept)\s+(\w+)"),
    re.compile(r"^(?:template <.*?>\s*)?using (\w+) ="),
    re.compile(r"^enum[^{]*\{\s*(\w+)"),
    re.compile(r"(operator\S+?)\("),
    re.compile(r"(\w+)\("),
    re.compile(r"(\w+)(?:\[[^\]]*\])*(?: =|;|\{)"),
)


class HeaderNotUnderstood(Exception):
    """A declaration without a name, or one that does not end; with file and line."""


@dataclass
class Declaration:
    name: str
    comment: str
    code: str


@dataclass
class Header:
    about: str
    declarations: list = field(default_factory=list)


def without_comments_and_texts(line):
    return re.sub(r'//.*$', "", re.sub(r"""(?<!\d)'(?:\\.|[^'\\])'""", "''", re.sub(r'"(?:\\.|[^"\\])*"', '""', line)))


def name_of(code, where):
    bare = " ".join(" ".join(without_comments_and_texts(line) for line in code).split())
    bare = re.sub(r"\[\[\w+\]\]\s*", "", bare)
    for pattern in NAME:
        found = pattern.search(bare)
        if found:
            return found.group(1)
    raise HeaderNotUnderstood(f"{where}: found '{code[0]}', expected a declaration with a name")


def read_header(path):
    header, comment, code, depth, begun = Header(""), [], [], 0, 0
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        where = f"{path}:{number}"
        if code:
            code.append(line)
        elif line.startswith("//"):
            comment.append(line[2:].removeprefix(" "))
            continue
        elif line.startswith("#pragma once"):
            header.about, comment = "\n".join(comment), []
            continue
        elif not line.strip() or line.startswith(("#", "namespace", "}", "inline namespace", 'extern "C"')):
            comment = []
            continue
        else:
            code, depth, begun = [line], 0, number
        bare = without_comments_and_texts(line)
        depth += sum(bare.count(each) for each in "({[") - sum(bare.count(each) for each in ")}]")
        if depth == 0 and bare.rstrip().endswith((";", "}")):
            header.declarations.append(Declaration(name_of(code, f"{path}:{begun}"), "\n".join(comment), "\n".join(code)))
            comment, code = [], []
    if code:
        raise HeaderNotUnderstood(f"{where}: found the end of the file, expected that of the declaration of line {begun}")
    return header


def as_text(comment):
    """A comment as Markdown that says just what it says; what is indented or a table keeps its lines."""
    pieces = []
    for paragraph in re.split(r"\n\s*\n", comment):
        lines = paragraph.split("\n")
        if any(line.startswith("  ") or re.match(r"\s*[-*|] ", line) for line in lines):
            pieces.append("```none\n" + paragraph + "\n```")
        else:
            words = re.split(r"(`[^`]*`)", paragraph)  # what a comment quotes stays quoted
            pieces.append("".join(word if i % 2 else re.sub(r"([\\`*_{}\[\]<>#|~$^])", r"\\\1", word) for i, word in enumerate(words)))
    return "\n\n".join(pieces)


def room_page(title, headers, root):
    """One page for a folder's headers. Overloads stand under one name. Names are no headings: each heading is copied into the
    table of contents of every page, and there are two thousand."""
    lines = [f"# {title}", ""]
    for path in headers:
        header = read_header(path)
        lines += [f"## `{path.relative_to(root)}`", "", as_text(header.about), ""]
        last = None
        for declaration in header.declarations:
            if declaration.name != last:
                lines += [f"```{{rubric}} {declaration.name}\n```", ""]
            last = declaration.name
            if declaration.comment:
                lines += [as_text(declaration.comment), ""]
            lines += ["```cpp", declaration.code, "```", ""]
    return "\n".join(lines)
