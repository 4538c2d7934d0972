#!/usr/bin/python3
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the settings as mneme declares them into documents and stubs, between markers.

usage: mneme settings --json | generate_settings.py SOURCE_DIRECTORY [--check]

Markdown has tables between <!-- settings:GROUP --> and <!-- /settings -->, Python stubs have keywords between
# settings:GROUP and # /settings. The group "kinds" is a table of the defaults that depend on the kind of memory; stubs
have none. With --check nothing is written: it fails if something would be.
"""
import argparse
import json
import keyword
import pathlib
import re
import sys

FILES = ("docs/design/settings.md", "python/mneme/__init__.pyi")
MARKED = {".md": re.compile(r"^(?P<open>(?P<indent> *)<!-- settings:(?P<group>\w+) -->\n)(?P<text>.*?)"
                            r"(?P<close> *<!-- /settings -->\n)", re.DOTALL | re.MULTILINE),
          ".pyi": re.compile(r"^(?P<open>(?P<indent> *)# settings:(?P<group>\w+)\n)(?P<text>.*?)"
                             r"(?P<close> *# /settings\n)", re.DOTALL | re.MULTILINE)}
STUB_TYPES = {"int": "int", "float": "float", "bool": "bool", "text": "str", "choice": "str"}


def number(value):
    """As people write it: 1e6 instead of 1e+06; single precision has seven digits."""
    return re.sub(r"e\+?(-?)0*", r"e\1", f"{value:.7g}") if abs(value) < 1e6 else re.sub(
        r"\.?0*e\+?0*", "e", f"{value:.6e}")


def shown(value):
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "on" if value else "off"
    return number(value) if isinstance(value, (int, float)) else (str(value) or "-")


def range_of(setting):
    if setting["type"] == "bool":
        return "on, off"
    if setting.get("choices"):
        return ", ".join(setting["choices"])
    least, most = setting.get("least"), setting.get("most")
    if least is None and most is None:
        return "" if setting["type"] == "text" else "any"
    if most is None:
        return f"{number(least)} or more"
    return f"at most {number(most)}" if least is None else f"{number(least)} to {number(most)}"


def write_table(head, rows):
    lines = [" | ".join(cell.replace("|", "\\|") for cell in row) for row in (head, *rows)]
    lines = [f"| {line} |\n" for line in lines]
    return lines[0] + "|" + "---|" * len(head) + "\n" + "".join(lines[1:])


def table(group, _):
    if "kinds" in group:
        return write_table(("setting", *(f"`{kind}`" for kind in group["kinds"])),
                           [(f"`{row['name']}`", *row["values"]) for row in group["settings"]])
    return write_table(("setting", "default", "range", "meaning"),
                       [(f"`{setting['name']}`", shown(setting.get("default")), range_of(setting), setting["meaning"])
                        for setting in group["settings"]])


def stub_default(setting):
    default = setting.get("default")
    if default is None:
        return "None"
    if setting["type"] == "float":
        return repr(float(f"{default:.7g}"))
    return json.dumps(default) if isinstance(default, str) else repr(default)


def keywords(group, indent):
    lines = []
    for setting in group["settings"]:
        name = setting["name"].replace("-", "_")
        name += "_" if keyword.iskeyword(name) else ""
        kind = STUB_TYPES[setting["type"]]
        kind = f"Optional[{kind}]" if setting.get("optional") else kind
        lines.append(f"{indent}{name}: {kind} = {stub_default(setting)},\n")
    return "".join(lines)


WRITERS = {".md": table, ".pyi": keywords}


def generate(text, suffix, groups):
    """The text with what stands between markers written anew, and the groups that are marked."""
    marked = []

    def write(match):
        marked.append(match["group"])
        if match["group"] not in groups:
            return match[0]
        return match["open"] + WRITERS[suffix](groups[match["group"]], match["indent"]) + match["close"]
    return MARKED[suffix].sub(write, text), marked


def update(root, groups, is_checking):
    """What is wrong with the files, or would be if they were written."""
    findings = []
    for name in FILES:
        path = root / name
        before = path.read_text()
        expected = groups if path.suffix == ".md" else ()  # stubs may say **settings
        after, marked = generate(before, path.suffix, groups)
        findings += [f"{name}: settings:{group} is marked, but mneme settings has no such group"
                     for group in sorted(set(marked) - set(groups))]
        findings += [f"{name}: settings:{group} is not marked anywhere" for group in expected if group not in marked]
        if after != before and is_checking:
            findings.append(f"{name}: settings are not as declared: script/generate writes them anew")
        elif after != before:
            path.write_text(after)
            print(f"wrote {name}")
    return findings


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", type=pathlib.Path, metavar="SOURCE_DIRECTORY")
    parser.add_argument("--check", action="store_true", help="write nothing, say what is stale")
    arguments = parser.parse_args()
    groups = {group["group"]: group for group in json.load(sys.stdin)}
    findings = update(arguments.root, groups, arguments.check)
    print("\n".join(findings), file=sys.stderr, end="\n" if findings else "")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
