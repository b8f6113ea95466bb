#!/usr/bin/python3
"""run_python_tests.py FILE RESULT: runs a file's unittest cases and writes their results as JUnit XML. rosunit's own
writer counts skipped tests, and failures in subtests or in a class's set-up, as passed."""

import faulthandler
import os
import sys
import time
import unittest
import xml.etree.ElementTree as ElementTree

LIMIT = 900  # s for a file, far beyond what any takes: one that hangs says where, and leaves the others their time


class Recorder(unittest.TextTestResult):
    """Keeps one XML element for each test."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.suite = ElementTree.Element('testsuite')
        self.case, self.started = None, 0.0

    def startTest(self, test):
        super().startTest(test)
        self.case, self.started = self.add_case(test), time.monotonic()

    def stopTest(self, test):
        super().stopTest(test)
        self.case.set('time', '%.3f' % (time.monotonic() - self.started))
        self.case = None

    def add_case(self, test):
        of_class, _, name = test.id().rpartition('.')
        return ElementTree.SubElement(self.suite, 'testcase', classname=of_class, name=name)

    def note(self, kind, test, message, text=''):
        case = self.add_case(test) if self.case is None else self.case  # a class's set-up is no test
        ElementTree.SubElement(case, kind, message=message).text = text

    def addError(self, test, err):
        super().addError(test, err)
        self.note('error', test, '%s: %s' % (err[0].__name__, err[1]), self.errors[-1][1])

    def addFailure(self, test, err):
        super().addFailure(test, err)
        self.note('failure', test, str(err[1]), self.failures[-1][1])

    def addSubTest(self, test, subtest, err):
        super().addSubTest(test, subtest, err)
        if err is not None:
            self.note('failure', test, '%s: %s' % (subtest, err[1]))

    def addUnexpectedSuccess(self, test):
        super().addUnexpectedSuccess(test)
        self.note('failure', test, 'passed, though marked as an expected failure')

    def addSkip(self, test, reason):
        super().addSkip(test, reason)
        self.note('skipped', test, reason)


def main():
    file, result = map(os.path.abspath, sys.argv[1:3])
    faulthandler.dump_traceback_later(LIMIT, exit=True)
    tests = unittest.defaultTestLoader.discover(*os.path.split(file))  # a file that skips all as it is loaded is a skipped test
    outcome = unittest.TextTestRunner(resultclass=Recorder, verbosity=2).run(tests)
    counts = {'tests': outcome.testsRun, 'errors': len(outcome.errors), 'failures': len(outcome.failures)}
    outcome.suite.attrib.update({kind: str(count) for kind, count in counts.items()})
    os.makedirs(os.path.dirname(result), exist_ok=True)
    ElementTree.ElementTree(outcome.suite).write(result, encoding='utf-8', xml_declaration=True)
    sys.exit(0 if outcome.wasSuccessful() else 1)


if __name__ == '__main__':
    main()
