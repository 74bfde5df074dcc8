"""Structured Text to C, for the subset of IEC 61131-3 that the example uses, so that the text itself is what the tests run.

    translate.py SOURCE.st FOLDER      writes config.c and LOCATED_VARIABLES.h

The C code has the shape of MatIEC's: config_init__, config_run__, common_ticktime__, __CURRENT_TIME, and a pointer __IL8 for a variable
AT %IL8. This is no compiler: what it does not know it refuses, and types it does not check.
"""

import re
import sys
from pathlib import Path

TOKEN = re.compile(r"""(?P<skip>\s+|\(\*.*?\*\))|(?P<time>T\#\d+ms)|(?P<place>%[IQM][XBWDL]\d+(\.\d+)?)|(?P<number>\d+(\.\d+)?([eE][+-]?\d+)?(?!\.\w))|
    (?P<name>[A-Za-z_]\w*)|(?P<sign>:=|<=|>=|<>|\.\.|[-+*/=<>()\[\],;:.])""", re.VERBOSE | re.DOTALL)
TYPES = ("BOOL", "INT", "DINT", "LINT", "REAL", "LREAL", "TIME")
FUNCTIONS = {"ABS": ("fabs", 1), "SQRT": ("sqrt", 1), "MIN": ("fmin", 2), "MAX": ("fmax", 2), "LIMIT": ("limit_", 3), "LINT_TO_LREAL": ("(LREAL)", 1)}
PRECEDENCE = [("OR",), ("AND",), ("=", "<>"), ("<", ">", "<=", ">="), ("+", "-"), ("*", "/")]
C_SIGNS = {"OR": "||", "AND": "&&", "=": "==", "<>": "!="}
HEAD = """#include "iec_std_lib.h"

static inline LREAL limit_(LREAL lowest, LREAL number, LREAL highest) { return fmax(lowest, fmin(number, highest)); }

"""


