#!/usr/bin/python3
"""Prints a table of the core's files with gcov's counts, least covered first, and writes the lines that no test has run.
scripts/coverage starts it. It reads gcov's JSON: gcovr 5.2 takes many minutes for the text, and does not finish."""
import argparse
import collections
import itertools
import json
import os
import subprocess

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
AT_ONCE = 12  # files that gcov is given
NOT_THE_CORE = tuple(top + part + '/' for top in ('src/', 'include/mr_hand_interaction/')
                     for part in ('record', 'ros', 'replay', 'nodes'))
Counts = collections.namedtuple('Counts', 'lines branches')  # how often: by line, and by line and place in it


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('objects', metavar='DIR', help="folder of the core's object files")
    parser.add_argument('not_run', metavar='FILE', help='for the lines that no test ran')
    parser.add_argument('--files', type=int, default=40, help='rows of the table; default: 40')
    arguments = parser.parse_args()
    counted = collections.defaultdict(lambda: Counts(collections.Counter(), collections.Counter()))
    for unit in units(arguments.objects):
        add(unit, counted)
    rows = sorted((shares(counts), path) for path, counts in counted.items())
    for (_, text), path in rows[:arguments.files]:
        print('%s  %s' % (text, path))
    print('%s  all' % shares(together(counted))[1])
    with open(arguments.not_run, 'w', encoding='utf-8') as file:
        file.writelines('%s: %s\n' % (path, ranges(lines)) for path, lines in not_run(counted))


def units(folder):
    """Yields gcov's report of each object file, unchanged."""
    counts = sorted(os.path.join(place, name) for place, _, names in os.walk(os.path.abspath(folder)) for name in names
                    if name.endswith('.gcda'))
    if not counts:
        raise SystemExit('coverage: %s has no counts: nothing has been run' % folder)
    for first in range(0, len(counts), AT_ONCE):
        said = subprocess.run(['gcov', '--json-format', '--stdout', '--branch-probabilities',
                               *counts[first:first + AT_ONCE]], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                              universal_newlines=True, cwd=folder, check=True).stdout
        yield from (json.loads(line) for line in said.splitlines() if line.startswith('{'))


def add(unit, counted):
    for file in unit['files']:
        path = os.path.relpath(os.path.join(unit['current_working_directory'], file['file']), ROOT)
        if not path.startswith(('src/', 'include/')) or path.startswith(NOT_THE_CORE):
            continue
        lines, branches = counted[path]
        for line in file['lines']:
            number = line['line_number']
            lines[number] += line['count']
            # A line of a template, or of a header, occurs more than once.
            for place, branch in enumerate(b for b in line['branches'] if not b['throw']):
                branches[number, place] += branch['count']


def together(counted):
    everything = Counts(collections.Counter(), collections.Counter())
    for path, counts in counted.items():
        for all_of_one, one in zip(everything, counts):
            all_of_one.update({(path, key): count for key, count in one.items()})
    return everything


def shares(counts):
    """The share of lines that were run, to sort by, and a text."""
    parts = []
    for of in counts:
        parts.append((100.0 * sum(count > 0 for count in of.values()) / len(of) if of else 100.0, len(of)))
    return parts[0][0], '%5.1f %% of %5d lines, %5.1f %% of %5d branches' % (*parts[0], *parts[1])


def not_run(counted):
    for path in sorted(counted):
        lines = sorted(number for number, count in counted[path].lines.items() if count == 0)
        if lines:
            yield path, lines


def ranges(numbers):
    """1-3 7 9"""
    found = []
    for _, group in itertools.groupby(enumerate(numbers), lambda pair: pair[1] - pair[0]):
        group = [number for _, number in group]
        found.append(str(group[0]) if len(group) == 1 else '%d-%d' % (group[0], group[-1]))
    return ' '.join(found)


if __name__ == '__main__':
    main()
