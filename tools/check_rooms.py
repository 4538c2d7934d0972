#!/usr/bin/python3
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks that includes respect src/rooms.txt, which headers are public, the order of includes, and names in headers.

usage: check_rooms.py SOURCE_DIRECTORY [--fix]

Rooms: src/ROOM and include/mneme/ROOM.h include what src/rooms.txt allows them: headers of the rooms that stand behind
the colon, and of those that these may use, in their own library or one that it links. Behind "|" stand the private
headers that a room shows to others; each has a user there, and all others are its own. --shown counts them.
mneme/mneme.h includes headers of the library mneme only. Public headers, apps, the Python
module, the examples and src/ompl include public headers ("mneme/...") and those of their own directory only. Each room
has a test program.

Order: own header; "mneme/..."; other "..."; third party <...>; standard library and system <...>; a blank line
between two such blocks and none within one. --fix brings them into this order. Kernels, which are compiled once
per instruction set, and what stands between #if and #endif keep theirs.

Names: two headers define no type of the same name in the same namespace. No compiler sees both, and the linker takes
either one's functions for the other's. A constant of a header shares its name with no other constant of src and include.
"""
import argparse
import pathlib
import re
import sys

EVERYWHERE = {"base", "simd", "geometry"}
FOLDERS = ("src", "include", "apps", "python", "tests", "bench", "examples")
WITHOUT_TESTS = {"simd"}  # lanes are tested through the kernels of collision and planning
PUBLIC_ONLY = ("include", "apps", "python", "examples", "src/ompl")
INCLUDE = re.compile(r'^\s*#\s*include\s+([<"])([^>"]+)[>"]')
CONDITION = re.compile(r"^\s*#\s*(if|ifdef|ifndef|endif)\b")
NAMESPACE = re.compile(r"^namespace ([\w:]+) \{", re.MULTILINE)
CONSTANT = re.compile(r"^(?:inline |static )*constexpr\s[^=;(){]*?\b(k[A-Z]\w*)\s*(?:\[[^\]]*\]\s*)?[={]", re.MULTILINE)
TYPE = re.compile(r"^(?:class|struct|enum class) (\w+)(?: final)?(?:\s*:[^;{]*)?\s*\{", re.MULTILINE)
KERNELS = re.compile(r"HWY_TARGET_INCLUDE|HWY_BEFORE_NAMESPACE|HWY_TARGET_TOGGLE")
SYSTEM = re.compile(r"[a-z_]+$|(sys|netinet|arpa|bits|linux)/|"
                    r"(assert|dlfcn|errno|fcntl|glob|limits|malloc|math|netdb|poll|pthread|pwd|sched|signal|stddef|stdint|"
                    r"stdio|stdlib|string|termios|time|unistd)\.h$")
OWN, MNEME, OTHER, THIRD_PARTY, STANDARD = range(5)
BLOCKS = ("own header", '"mneme/..."', 'other "..."', "third party <...>", "standard library and system <...>")


def expand(path, name, uses, known):
    """`name`, what it uses, and what that uses in turn."""
    direct = set(uses.split())
    if unknown := direct - set(known):
        sys.exit(f"{path}: {name} uses {sorted(unknown)}, which do not stand above it")
    return {name} | direct | {used for d in direct for used in known[d]}


def read_rooms(path):
    """Returns {room: rooms it may include}, with transitive use expanded, {room: headers it shows}, {room: its library}."""
    libraries, allowed, shown, library_of = {}, {}, {}, {}
    for line in path.read_text().splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        name, _, rest = line.partition(":")
        uses, _, headers = rest.partition("|")
        if name.startswith("library "):
            library = name.removeprefix("library ")
            libraries[library] = expand(path, library, uses, libraries)
            continue
        shown[name] = set(headers.split())
        library_of[name] = library
        allowed[name] = expand(path, name, uses, allowed) | EVERYWHERE & set(allowed)
        strange = {room for room in allowed[name] if library_of[room] not in libraries[library]}
        if strange:
            sys.exit(f"{path}: {name} of {library} uses {sorted(strange)}, whose libraries it does not link")
    return allowed, shown, library_of


def quoted_includes(lines):
    """(number, name) of each #include "name"."""
    matches = ((number, INCLUDE.match(line)) for number, line in enumerate(lines, 1))
    return [(number, match[2]) for number, match in matches if match and match[1] == '"']


