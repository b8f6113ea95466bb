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
from page_recipes import engines, grasps, people, reliability, stability  # noqa: E402


class Pages(unittest.TestCase):
    def test_show_the_figures_and_charts_of_their_results_files(self):
        self.assertEqual(page_figures.wrong_pages() + page_figures.wrong_charts(), [])

    def test_were_measured_with_the_code_that_is_here(self):
        stale = [name for name in page_figures.measured() if page_figures.is_stale(name)]
        self.assertEqual(stale, [], "measure them again: scripts/figures --stale; or, if their figures cannot have changed: "
                         "scripts/figures --accept NAME --because REASON")

    def test_every_result_says_how_when_and_with_what_it_was_measured(self):
        for name in page_figures.measured():
            result = page_figures.load(name)
            self.assertEqual(result["command"], "scripts/figures --page " + name)
            self.assertEqual(result["sources"]["paths"], page_recipes.RECIPES[name].sources, name)
            self.assertEqual(list(result.get("charts", {})), list(page_recipes.RECIPES[name].charts), name)
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

    def test_a_chart_that_differs_is_drawn_by_no_recipe_or_is_shown_nowhere_is_named(self):
        def shown(*charts):
            page_figures.write("README.md", "".join("![](docs/images/%s.png)" % chart for chart in charts))
            return page_figures.wrong_charts()
        os.makedirs(os.path.join(self.root, "docs", "images"))
        for chart in ("speed", "old"):
            page_figures.write(page_figures.chart_path(chart), "drawn")
        page_figures.save("speed", page_figures.begin("speed", ["src"]), {}, {}, ["speed"])
        self.assertEqual(shown("speed", "mug"), [])
        self.assertEqual(shown("speed", "old"), ["docs/images/old.png: belongs to no results file: let a recipe draw it"])
        self.assertEqual(shown(), ["docs/figures/speed.json: docs/images/speed.png is shown on no page"])
        page_figures.write(page_figures.chart_path("speed"), "drawn by another hand")
        self.assertEqual(shown("speed"), ["docs/images/speed.png: differs from docs/figures/speed.json: "
                                          "draw it again with scripts/figures --page"])

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
        page_figures.accept("speed", "a name", ["src"])
        self.assertFalse(page_figures.is_stale("speed"))
        page_figures.write("src/a.cpp", "int renamed = 3;\n")
        self.assertTrue(page_figures.is_stale("speed"))
        page_figures.accept("speed", "not used here", ["src"])
        self.assertEqual([note["because"] for note in page_figures.load("speed")["accepted"]], ["a name", "not used here"])