class Translation:
    def __init__(self, text):
        self.tokens, at = [], 0
        while at < len(text):
            match = TOKEN.match(text, at)
            if not match:
                raise SystemExit(f"line {text.count(chr(10), 0, at) + 1}: {text[at:at + 20]!r} is not understood")
            if match.lastgroup != "skip":
                self.tokens.append((match.group(), text.count("\n", 0, at) + 1))
            at = match.end()
        self.place = 0
        self.blocks, self.located, self.out = {}, [], []

    def peek(self):
        return self.tokens[self.place][0] if self.place < len(self.tokens) else ""

    def take(self, *expected):
        token = self.peek()
        if expected and token not in expected:
            line = self.tokens[min(self.place, len(self.tokens) - 1)][1]
            raise SystemExit(f"line {line}: found {token!r}, expected {' or '.join(expected)}")
        self.place += 1
        return token

    def taken(self, token):
        if self.peek() != token:
            return False
        self.place += 1
        return True

    def file(self):
        while self.peek() in ("FUNCTION_BLOCK", "PROGRAM"):
            self.unit()
        return self.configuration()

    def unit(self):
        end = "END_" + self.take()
        name = self.take()
        fields, initial, self.variables = [], [], {}
        while self.peek().startswith("VAR"):
            self.take()
            self.taken("CONSTANT")
            while not self.taken("END_VAR"):
                self.variable(fields, initial)
        body = self.statements(end)
        self.take(end)
        self.blocks[name] = True
        lines = [f"typedef struct {{\n{''.join(fields)}}} {name};\n",
                 f"static void {name}_init__({name}* data__) {{\n{''.join(initial)}}}\n", f"static void {name}_body__({name}* data__) {{\n{body}}}\n"]
        self.out.append("\n".join(lines))

    def variable(self, fields, initial):
        name = self.take()
        place = None
        if self.taken("AT"):
            place = self.take()
        self.take(":")
        if self.taken("ARRAY"):
            self.take("[")
            low = self.take("0")
            self.take("..")
            high = self.take()
            self.take("]")
            self.take("OF")
            kind = self.take(*TYPES)
            self.take(":=")
            self.take("[")
            values = [self.expression()]
            while self.taken(","):
                values.append(self.expression())
            self.take("]")
            if len(values) != int(high) - int(low) + 1:
                raise SystemExit(f"{name}: {len(values)} values")
            fields.append(f"  {kind} {name}[{len(values)}];\n")
            initial += [f"  data__->{name}[{i}] = {value};\n" for i, value in enumerate(values)]
        else:
            kind = self.take()
            if kind not in TYPES and kind not in self.blocks and kind != "TON":
                raise SystemExit(f"{name}: the type {kind} is not known")
            value = self.expression() if self.taken(":=") else None
            if place:
                symbol = "__" + place[1:].replace(".", "_")
                area, size, *numbers = place[1], place[2], *re.findall(r"\d+", place)
                self.located.append((kind, symbol, area, size, *numbers))
            elif kind in TYPES:
                fields.append(f"  {kind} {name};\n")
                initial.append(f"  data__->{name} = {value or ('(TIME){0, 0}' if kind == 'TIME' else '0')};\n")
            else:
                fields.append(f"  {kind} {name};\n")
                initial.append(f"  {kind}_init__(&data__->{name});\n")
            self.variables[name] = (kind, f"(*{symbol})" if place else f"data__->{name}")
            self.take(";")
            return
        self.variables[name] = (kind, f"data__->{name}")
        self.take(";")

    def statements(self, *ends):
        lines = []
        while self.peek() not in ends:
            lines.append(self.statement())
        return "".join(lines)

    def statement(self):
        if self.taken("IF"):
            text = f"if ({self.expression()}) {{\n"
            self.take("THEN")
            text += self.statements("ELSIF", "ELSE", "END_IF")
            while self.taken("ELSIF"):
                text += f"}} else if ({self.expression()}) {{\n"
                self.take("THEN")
                text += self.statements("ELSIF", "ELSE", "END_IF")
            if self.taken("ELSE"):
                text += "} else {\n" + self.statements("END_IF")
            self.take("END_IF")
            text += "}\n"
        elif self.taken("FOR"):
            name = self.variables[self.take()][1]
            self.take(":=")
            first = self.expression()
            self.take("TO")
            text = f"for ({name} = {first}; {name} <= {self.expression()}; ++{name}) {{\n"
            self.take("DO")
            text += self.statements("END_FOR") + "}\n"
            self.take("END_FOR")
        elif self.taken("EXIT"):
            text = "break;\n"
        elif self.taken("RETURN"):
            text = "return;\n"
        elif self.tokens[self.place + 1][0] == "(":
            kind, instance = self.variables[self.take()]
            self.take("(")
            text = ""
            while not self.taken(")"):
                name = self.take()
                self.take(":=")
                text += f"{instance}.{name} = {self.expression()};\n"
                self.taken(",")
            text += f"{kind}_body__(&{instance});\n"
        else:
            target = self.primary()
            self.take(":=")
            text = f"{target} = {self.expression()};\n"
        self.take(";")
        return text

    def expression(self, level=0):
        if level == len(PRECEDENCE):
            return self.unary()
        left = self.expression(level + 1)
        while self.peek() in PRECEDENCE[level]:
            sign = self.take()
            left = f"({left} {C_SIGNS.get(sign, sign)} {self.expression(level + 1)})"
        return left

    def unary(self):
        if self.taken("-"):
            return f"(-{self.unary()})"
        if self.taken("NOT"):
            return f"(!{self.unary()})"
        return self.primary()

    def primary(self):
        token = self.take()
        if token == "(":
            inner = self.expression()
            self.take(")")
            return f"({inner})"
        if token in ("TRUE", "FALSE"):
            return "1" if token == "TRUE" else "0"
        if token.startswith("T#"):
            milliseconds = int(token[2:-2])
            return f"((TIME){{{milliseconds // 1000}, {milliseconds % 1000 * 1000000}}})"
        if token[0].isdigit():
            return token
        if token in FUNCTIONS:
            name, count = FUNCTIONS[token]
            self.take("(")
            arguments = [self.expression()]
            while self.taken(","):
                arguments.append(self.expression())
            self.take(")")
            if len(arguments) != count:
                raise SystemExit(f"{token}: {len(arguments)} arguments")
            return f"{name}({', '.join(arguments)})"
        if token not in self.variables:
            raise SystemExit(f"line {self.tokens[self.place - 1][1]}: {token!r} is not declared")
        text = self.variables[token][1]
        if self.taken("["):
            text += f"[{self.expression()}]"
            self.take("]")
        elif self.taken("."):
            text += f".{self.take()}"
        return text

    def configuration(self):
        words = " ".join(token for token, _ in self.tokens[self.place:])
        interval = int(re.search(r"INTERVAL := T#(\d+)ms", words).group(1))
        program = re.search(r"PROGRAM \w+ WITH \w+ : (\w+) ;", words).group(1)
        located = "".join(f"extern {kind} *{symbol};\n" for kind, symbol, *_ in self.located)
        return (HEAD + located + "\n" + "\n".join(self.out) + f"\nstatic {program} program__;\n"
                f"unsigned long long common_ticktime__ = {interval}000000ULL;\n"
                f"void config_init__(void) {{ {program}_init__(&program__); }}\n"
                f"void config_run__(unsigned long tick) {{\n  (void)tick;\n  {program}_body__(&program__);\n}}\n")


def main(source, folder):
    translation = Translation(Path(source).read_text(encoding="utf-8"))
    text = translation.file()
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "config.c").write_text(text, encoding="utf-8")
    (folder / "LOCATED_VARIABLES.h").write_text(
        "".join(f"__LOCATED_VAR({','.join(each)})\n" for each in translation.located), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
