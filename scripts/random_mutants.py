#!/usr/bin/env python3
"""Draws mutants of the product at random, for scripts/mutate: one break of one line each.

Prints lines as test/mutants.tsv has them, but for FILE:LINE in place of a file; the texts are whole lines."""
import argparse
import glob
import os
import random
import re

REPOSITORY = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
# Suites for each folder, those that are likely to notice first.
SUITES = {
    "math": "regression math rendering simulation",
    "text": "text regression scene training replay",
    "scene": "regression scene training simulation joints",
    "configuration": "scene simulation ros",
    "tracking": "regression tracking simulation rendering laws",
    "collision": "regression collision scene laws",
    "response": "regression laws joints simulation",
    "integration": "regression integration joints laws simulation",
    "joints": "regression joints laws simulation",
    "simulation": "regression simulation laws synthetic replay",
    "rendering": "regression rendering simulation ros",
    "synthetic": "regression synthetic operators training",
    "training": "training regression operators",
    "ros": "ros wire nodes:interaction nodes:live_changes nodes:replay",
    "record": "replay ros",
    "replay": "replay regression",
}
SWAPS = [
    (" < ", " <= "), (" <= ", " < "), (" > ", " >= "), (" >= ", " > "), (" == ", " != "), (" != ", " == "),
    (" + ", " - "), (" - ", " + "), (" * ", " / "), (" / ", " * "), (" += ", " -= "), (" -= ", " += "), (" *= ", " /= "),
    (" && ", " || "), (" || ", " && "), ("std::min(", "std::max("), ("std::max(", "std::min("),
    ("true", "false"), ("false", "true"),
]
NUMBER = re.compile(r"(?<![\w.'\[<])(\d[\d']*\.\d*(?:e[-+]?\d+)?|\d+e[-+]?\d+|\d[\d']*)(?![\w.'])")
STATEMENT = re.compile(r"(\s+)(?:[\w.>\[\]()*-]+ [-+*/]?= .*|[\w.>:-]+\(.*\));$")
NO_STATEMENT = re.compile(r"\s+(?:return|throw|const|auto|double|delete|using)\b|.*[.>]reserve\(")  # memory alone
NO_CODE = ("#", "/", "*", "using", "namespace", "template", "static_assert", "struct", "class", "case", "enum")


def outside_strings(line, at):
    return len(re.findall(r'(?<!\\)"', line[:at])) % 2 == 0 and line.count("'", 0, at) % 2 == 0


def other_numbers(text):
    plain = text.replace("'", "")
    if plain.isdigit():
        value = int(plain)
        step = 1 if value < 10 else value // 3
        return [str(value + step)] + ([str(value - step)] if value > 0 else [])
    value = float(plain)
    return ["0.1"] if value == 0.0 else [repr(2.0 * value), repr(0.7 * value)]


def negated(line):
    found = re.match(r"\s*(?:\} else )?if \(", line)
    if not found or "constexpr" in line:
        return []
    depth = 0
    for at in range(found.end() - 1, len(line)):
        depth += {"(": 1, ")": -1}.get(line[at], 0)
        if depth == 0:
            condition = line[found.end():at]
            return [] if ";" in condition else [line[:found.end()] + "!(" + condition + ")" + line[at:]]
    return []


def mutants_of(line, previous):
    """Mutations of a line of code."""
    code = line.split("//")[0].rstrip()
    if not code.strip() or code.strip().startswith(NO_CODE):
        return []
    changed = []
    for old, new in SWAPS:
        for found in re.finditer(r"(?<!\w)" + re.escape(old) if old[0].isalpha() else re.escape(old), code):
            if outside_strings(code, found.start()):
                changed.append(code[:found.start()] + new + code[found.end():])
    for found in NUMBER.finditer(code):
        if outside_strings(code, found.start()):
            changed += [code[:found.start(1)] + other + code[found.end(1):] for other in other_numbers(found.group(1))]
    changed += negated(code)
    statement = STATEMENT.match(code)
    whole = code.count("(") == code.count(")") and previous.rstrip().endswith((";", "{", "}", ":"))
    if statement and whole and not NO_STATEMENT.match(code):
        changed.append(statement.group(1) + ";")
    return changed


def lines_of(folders, repository=REPOSITORY):
    """(file, number, line, mutants) of every line that can be broken."""
    found = []
    for folder in folders:
        for path in sorted(glob.glob(os.path.join(repository, "src", folder, "*.cpp"))):
            previous = ";"
            in_text = False  # a raw string of several lines
            with open(path, encoding="utf-8") as file:
                for number, line in enumerate(file, 1):
                    line = line.rstrip("\n")
                    if in_text or 'R"' in line:
                        in_text = ')"' not in line
                        continue
                    changed = mutants_of(line, previous)
                    if line.strip() and not line.strip().startswith("//"):
                        previous = line.split("//")[0]
                    if changed:
                        found.append((os.path.relpath(path, repository), number, line, changed))
    return found


def drawn(count, seed, folders, repository=REPOSITORY):
    """Each line is as likely as any other, and each of its mutants."""
    chance = random.Random(seed)
    lines = lines_of(folders, repository)
    chance.shuffle(lines)
    for path, number, line, changed in lines[:count]:
        folder = path.split(os.sep)[1]
        yield "%s:%d" % (os.path.basename(path), number), "%s:%d" % (path, number), line, chance.choice(changed), SUITES[folder]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--folders", default=",".join(SUITES), help="folders of src/, separated by commas")
    arguments = parser.parse_args()
    for mutant in drawn(arguments.count, arguments.seed, arguments.folders.split(",")):
        print("\t".join(mutant))


if __name__ == "__main__":
    main()
