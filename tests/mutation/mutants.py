"""Applies rules that make small changes to C++ source. A test should detect each change.

Each rule lists the changes that it can make: other operators and constants, removed statements, swapped branches.
`all_of` omits the changes that no test at run time can detect, see LEFT_ALONE and MEMBER. The rules for operators and
constants divide the source into tokens, and skip comments, preprocessor lines, strings and character literals.
"""

import dataclasses
import random
import re

TOKEN = re.compile(
    r"""
    (?P<skip>^[ \t]*\#[^\n]*|\n|[^\S\n]+|//[^\n]*|/\*.*?\*/|R"\(.*?\)"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+')
    |(?P<number>0[xX][0-9a-fA-F']+[uUlL]*|0b[01']+[uU]*|\d[\d']*[uUlL]*)
    |(?P<word>[A-Za-z_]\w*)
    |(?P<operator>->\*?|<<=|>>=|\+\+|--|&&|\|\||[-+*/%&|^=!<>]=|<<|>>|::|[-+*/%&|^=!<>~?:;,.(){}\[\]])
    """,
    re.VERBOSE | re.MULTILINE | re.DOTALL,
)

# The replacement of each operator. The operators in BETWEEN_OPERANDS are replaced only between spaces, or
# between a space and the end of the line.
OPERATORS = {
    "==": "!=",
    "!=": "==",
    "<=": "<",
    ">=": ">",
    "<": "<=",
    ">": ">=",
    "&&": "||",
    "||": "&&",
    "+": "-",
    "-": "+",
    "*": "+",
    "/": "*",
    "%": "/",
    "&": "|",
    "|": "&",
    "^": "|",
    "<<": ">>",
    ">>": "<<",
    "++": "--",
    "--": "++",
    "+=": "-=",
    "-=": "+=",
    "|=": "&=",
    "&=": "|=",
    "^=": "|=",
}
# Most of these operators can also be unary or part of a type. clang-format puts a space before a binary operator, and a
# space or the end of the line after it. It does not do this for the other uses.
BETWEEN_OPERANDS = {"<", ">", "+", "-", "*", "/", "%", "&", "|", "^", "<<", ">>", "&&"}

STATEMENT = re.compile(r"^[ ]+(?P<statement>[a-z_][\w.>\[\]:+\- ]*(?:\(.*\)| [-+|&^]?= .*|\+\+|--);)$", re.MULTILINE)
NO_STATEMENT = re.compile(
    r"return|static_assert|using|constexpr|const |auto |case |default|break|continue|else|typedef|friend|explicit"
    r"|virtual|delete|struct|class|enum|namespace|template|(?:[a-z]\w*::)*[A-Za-z]\w*[*&]? \w+(?: =|\(|;|{)"
)
# A static_assert, and a fence of the compiler.
LEFT_ALONE = re.compile(r"static_assert\(.*?\);|std::atomic_signal_fence\(.*?\);", re.DOTALL)
# The initial value of a member: nearly all members get the first value that is used later.
MEMBER = re.compile(
    r"^  (?!static|constexpr|const|return)[\w:]+(?:<[^;=\n]*>)? \w+(?: = |\{)(?:-?\d+U?|true|false)\}?;", re.MULTILINE
)
CONDITION = re.compile(r"\bif \((?!constexpr)(?P<condition>.*)\) \{$", re.MULTILINE)


@dataclasses.dataclass(frozen=True)
class Mutant:
    file: str
    begin: int
    end: int
    text: str
    rule: str

    def of(self, source):
        return source[: self.begin] + self.text + source[self.end :]

    def describe(self, source):
        line = source.count("\n", 0, self.begin) + 1
        start = source.rfind("\n", 0, self.begin) + 1
        stop = source.find("\n", self.begin)
        was = source[start:stop].strip()
        now = self.of(source)
        becomes = now[start : now.find("\n", self.begin + len(self.text) - self.text.count("\n"))].strip()
        return f"{self.file}:{line}: {self.rule}: {was}  -->  {becomes}"


def tokens(source):
    at = 0
    while at < len(source):
        found = TOKEN.match(source, at)
        if found is None:
            at += 1
            continue
        at = found.end()
        if found.lastgroup != "skip":
            yield found


def left_alone(file, source):
    found = [*LEFT_ALONE.finditer(source), *(MEMBER.finditer(source) if file.endswith(".hpp") else [])]
    return [each.span() for each in found]


def of_operators(file, source):
    for token in tokens(source):
        text = token.group()
        if token.lastgroup != "operator" or text not in OPERATORS:
            continue
        spaced = source[token.start() - 1] == " " and source[token.end()] in " \n"
        if text in BETWEEN_OPERANDS and not spaced:
            continue
        yield Mutant(file, token.start(), token.end(), OPERATORS[text], "operator")


def of_constants(file, source):
    for token in tokens(source):
        text = token.group()
        if token.lastgroup == "word" and text in ("true", "false"):
            yield Mutant(file, token.start(), token.end(), "false" if text == "true" else "true", "constant")
        if token.lastgroup != "number":
            continue
        digits = re.match(r"0[xX][0-9a-fA-F']+|0b[01']+|[\d']+", text).group()
        suffix = text[len(digits) :]
        plain = digits.replace("'", "")
        value = int(plain, 8 if re.fullmatch(r"0\d+", plain) else 0)
        yield Mutant(file, token.start(), token.end(), f"{value + 1}{suffix}", "constant")
        if value > 0:
            yield Mutant(file, token.start(), token.end(), f"{value - 1}{suffix}", "constant")


def of_statements(file, source):
    for found in STATEMENT.finditer(source):
        statement = found["statement"]
        if not NO_STATEMENT.match(statement):
            begin = found.start("statement")
            yield Mutant(file, begin, begin + len(statement), ";", "removed statement")


def of_branches(file, source):
    for found in CONDITION.finditer(source):
        if ";" in found["condition"]:
            continue
        begin, end = found.span("condition")
        yield Mutant(file, begin, end, f"!({found['condition']})", "swapped branches")


def all_of(file, source):
    kept = left_alone(file, source)
    for rule in (of_operators, of_constants, of_statements, of_branches):
        for mutant in rule(file, source):
            if not any(begin <= mutant.begin < end for begin, end in kept):
                yield mutant


def spread(sources, seed):
    """Yields all mutants of `sources` ({file: source}): one mutant of each file, then another one of each file, and so
    on. The order depends on `seed`."""
    chance = random.Random(seed)
    heaps = []
    for file, source in sorted(sources.items()):
        # Takes one mutant of each rule, then another one of each rule, and so on. Otherwise, most mutants would be
        # changed constants, which rarely reveal a missing test.
        of_rules = {}
        for mutant in all_of(file, source):
            of_rules.setdefault(mutant.rule, []).append(mutant)
        for mutants in of_rules.values():
            chance.shuffle(mutants)
        heap = []
        while any(of_rules.values()):
            heap += [mutants.pop() for mutants in of_rules.values() if mutants]
        heaps.append(heap[::-1])
    chance.shuffle(heaps)
    while any(heaps):
        for heap in heaps:
            if heap:
                yield heap.pop()
