#!/usr/bin/python3
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures files, functions and rooms, and fails beyond hard limits.

usage: check_lengths.py SOURCE_DIRECTORY [--table]

Hard limits: files of 600 lines, functions of 50 lines in src and 60 elsewhere, rooms of 3,500 lines, no cycles of
rooms. --table prints what is measured, with these limits. A function counts from the line of its { to that of its }; lambdas
are part of theirs. A private header's users are the files that include it, without the .cpp of its name.
"""
import argparse
import bisect
import collections
import pathlib
import re
import sys

FILE_LIMIT = 600
FUNCTION_LIMIT = {"src": 50}
OTHER_FUNCTION_LIMIT = 60
ROOM_LIMIT = 3500
FOLDERS = ("src", "include", "apps", "python", "tests", "bench", "examples", "tools")

INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)
# Raw strings first; separators of digits (1'000) before characters.
NOISE = re.compile(r'R"(?P<mark>[^(\s]*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"|(?<=[0-9a-fA-F])\'(?=[0-9a-fA-F])|'
                   r"'(?:\\.|[^'\\\n])*'|//[^\n]*|/\*.*?\*/|^[ \t]*#(?:[^\n\\]|\\.|\\\n)*", re.DOTALL | re.MULTILINE)
SCOPE = re.compile(r"\bnamespace\b|^\s*extern\s*$|^\s*TEST_SUITE\b|"
                   r"^\s*(?:typedef\s+)?(?:static\s+|inline\s+|constexpr\s+)*(class|struct|union)\b(?!.*\)\s*(?:const)?$)",
                   re.DOTALL)
MEMBERS = re.compile(r"\)\s*(?:noexcept\s*(?:\([^)]*\))?\s*)?:(?!:)")


def without_noise(text):
    """The code with comments, strings, characters and preprocessor blanked; lines stay where they are."""
    return NOISE.sub(lambda match: re.sub(r"[^\n]", " ", match[0]), text)


def without_nested(head, opening, closing):
    """The head without what stands in brackets, which stay as a pair."""
    result, depth = [], 0
    for character in head:
        depth -= character == closing and depth > 0
        if depth == 0:
            result.append(character)
        depth += character == opening
    return "".join(result)


def kind_of_brace(head):
    """What a { after this head opens, outside of functions: a scope, a function, data or a member's value."""
    head = re.sub(r"^\s*(?:(?:public|private|protected)\s*:(?!:)\s*)+", "", head)
    head = re.sub(r"template\s*<>", "", without_nested(head, "<", ">") if "template" in head else head)
    head = without_nested(re.sub(r"\[\[.*?\]\]|alignas\s*\([^)]*\)", "", head), "(", ")").strip()
    if SCOPE.search(head):
        return "scope"
    plain = re.sub(r"operator\s*(\(\)|[^\s(\w]+)", "operator", head)
    if "(" not in plain or re.search(r"=(?!=)", plain.split("(", 1)[0]) or plain.endswith("="):
        return "data"
    members = MEMBERS.search(plain)
    if members and re.search(r"[\w>]$", plain):
        return "member"
    return "function"


def functions(text):
    """(line, name, lines) of each function of C++ code."""
    code = without_noise(text)
    breaks = [match.start() for match in re.finditer("\n", code)]
    found, stack, head = [], [], ""
    for match in re.finditer(r"[^{};]+|[{};]", code):
        token, inside = match[0], stack[-1][0] if stack else "scope"
        if token == "{":
            kind = kind_of_brace(head) if inside == "scope" else "inner"
            stack.append((kind, head, match.start()))
            head = ""
        elif token == "}":
            if not stack:
                continue
            kind, outer, start = stack.pop()
            if kind == "function":
                first, last = bisect.bisect(breaks, start), bisect.bisect(breaks, match.start())
                found.append((first + 1, name_of(outer), last - first + 1))
            head = outer + "()" if kind == "member" else ""
        elif token == ";":
            head = "" if inside == "scope" else head
        elif inside == "scope":
            head += token
    return found


def name_of(head):
    before = re.sub(r"operator\s*\(\)", "operator", head).split("(", 1)[0]
    words = re.findall(r"[~\w:]+", before)
    return words[-1] if words else "?"


def quantile(values, share):
    """The smallest value that this share of them does not exceed."""
    ordered = sorted(values)
    return ordered[max(0, -int(-share * len(ordered) // 1) - 1)] if ordered else 0


def room_of(name):
    parts = pathlib.PurePosixPath(name).parts
    return parts[1] if len(parts) == 3 and parts[0] == "src" else None


class Tree:
    """What is measured of the files below a directory."""

    def __init__(self, root):
        paths = [path for folder in FOLDERS for path in sorted((root / folder).rglob("*"))
                 if path.suffix in (".h", ".cpp", ".py")]
        paths += sorted((root / "viewer").glob("*.in"))
        self.texts = {path.relative_to(root).as_posix(): path.read_text() for path in paths}
        self.lines = {name: len(text.splitlines()) for name, text in self.texts.items()}
        self.functions = {name: functions(text) for name, text in self.texts.items() if name.endswith((".h", ".cpp"))}
        self.includes = {name: set(INCLUDE.findall(text)) for name, text in self.texts.items()}
        self.rooms = sorted({room_of(name) for name in self.texts} - {None})
        self.source = [name for name in self.texts if name.startswith("src/") and name in self.functions]

    def of_room(self, room):
        return [name for name in self.source if room_of(name) == room]

    def lengths(self, names):
        return [length for name in names for _, _, length in self.functions[name]]

    def users(self):
        """{private header: files that include it, without the .cpp of its name}"""
        users = {name[len("src/"):]: set() for name in self.source if name.endswith(".h")}
        for name, included in self.includes.items():
            for header in included & set(users):
                if name != "src/" + header[:-1] + "cpp":
                    users[header].add(name)
        return users

    def cycle(self):
        """Rooms in a circle of includes, if there is one."""
        uses = collections.defaultdict(set)
        for name, included in self.includes.items():
            own = pathlib.PurePosixPath(name).stem if name.startswith("include/") else room_of(name)
            for header in included:
                parts = pathlib.PurePosixPath(header).parts
                other = pathlib.PurePosixPath(header).stem if parts[0] == "mneme" else parts[0]
                if own in self.rooms and other in self.rooms and other != own:
                    uses[own].add(other)
        left = set(self.rooms)
        while free := {room for room in left if not uses[room] & left}:
            left -= free
        return sorted(left)


def findings(tree):
    result = [f"{name}: {lines} lines, the limit is {FILE_LIMIT}"
              for name, lines in tree.lines.items() if lines > FILE_LIMIT]
    for name, found in tree.functions.items():
        limit = FUNCTION_LIMIT.get(name.split("/")[0], OTHER_FUNCTION_LIMIT)
        result += [f"{name}:{line}: {function} has {length} lines, the limit is {limit}"
                   for line, function, length in found if length > limit]
    for room in tree.rooms:
        lines = sum(tree.lines[name] for name in tree.of_room(room))
        if lines > ROOM_LIMIT:
            result.append(f"src/{room}: {lines} lines, the limit of a room is {ROOM_LIMIT}")
    if tree.cycle():
        result.append(f"src: rooms include each other in a circle: {', '.join(tree.cycle())}")
    return result


def print_table(tree):
    users = tree.users()
    lonely = {header: names for header, names in users.items() if len(names) < 2}
    within = [names for names in users.values() if sum(name.startswith("src/") for name in names) < 2]
    print("| room | files | lines | functions | p90 | longest | headers with one user |\n|---|--:|--:|--:|--:|--:|--:|")
    for room in tree.rooms:
        names = tree.of_room(room)
        lengths = tree.lengths(names)
        print(f"| {room} | {len(names)} | {sum(tree.lines[name] for name in names)} | {len(lengths)} "
              f"| {quantile(lengths, 0.9)} | {max(lengths, default=0)} "
              f"| {sum(header.startswith(room + '/') for header in lonely)} |")
    files, lengths = [tree.lines[name] for name in tree.source], tree.lengths(tree.source)
    print("\n| src | is | limit |\n|---|--:|--:|")
    for what, value, limit in (
            ("files", len(files), ""), ("lines", sum(files), ""),
            ("lines of a file, median", quantile(files, 0.5), ""), ("lines of a file, p90", quantile(files, 0.9), ""),
            ("lines of a file, most", max(files), FILE_LIMIT), ("functions", len(lengths), ""),
            ("lines of a function, median", quantile(lengths, 0.5), ""), ("lines of a function, p90", quantile(lengths, 0.9), ""),
            ("lines of a function, most", max(lengths), FUNCTION_LIMIT["src"]), ("private headers with one user", len(lonely), ""),
            ("private headers with one user in src", len(within), ""),
            ("rooms in cycles", len(tree.cycle()), 0)):
        print(f"| {what} | {value} | {limit} |")
    print("\n| folder | files | lines | longest file | longest function |\n|---|--:|--:|--:|--:|")
    for folder in FOLDERS:
        names = [name for name in tree.lines if name.startswith(folder + "/")]
        code = [name for name in names if name in tree.functions]
        print(f"| {folder} | {len(names)} | {sum(tree.lines[name] for name in names)} "
              f"| {max(tree.lines[name] for name in names)} | {max(tree.lengths(code), default=0)} |")
    for header, names in sorted(lonely.items()):
        print(f"src/{header}: {'used by ' + ', '.join(names) if names else 'not used'}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", type=pathlib.Path, metavar="SOURCE_DIRECTORY")
    parser.add_argument("--table", action="store_true", help="print what is measured, with the limits")
    arguments = parser.parse_args()
    tree = Tree(arguments.root)
    if arguments.table:
        print_table(tree)
    problems = findings(tree)
    print("\n".join(problems) if problems else f"{len(tree.lines)} files are within the limits")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
