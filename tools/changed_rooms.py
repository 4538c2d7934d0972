#!/usr/bin/python3
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Prints the rooms that differ from an earlier commit, or the objects that they and their tests are compiled into.

usage: changed_rooms.py SOURCE_DIRECTORY [--since COMMIT] [--objects BUILD_DIRECTORY]

Rooms are those of src/, and apps. The earlier commit is the merge base with origin/main, or the twentieth before HEAD on
that branch itself. All rooms have changed in a clone that does not go back that far, and outside of git.
"""
import argparse
import json
import pathlib
import re
import shlex
import subprocess
import sys

COMMITS_BACK = 20
UNITY_INCLUDE = re.compile(r'^#include "([^"]+)"', re.MULTILINE)


def room_of(path, root):
    """The room of a source, or apps; None for what is generated."""
    try:
        parts = path.resolve().relative_to(root).parts
    except ValueError:
        return None
    if parts[0] in ("src", "tests") and len(parts) > 2:
        return parts[1]
    return "apps" if parts[0] == "apps" else None


def git(root, *arguments):
    """What git prints; None if it fails."""
    done = subprocess.run(["git", "-C", root, *arguments], capture_output=True, text=True)
    return done.stdout.strip() if done.returncode == 0 else None


def earlier_commit(root):
    """The commit to compare with; None if there is none."""
    head = git(root, "rev-parse", "HEAD")
    base = git(root, "merge-base", "HEAD", "origin/main")
    return base if base not in (None, head) else git(root, "rev-parse", "--quiet", "--verify", f"HEAD~{COMMITS_BACK}")


def changed_rooms(root, since):
    """Rooms with C++ files that differ from a commit, tests and files that git does not know among them; None outside of
    git."""
    names = git(root, "diff", "--name-only", since, "--") if since else None
    if names is None:
        return None
    new = git(root, "ls-files", "--others", "--exclude-standard")
    paths = [pathlib.PurePosixPath(name) for name in (names + "\n" + new).splitlines() if name]
    public = {path.stem for path in paths if path.parts[:2] == ("include", "mneme")}
    return public | {room_of(root / path, root) for path in paths if path.suffix in (".h", ".cpp")} - {None}


def sources_of(entry):
    """The sources of an entry of compile_commands.json, those of a unity build one by one."""
    path = pathlib.Path(entry["directory"]) / entry["file"]
    if "Unity" not in path.parts:
        return [path]
    return [pathlib.Path(name) for name in UNITY_INCLUDE.findall(path.read_text())] if path.exists() else []


def objects_of(root, build, rooms):
    """The object files of rooms (None: of all) and their tests, as the build calls them."""
    objects = []
    for entry in json.loads((build / "compile_commands.json").read_text()):
        found = {room_of(source, root) for source in sources_of(entry)} - {None}
        words = shlex.split(entry["command"])
        if found and "-o" in words and (rooms is None or found & rooms):
            objects.append(words[words.index("-o") + 1])
    return sorted(set(objects))


def all_rooms(root):
    return {path.name for path in (root / "src").iterdir() if path.is_dir()} | {"apps"}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", type=lambda name: pathlib.Path(name).resolve(), metavar="SOURCE_DIRECTORY")
    parser.add_argument("--since", metavar="COMMIT")
    parser.add_argument("--objects", type=pathlib.Path, metavar="BUILD_DIRECTORY")
    arguments = parser.parse_args()
    root = arguments.root
    rooms = changed_rooms(root, arguments.since or earlier_commit(root))
    if arguments.objects:
        print(*objects_of(root, arguments.objects, rooms), sep="\n")
    else:
        print(*sorted(all_rooms(root) if rooms is None else rooms & all_rooms(root)), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
