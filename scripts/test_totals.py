#!/usr/bin/python3
"""Counts the tests in a folder of JUnit results, names those that failed or were skipped, and closes with one line:
N passed, N failed, N skipped. Exits with 1 if any failed or none passed."""
import collections
import os
import sys
import xml.etree.ElementTree as ElementTree


def result_files(folder):
    return sorted(os.path.join(where, name) for where, _, names in os.walk(folder) for name in names
                  if name.endswith(".xml"))


def test_cases(file):
    """Results of a file as (name, outcome, message)."""
    suite = os.path.splitext(os.path.basename(file))[0]
    try:
        root = ElementTree.parse(file).getroot()
    except ElementTree.ParseError as error:
        return [(suite, "failed", f"unreadable result: {error}")]
    cases = list(root.iter("testcase"))
    if not cases and any(int(part.get("errors") or 0) for part in root.iter("testsuite")):
        return [(suite, "failed", "an error before its first test")]
    named = [(f"{case.get('classname') or suite}.{case.get('name')}", *outcome(case)) for case in cases]
    if suite.startswith("rostest-"):
        # rostest's summary of tests with results of their own; it matters if they have none, after a
        # crash or for lack of time.
        named = [case for case in named if case[1] == "failed"]
    return named


def outcome(case):
    for kind in ("failure", "error"):
        found = case.find(kind)
        if found is not None:
            return "failed", found.get("message") or found.text or ""
    skipped = case.find("skipped")
    if skipped is not None or case.get("status") == "notrun" or case.get("result") == "skipped":
        return "skipped", "" if skipped is None else skipped.get("message") or skipped.text or ""
    return "passed", ""


def last_line(text):
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return lines[-1] if lines else ""


def main():
    count = collections.Counter()
    for file in result_files(sys.argv[1]):
        for name, result, said in test_cases(file):
            count[result] += 1
            if result != "passed":
                print(f"{result}: {name}" + (f": {last_line(said)}" if said else ""))
    print(f"{count['passed']} passed, {count['failed']} failed, {count['skipped']} skipped")
    sys.exit(1 if count["failed"] or not count["passed"] else 0)


if __name__ == "__main__":
    main()
