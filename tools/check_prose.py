#!/usr/bin/python3
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks the text that users read: public headers, help texts and documents.

usage: check_prose.py SOURCE_DIRECTORY

It reports sentences of more than 40 words, doc comments whose first sentence opens with "Of", "What" or "Whether",
tables of more than 15 rows in the guide, lines of documents of more than 100 columns, names of files that do not
exist, and messages in tables that the code does not write. What tools/result_tables.py writes between markers is not
checked.
"""
import argparse
import pathlib
import re
import sys

MOST_WORDS = 40
MOST_COLUMNS = 100
MOST_ROWS = 15

FRONTED = re.compile(r"(Of|What|Whether)\b")
SENTENCE_END = re.compile(r"(?<=[.!?:;])\s+(?=[A-Z`\[*'\"])|\s-\s")
STRING = re.compile(r'"(?:[^"\\\n]|\\.)*"(?:\s*"(?:[^"\\\n]|\\.)*")*')
GENERATED = re.compile(r"^<!-- (?:rows|ratios|used|difficulty|growth|cost|beside|output|settings:|map)[^>]*-->\n.*?<!-- /\w+ -->\n",
                       re.DOTALL | re.MULTILINE)
FOLDERS = "apps|bench|docs|examples|include|packaging|python|robots|scenes|script|src|tests|tools|viewer"
NAMED = re.compile(rf"(?<![\w/.$}}-])(?:{FOLDERS})/[\w./*-]*\w")
BARE = re.compile(r"(?<![\w/.(-])[a-z_]+\.md\b")
CTEST = re.compile(r"/(unit|law|oracle|flow|short|endurance|service|trajectories|bundle|slow)$")


def blank(match):
    """As many lines without text."""
    return "\n" * match[0].count("\n")


def without_code(text):
    text = GENERATED.sub(blank, text)
    text = re.sub(r"^```.*?^```$", blank, text, flags=re.DOTALL | re.MULTILINE)
    return re.sub(r"<!--.*?-->", blank, text, flags=re.DOTALL)


def sentences(text):
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"`[^`]*`", "`X`", text)
    return [part.strip() for part in SENTENCE_END.split(re.sub(r"\s+", " ", text)) if part.strip()]


def too_long(text):
    return [sentence for sentence in sentences(text) if len(sentence.split()) > MOST_WORDS]


def doc_comments(text):
    """Pairs of a line number and a doc comment."""
    block, first = [], 0
    for number, line in enumerate([*text.splitlines(), ""], 1):
        match = re.match(r"\s*///(?!<)\s?(.*)", line) or re.search(r"///<\s?(.*)", line)
        follows = bool(re.match(r"\s*///(?!<)", line)) or (block and re.match(r"\s*///<", line))
        if block and not follows:
            yield first, " ".join(block)
            block = []
        if match:
            first = number if not block else first
            block.append(match[1].strip())


def strings(text):
    """Pairs of a line number and a string of several words, whose literals are joined."""
    for match in STRING.finditer(re.sub(r"//.*", "", text)):
        joined = "".join(re.findall(r'"((?:[^"\\]|\\.)*)"', match[0])).replace("\\n", ". ")
        if len(joined.split()) > MOST_WORDS:
            yield text[:match.start()].count("\n") + 1, joined


def words(text):
    return [word for word in (word.strip(".,:;()") for word in re.sub(r"\\[nr]", " ", text).split()) if word]


def templates(text):
    """The words of each string of the code, whose literals are joined; "{}" stands for any word."""
    for match in STRING.finditer(re.sub(r"^\s*//.*", "", text, flags=re.MULTILINE)):
        yield words("".join(re.findall(r'"((?:[^"\\]|\\.)*)"', match[0])))


def is_written(piece, template):
    """True if the words of a message follow each other in a string of the code, and two are literally the same."""
    for i in range(len(template) - len(piece) + 1):
        pairs = list(zip(piece, template[i:]))
        if all(has == word or "{" in has for word, has in pairs) and sum(has == word for word, has in pairs) > 1:
            return True
    return False


def messages(text):
    """Pairs of a line number and a part of a message, of two words or more, in tables with the head "message"."""
    is_message = False
    for number, line in enumerate(text.splitlines(), 1):
        is_message = line.startswith("|") and (is_message or line.startswith("| message |"))
        for message in re.findall(r"`([^`]*)`", line.split("|")[1]) if is_message else ():
            for part in re.split(r"\.\.|[:;()]", message):
                if len(words(part)) > 1:
                    yield number, part.strip()


def paragraphs(text):
    """Pairs of a line number and the text of a paragraph or of an item of a list."""
    block, first = [], 0
    for number, line in enumerate([*text.splitlines(), ""], 1):
        is_text = line.strip() and not line.startswith(("|", "#"))
        begins = re.match(r"\s*(?:[-*]|\d+\.)\s", line)
        if block and (not is_text or begins):
            yield first, " ".join(block)
            block = []
        if is_text:
            first = number if not block else first
            block.append(re.sub(r"^\s*(?:[-*]|\d+\.)\s+", "", line).strip())


def tables(text):
    """Pairs of a line number and a count of rows without the head."""
    rows, first = 0, 0
    for number, line in enumerate([*text.splitlines(), ""], 1):
        if line.startswith("|"):
            first = number if rows == 0 else first
            rows += 1
        elif rows:
            yield first, rows - 2
            rows = 0


class Check:
    def __init__(self, root):
        self.root, self.findings = root, []
        self.templates = [template for folder in ("src", "apps") for path in sorted(root.glob(f"{folder}/**/*.cpp"))
                          for template in templates(path.read_text(encoding="utf-8")) if len(template) > 1]
        self.pages = {path.name for path in root.rglob("*.md") if "node_modules" not in path.parts}

    def report(self, path, line, what):
        self.findings.append(f"{path.relative_to(self.root)}:{line}: {what}")

    def check_long(self, path, line, text):
        for sentence in too_long(text):
            self.report(path, line, f"a sentence of {len(sentence.split())} words: {sentence[:60]}...")

    def exists(self, name):
        return CTEST.search(name) or re.search(r"\b[A-Z]{2,}\b", name.replace("_", " ")) or any(self.root.glob(name))

    def check_names(self, path, line, text):
        for name in NAMED.findall(text):
            if not self.exists(name):
                self.report(path, line, f"there is no file {name}")
        for name in BARE.findall(text):
            if name not in self.pages:
                self.report(path, line, f"there is no page {name}")

    def check_code(self, path, has_comments):
        text = path.read_text(encoding="utf-8")
        for line, comment in doc_comments(text) if has_comments else ():
            self.check_long(path, line, comment)
            self.check_names(path, line, comment)
            if FRONTED.match(comment):
                self.report(path, line, f"a doc comment opens with '{comment.split()[0]}': subject and verb first")
        for line, string in strings(text):
            self.check_long(path, line, string)

    def check_messages(self, path, text):
        for line, part in messages(text):
            if not any(is_written(words(part), template) for template in self.templates):
                self.report(path, line, f"no string of the code has the message '{part}'")

    def check_document(self, path, is_guide):
        text = path.read_text(encoding="utf-8")
        for number, line in enumerate(text.splitlines(), 1):
            if len(line) > MOST_COLUMNS and not line.startswith("|") and "](" not in line:
                self.report(path, number, f"{len(line)} columns, expected at most {MOST_COLUMNS}")
        prose = without_code(text)
        for line, paragraph in paragraphs(prose):
            self.check_long(path, line, paragraph)
        for number, line in enumerate(prose.splitlines(), 1):
            self.check_names(path, number, line)
        self.check_messages(path, prose)
        for line, rows in tables(prose) if is_guide else ():
            if rows > MOST_ROWS:
                self.report(path, line, f"a table of {rows} rows, expected at most {MOST_ROWS}")


def check(root):
    """What is wrong with the texts of a source tree, a line each."""
    found = Check(root)
    for path in sorted(root.glob("include/mneme/*.h")):
        found.check_code(path, has_comments=True)
    for path in sorted(root.glob("apps/*.cpp")):
        found.check_code(path, has_comments=False)
    guide = [root / "README.md", *sorted(root.glob("docs/*.md"))]
    others = [*(root / name for name in ("ARCHITECTURE.md", "CONTRIBUTING.md")), *sorted(root.glob("docs/*/*.md"))]
    for path in [*guide, *others]:
        if path.exists():
            found.check_document(path, is_guide=path in guide)
    return found.findings


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", type=pathlib.Path, metavar="SOURCE_DIRECTORY")
    findings = check(parser.parse_args().root)
    print("\n".join(findings), end="\n" if findings else "")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