class TestCaptures(unittest.TestCase):
    def test_a_set_is_reported_with_intervals_splits_and_what_was_held_out(self):
        root = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, root)
        head = ("engine,setting,split,lead,count,stayed,stayed_low,stayed_high,within_50mm,within_20mm,force_p90_N,"
                "within_50mm_low,within_50mm_high,within_20mm_low,within_20mm_high,captures")
        rows = ["none,rigid hand,all,,2,1,0,1,0.6,0.4,0,0.5,0.7,0.3,0.5,2"] + [
            "ours,implicit,%s,1,2,1,0,1,%s,0.5,17.7,0.6,0.8,0.4,0.6,2" % row
            for row in (("all", 0.7), ("person s1", 0.65), ("person s2", 0.75), ("object box", 0.7))] + [
                "ours,implicit,all,%s,2,1,0,1,0.61,0.5,17.7,0.6,0.8,0.4,0.6,2" % lead for lead in grasps.LEADS[1:]]
        for name, lines in (("windows.csv", ["window,seconds,mass_kg,set,person,object", "s1_box_use_01_3,1,1,artigrasp,s1,box",
                                             "s2_notebook_use_02_7,1,1,artigrasp,s2,box"]), ("real_grasps_arctic.csv", [head] + rows)):
            with open(os.path.join(root, name), "w", encoding="utf-8") as file:
                file.write("\n".join(lines) + "\n")
        told = ("s1_box_use_01_3   30 frames of   1 captures; within 50 mm  40 % (40 to 40), within 20 mm  20 % (20 to 20); ...\n"
                "s2_notebook_use_02_7   10 frames of   1 captures; within 50 mm  90 % (90 to 90), within 20 mm  80 % (80 to 80); ...\n"
                "windows lead 1   40 frames ...\n"
                "  against a rigid hand: within 20 mm +8 points (-4 to +13)\n")
        figures = grasps.captures_figures([[root, {"defaults": (root, told), "assist alone": (root, told)}]])
        self.assertEqual(figures["sets"].split("\n")[-1], "| ARCTIC | 2 (2) | 2, 1 | 70 % (60 to 80) | 50 % (40 to 60) | 18 N | "
                         "40 % (30 to 50) | +8 (-4 to +13) |")
        self.assertEqual(figures["chosen"], "90 % (90 to 90) and 80 % (80 to 80) in the 1 that the defaults were chosen on, "
                         "40 % (40 to 40) and 20 % (20 to 20) in the other 1")
        self.assertEqual(figures["settings"], "assist alone 70 % and 50 %, 18 N; `rigid` 60 % and 40 %")
        self.assertEqual((figures["person"], figures["object"]), ("s2 75 % (60 to 80), s1 65 % (60 to 80)", "box 70 % (60 to 80)"))
        self.assertEqual(figures["leads"], "; ".join(lead + " 61 % (60 to 80) and 50 % (40 to 60)" for lead in ("0.3 s", "3 s", "10 s", "clear")))


class TestRecordings(unittest.TestCase):
    def test_closings_are_counted_with_intervals_over_recordings(self):
        def closing(row, recording, held, early="2"):
            return {"row": row, "recording": recording, "held": held, "early_mm": early}
        events = [closing("pinch20", "a", "1"), closing("pinch20", "a", "0", "30"), closing("pinch30", "b", "1"),
                  closing("grab_cube60", "a", "0"), closing("pass_cube40", "a", "0"), closing("pass_cube60", "b", "1")]
        rows = [{"row": name, "object": "all", "held": "1", "events": "2", "force_p90_N": "16.6"}
                for name in grasps.PINCHES + grasps.GRABS]
        played = {label: (events, rows) for label in grasps.HANDS}
        figures = grasps.recordings_figures(played, {(30, 0): 4 * events, (30, 1): events, (30, 3): [], (30, 5): []})
        self.assertTrue(figures["hands"].split("\n")[2].startswith("| defaults | 1, 17 N | 1, 17 N |"), figures["hands"])
        # Of a, half is held, of b all: resampled 50 to 100 %; Wilson's interval of 2 of 3 begins at 21 %.
        self.assertIn("| pinch, cubes of 20 to 40 mm | 2 of 3 (21 to 100 %) |", figures["sums"])
        self.assertTrue(figures["in_place"].startswith("2 of 2 (34 to 100 %) and 0 of 1 (0 to 79 %)"), figures["in_place"])
        self.assertEqual(figures["noisy"].split("\n")[-1], "| 30 Hz | 2 | 0 | 0 | 0 |")  # mean of four seeds
        self.assertEqual(figures["open_hands"], "0 of 1 (0 to 79 %) and 1 of 1 (21 to 100 %)")