def room_of_file(name):
    parts = pathlib.PurePosixPath(name).parts
    if parts[0] == "src" and len(parts) == 3:
        return parts[1]
    if parts[0] == "include" and parts[-1] not in ("mneme.h",):
        return pathlib.PurePosixPath(name).stem
    return None


def room_of_include(name, rooms):
    parts = pathlib.PurePosixPath(name).parts
    if parts[0] == "mneme":
        return pathlib.PurePosixPath(name).stem
    return parts[0] if parts[0] in rooms else None


def check_rooms(name, lines, rooms):
    """What this file of src/ or include/ includes of rooms that its own may not include."""
    room = room_of_file(name)
    if room is None:
        return []
    if room not in rooms:
        return [f"{name}: room {room} is not in src/rooms.txt"]
    used = [(number, include, room_of_include(include, rooms)) for number, include in quoted_includes(lines)]
    return [f"{name}:{number}: {room} may not include {include} (room {other})"
            for number, include, other in used if other is not None and other not in rooms[room]]


def private_includes(name, lines, rooms):
    """(number, room, header) of each private header of another room that this file of src/ includes."""
    room = room_of_file(name)
    parts = ((number, pathlib.PurePosixPath(include).parts) for number, include in quoted_includes(lines))
    return [(number, *part) for number, part in parts if len(part) == 2 and part[0] in rooms and part[0] != room]


def check_shown(files, rooms, shown):
    """Private headers of other rooms that the {name: lines} of src/ include although these do not show them, and headers
    that are shown to nobody."""
    used, findings = set(), []
    for name, lines in files.items():
        for number, other, header in private_includes(name, lines, rooms):
            used.add((other, header))
            if header not in shown[other]:
                findings.append(f"{name}:{number}: {other}/{header} is private; src/rooms.txt says what {other} shows")
    return findings + [f"src/rooms.txt: {room} shows {header}, which no other room includes"
                       for room, headers in shown.items() for header in sorted(headers) if (room, header) not in used]


def check_umbrella(name, lines, library_of):
    """Headers of other libraries that mneme/mneme.h includes."""
    if name != "include/mneme/mneme.h":
        return []
    return [f"{name}:{number}: {include} is not of the library mneme" for number, include in quoted_includes(lines)
            if library_of.get(pathlib.PurePosixPath(include).stem) != "mneme"]


def check_public(root, name, lines):
    """What this file includes besides public headers and those of its own directory."""
    folder = next((folder for folder in PUBLIC_ONLY if name.startswith(folder + "/")), None)
    if folder is None:
        return []
    base = root / "src" if folder == "src/ompl" else root / folder

    def is_own(include):
        path = (base / include).resolve()
        return path.is_file() and (root / folder).resolve() in path.parents
    return [f"{name}:{number}: {folder} may include public headers (mneme/...) and its own only, not {include}"
            for number, include in quoted_includes(lines)
            if not include.startswith(("mneme/", "hwy/")) and not is_own(include)]


def check_tests(root, rooms):
    """Rooms without a test program."""
    return [f"tests/{room}: room {room} has no test program (tests/{room}/*_test.cpp)"
            for room in rooms if room not in WITHOUT_TESTS and not any((root / "tests" / room).glob("*_test.cpp"))]


def check_types(headers):
    """Types that two of the {name: text} define in one namespace."""
    places = {}
    for name, text in headers.items():
        opened = [(match.start(), match[1]) for match in NAMESPACE.finditer(text)]
        for match in TYPE.finditer(text):
            around = [space for start, space in opened if start < match.start()]
            places.setdefault((around[-1] if around else "", match[1]), []).append(name)
    return [f"{names[1]}: type {kind} is defined in {names[0]}, too" for (_, kind), names in places.items() if len(names) > 1]


def check_constants(texts):
    """Constants of headers among the {name: text} whose name another file gives to a constant, too."""
    places = {}
    for name, text in texts.items():
        for match in CONSTANT.finditer(text):
            places.setdefault(match[1], []).append(name)
    return [f"{names[1]}: constant {constant} is defined in {names[0]}, too" for constant, names in places.items()
            if len(names) > 1 and any(name.endswith(".h") for name in names)]


