#!/usr/bin/env python3
"""What README and docs say was measured is what the results files hold, measured with the code as it is."""
import os
import re
import shutil
import sys
import tempfile
import unittest

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(PACKAGE, "scripts"))
import page_figures  # noqa: E402
import page_recipes  # noqa: E402


class Pages(unittest.TestCase):
    def test_show_the_figures_of_their_results_files(self):
        self.assertEqual(page_figures.wrong_pages(), [])

    def test_were_measured_with_the_code_that_is_here(self):
        stale = [name for name in page_figures.measured() if page_figures.is_stale(name)]
        self.assertEqual(stale, [], "measure them again: scripts/figures --stale; or, if their figures cannot have changed: "
                         "scripts/figures --accept NAME --because REASON")

    def test_every_result_says_how_when_and_with_what_it_was_measured(self):
        for name in page_figures.measured():
            result = page_figures.load(name)
            self.assertEqual(result["command"], "scripts/figures --page " + name)
            self.assertEqual(result["sources"]["paths"], page_recipes.RECIPES[name].sources, name)
            self.assertTrue(re.match(r"\d{4}-\d\d-\d\d$", result["date"]), result["date"])
            self.assertTrue(result["revision"])


class Mechanism(unittest.TestCase):
    """On a package of its own."""

    def setUp(self):
        self.root, self.before = tempfile.mkdtemp(), page_figures.PACKAGE
        self.addCleanup(shutil.rmtree, self.root)
        self.addCleanup(setattr, page_figures, "PACKAGE", self.before)
        page_figures.PACKAGE = self.root
        for path, text in (("README.md", "It takes <!-- figure speed/step -->9 s<!-- /figure -->.\n"),
                           ("src/a.cpp", "int a = 1;  // one\n"), (os.path.join("docs", "page.md"), "")):
            os.makedirs(os.path.dirname(os.path.join(self.root, path)) or self.root, exist_ok=True)
            page_figures.write(path, text)
        os.makedirs(os.path.join(self.root, page_figures.RESULTS))
        page_figures.save("speed", page_figures.begin("speed", ["src"]), {"step": "2 s"}, {})

    def test_a_page_that_differs_from_its_file_is_named_and_mended(self):
        self.assertEqual(len(page_figures.wrong_pages()), 1)
        self.assertIn("README.md: figure speed/step differs", page_figures.wrong_pages()[0])
        page_figures.show("speed")
        self.assertEqual(page_figures.wrong_pages(), [])
        self.assertIn("takes <!-- figure speed/step -->2 s<!-- /figure -->.", page_figures.read("README.md"))

    def test_a_figure_without_a_file_and_a_result_without_a_page_are_named(self):
        page_figures.write("README.md", "<!-- figure speed/turn -->1<!-- /figure -->")
        self.assertEqual([line.split(": ")[1].split(" ")[0] for line in page_figures.wrong_pages()], ["figure", "step"])

    def test_changed_code_makes_a_file_stale_and_a_comment_does_not(self):
        page_figures.write("src/a.cpp", "// first\nint a\n    = 1;\n")
        self.assertFalse(page_figures.is_stale("speed"))
        page_figures.write("src/a.cpp", "int a = 2;\n")
        self.assertTrue(page_figures.is_stale("speed"))
        page_figures.write("src/a.cpp", "int a = 1;\n")
        page_figures.write("src/b.cpp", "int b;\n")
        self.assertTrue(page_figures.is_stale("speed"))

    def test_code_that_is_accepted_is_not_stale_until_it_changes_again(self):
        page_figures.write("src/a.cpp", "int renamed = 1;\n")
        page_figures.accept("speed", "a name")
        self.assertFalse(page_figures.is_stale("speed"))
        self.assertEqual(page_figures.load("speed")["accepted"]["because"], "a name")
        page_figures.write("src/a.cpp", "int renamed = 3;\n")
        self.assertTrue(page_figures.is_stale("speed"))


if __name__ == "__main__":
    unittest.main()