class TestPeople(unittest.TestCase):
    def test_figures_of_operators_are_the_ends_of_what_their_tests_print(self):
        figures = people.people_figures(
            "cube, veteran: 0.85 s, widest at 64 %, closed by 72 % before its end\n"
            "cube, beginner: 1.14 s, widest at 66 %, closed by 65 % before its end\n"
            "1.8 g, 400 g, 20 cm: grip 12.2 N, p90 14.2 N, load 7.1 N, r 0.98, margin 63 %\n"
            "0.0 g, 200 g, 20 cm: grip 3.7 N, p90 4.3 N, load 0.5 N, r 0.93, margin 91 %\n"
            "cube, beginner: grip 3.2 N, p90 3.4 N, 6 of 6 hold it\nflat_cuboid, veteran: grip 2.6 N, p90 2.8 N, 6 of 6 hold it\n"
            "a leap of 12 cm aside: noticed after 0.10 s, reach longer by 0.12 s\n"
            "a leap of 12 cm further: noticed after 0.10 s, reach longer by 0.24 s\n"
            "long_cuboid of size 2.0 after 0.0 s: noticed after 0.30 s, reach longer by 0.00 s\n"
            "long_cuboid of size 2.0 after 0.3 s: noticed after 0.26 s, reach longer by 0.13 s\n"
            "cube of size 0.5 after 0.3 s: noticed after 0.20 s, reach longer by 0.10 s\n")
        self.assertEqual(figures, {
            "widest": "64 to 66 %", "grip": "2.6 to 3.2 N", "correlation": "r = 0.93 to 0.98",
            "margin": "91 % at 0.5 N of load, 63 % at 7 N",
            "size": "after 0.20 to 0.30 s; reach at most 0.00 s longer (at its start), 0.13 s (0.3 s later)",
            "leap": "after 0.10 s; the reach takes 0.12 s longer (12 cm aside), 0.24 s (further)"})


class TestCutShort(unittest.TestCase):
    def test_small_heaps_are_told_apart_from_larger_ones_and_from_blocks_at_rest(self):
        rows = [dict(scene=scene, bodies_to=str(bodies), relative=str(relative), off_m_s=str(off)) for scene, bodies, relative, off in (
            ("heap", 8, 1e-5, 1e-6), ("heap", 16, 0.006, 1e-3), ("heap", 32, 0.21, 0.1), ("heap", 64, 0.25, 0.2),
            ("block", 16, 0.5, 2e-7), ("block", 64, 0.5, 1e-6))]
        self.assertEqual(engines.cut_short_figures(rows)["error"], "at most 1e-6 m/s at rest, 0.6 % of the change of velocity where "
                         "up to 16 bodies land on each other, and 21 to 25 % where more do")


class TestReliability(unittest.TestCase):
    def test_a_row_has_the_relay_s_times_and_each_answer_s_over_them(self):
        printed = ("| | arrived | message [kB] | p50 [ms] | p99 [ms] | max [ms] |\n|---|---|---|---|---|---|\n"
                   "| relay | 3600 of 3600 | 1.9 | 0.200 | 0.400 | 1.000 |\n"
                   "| hand to objects | 3600 of 3600 | 0.3 | 0.300 | 0.500 | 1.000 |\n"
                   "| hand to rendered_view | 3599 of 3600 | 2.7 | 0.250 | 0.600 | 1.000 |\n"
                   "processor time a frame: interaction_node 211 us, relay 128 us: 1.6 times\n")
        self.assertEqual(reliability.latency_row(printed), (
            "0.200, 0.400", "`objects` 0.300, 0.500 (1.50, 1.25); `rendered_view` 0.250, 0.600 (1.25, 1.50); 3599 of 3600 frames",
            "211, 128"))
        with self.assertRaises(page_recipes.MeasurementError):
            reliability.latency_row(printed.split("| hand")[0])


class TestStability(unittest.TestCase):
    def test_bounds_are_those_of_springs_and_dampers(self):
        cell = {"mass_kg": 1.0, "contacts": 4.0, "stiffness_n_m": 100.0}  # the springs' bound is 0.1 s, the dampers' 0.08198 s
        for step, springs, dampers in ((0.0819, False, False), (0.0821, False, True), (0.1001, True, True)):
            self.assertEqual((stability._beyond_springs(dict(cell, step_s=step)),
                              stability._beyond_dampers(dict(cell, step_s=step))), (springs, dampers), step)
        self.assertTrue(stability._is_grip(dict(cell, mass_kg=0.035)))  # 0.8 * 4 * 100 * 0.002 = 2 * 0.0356 * 9
        self.assertFalse(stability._is_grip(dict(cell, mass_kg=0.036)))


if __name__ == "__main__":
    unittest.main()