def block_of(name, kind, include):
    if kind == "<":
        return STANDARD if SYSTEM.match(include) else THIRD_PARTY
    own = pathlib.PurePosixPath(name)
    path = pathlib.PurePosixPath(include)
    if own.suffix == ".cpp" and path.stem == own.stem and path.parts[0] in (own.name, own.parent.name, path.name):
        return OWN
    if path.parts[0] == "mneme":
        return MNEME
    return THIRD_PARTY if path.parts[0] == "hwy" else OTHER


def runs_of_includes(lines):
    """[begin, end) of the lines of each run of includes with nothing but blank lines and comments in between."""
    runs, begin, end, depth = [], None, None, 0
    for number, line in enumerate(lines):
        if INCLUDE.match(line) and depth == 0:
            begin, end = (number if begin is None else begin), number + 1
        elif line.strip() and not line.lstrip().startswith("//"):
            condition = CONDITION.match(line)
            depth += 0 if not condition else -1 if condition[1] == "endif" else 1
            if begin is not None:
                runs.append((begin, end))
            begin = None
    return runs + ([(begin, end)] if begin is not None else [])


def in_order(name, run):
    """The lines of a run block by block. A comment stays above the include that it precedes."""
    blocks, above = [[] for _ in BLOCKS], []
    for line in run:
        match = INCLUDE.match(line)
        if match:
            blocks[block_of(name, match[1], match[2])].append([*above, line])
            above = []
        elif line.strip():
            above.append(line)
    result = []
    for block in blocks:
        result += ([""] if result and block else []) + [line for group in block for line in group]
    return result


def first_in_wrong_place(name, run):
    """Offset in the run of the first line that breaks the order, and what is wrong with it."""
    last = None
    for offset, line in enumerate(run):
        match = INCLUDE.match(line)
        if not match:
            continue
        block = block_of(name, match[1], match[2])
        if last is not None and block < last:
            return offset, f"{match[2]} ({BLOCKS[block]}) belongs above {BLOCKS[last]}"
        has_blank = offset > 0 and "" in [above.strip() for above in run[previous + 1:offset]]
        if last is not None and has_blank != (block != last):
            return offset, f"{'no' if block == last else 'a'} blank line belongs above {match[2]}"
        last, previous = block, offset
    return 0, "more blank lines than one between two blocks"


def check_order(path, name, lines, is_fixing):
    """Findings, if includes are out of order; or brings them into order."""
    if any(KERNELS.search(line) for line in lines):
        return []
    findings, fixed = [], list(lines)
    for begin, end in reversed(runs_of_includes(lines)):
        run = lines[begin:end]
        ordered = in_order(name, run)
        if ordered != run:
            offset, message = first_in_wrong_place(name, run)
            findings.insert(0, f"{name}:{begin + offset + 1}: {message}")
            fixed[begin:end] = ordered
    if is_fixing and findings:
        path.write_text("\n".join(fixed) + "\n")
        return []
    return findings


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", type=pathlib.Path, metavar="SOURCE_DIRECTORY")
    parser.add_argument("--fix", action="store_true", help="bring includes into order")
    parser.add_argument("--shown", action="store_true", help="count the private headers that rooms show, and end")
    arguments = parser.parse_args()
    root = arguments.root
    rooms, shown, library_of = read_rooms(root / "src/rooms.txt")
    if arguments.shown:
        print(*(f"{room}: {len(headers)}" for room, headers in shown.items() if headers), sep="\n")
        print(f"in all: {sum(len(headers) for headers in shown.values())}")
        return 0
    paths = [path for folder in FOLDERS for suffix in ("*.h", "*.cpp") for path in sorted((root / folder).rglob(suffix))]
    findings = check_tests(root, rooms)
    texts = {}
    for path in paths:
        name = path.relative_to(root).as_posix()
        text = path.read_text()
        lines = text.splitlines()
        if name.startswith(("src/", "include/")):
            texts[name] = text
        findings += check_rooms(name, lines, rooms)
        findings += check_umbrella(name, lines, library_of)
        findings += check_public(root, name, lines)
        findings += check_order(path, name, lines, arguments.fix)
    sources = {name: text.splitlines() for name, text in texts.items() if name.startswith("src/")}
    findings += check_shown(sources, rooms, shown)
    findings += check_types({name: text for name, text in texts.items() if name.endswith(".h")})
    findings += check_constants(texts)
    print("\n".join(findings) if findings else f"{len(paths)} files respect {len(rooms)} rooms")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
