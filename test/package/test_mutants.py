#!/usr/bin/env python3
"""What scripts/mutate breaks is there to be broken."""
import os
import re
import sys
import tempfile
import unittest

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(PACKAGE, "scripts"))
import random_mutants  # noqa: E402


def text_of(path):
    with open(os.path.join(PACKAGE, path), encoding="utf-8") as file:
        return file.read()


def chosen_mutants():
    lines = text_of("test/mutants.tsv").splitlines()
    return [line.split("\t") for line in lines if line and not line.startswith("#")]


def suites():
    """Names of the test programs that there are."""
    cmake = text_of("test/CMakeLists.txt")
    nodes = {"nodes:" + name[:-5] for name in os.listdir(os.path.join(PACKAGE, "test/ros")) if name.endswith(".test")}
    return set(re.findall(r"\w+", " ".join(re.findall(r"foreach\(folder ([^)]*)\)", cmake)))) | {"fuzz", "real_grasps"} | nodes


class Chosen(unittest.TestCase):
    def test_each_has_a_name_of_its_own_and_suites_that_there_are(self):
        known = suites()
        names = [mutant[0] for mutant in chosen_mutants()]
        self.assertEqual(len(names), len(set(names)))
        for name, _, _, _, asked in chosen_mutants():
            self.assertTrue(set(asked.split()) <= known, "%s: %s" % (name, asked))

    def test_each_text_is_in_its_file_once_and_becomes_another(self):
        for name, file, old, new, _ in chosen_mutants():
            self.assertEqual(text_of(file).count(old), 1, name)
            self.assertNotEqual(old, new, name)


class Random(unittest.TestCase):
    def test_each_is_another_line_in_the_place_of_one_that_is_there(self):
        for _, place, old, new, _ in random_mutants.drawn(500, 1, random_mutants.SUITES):
            path, number = place.split(":")
            self.assertEqual(text_of(path).splitlines()[int(number) - 1], old)
            self.assertNotEqual(old, new)
            self.assertNotIn("\t", old + new)

    def test_a_seed_draws_the_same_and_another_seed_others(self):
        draw = [list(random_mutants.drawn(20, seed, ["text", "response"])) for seed in (1, 1, 2)]
        self.assertEqual(draw[0], draw[1])
        self.assertNotEqual(draw[0], draw[2])

    def test_all_of_the_core_is_drawn_from_by_suites_that_there_are(self):
        folders = {name for name in os.listdir(os.path.join(PACKAGE, "src"))
                   if any(file.endswith(".cpp") for file in os.listdir(os.path.join(PACKAGE, "src", name)))}
        self.assertEqual(folders - {"nodes", "without_ros"}, set(random_mutants.SUITES))
        self.assertTrue(set(" ".join(random_mutants.SUITES.values()).split()) <= suites())

    def test_texts_of_several_lines_are_no_code(self):
        with tempfile.TemporaryDirectory() as folder:
            os.makedirs(os.path.join(folder, "src", "text"))
            with open(os.path.join(folder, "src", "text", "usage.cpp"), "w") as file:
                file.write('int a = 1;\nreturn R"(0 done\n  1 < 2\n  3)";\nint b = 2;\n')
            self.assertEqual([line[1] for line in random_mutants.lines_of(["text"], folder)], [1, 5])

    def test_lines_may_become(self):
        def mutants(line, previous=";"):
            return random_mutants.mutants_of(line, previous)
        self.assertEqual(mutants("  if (a < 2) return;"),
                         ["  if (a <= 2) return;", "  if (a < 3) return;", "  if (a < 1) return;", "  if (!(a < 2)) return;"])
        self.assertEqual(mutants("  x_ = y;"), ["  ;"])
        self.assertEqual(mutants("  x_ = y;", previous="  const double z ="), [])
        self.assertEqual(mutants("constexpr double kA = 0.5;  // 1 m"),
                         ["constexpr double kA = 1.0;", "constexpr double kA = 0.35;"])
        self.assertEqual(mutants('  const char* name = "a < 1";'), [])
        for nothing in ("", "// a < b", "#if A > 1", "template <int N>", "  const Array<3> a;"):
            self.assertEqual(mutants(nothing), [])


if __name__ == "__main__":
    unittest.main()
