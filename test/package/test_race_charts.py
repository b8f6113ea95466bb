#!/usr/bin/env python3
"""The race's charts tell our two hands apart, and name every engine's version and the day."""
import os
import sys
import tempfile
import unittest

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(PACKAGE, "benchmark"))
import plot_speed_accuracy as plot  # noqa: E402
import race_tables  # noqa: E402

HEAD = "scene,engine,setting,step_s,us_per_step,us_per_step_p99,error,error_unit,failed,engine_version,date\n"
ROWS = (("mr_hand_interaction", "implicit", 2.0, "0.1.0"), ("mr_hand_interaction", "implicit; whole frame", 7.0, "0.1.0"),
        ("mr_hand_interaction", "implicit; shipped hand", 2.5, "0.1.0"),
        ("mr_hand_interaction", "implicit; shipped hand; whole frame", 8.0, "0.1.0"), ("mujoco", "default", 20.0, "3.12.1"))


class Charts(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.csv = os.path.join(holder.name, "speed_accuracy.csv")
        with open(self.csv, "w") as file:
            file.write(HEAD + "".join("pinch_swing,%s,%s,0.001,%g,9,0.05,mm,0,%s,2026-11-25\n" % row for row in ROWS))

    def test_the_paper_s_hand_by_its_step_and_the_shipped_one_by_the_whole_frame(self):
        curves = plot.by_curve(plot.read(self.csv))
        self.assertEqual({name: [row.time for row in rows] for name, rows in curves.items()},
                         {plot.OURS: [2.0], plot.SHIPPED: [8.0], "mujoco": [20.0]})
        self.assertEqual(plot.label_of(plot.SHIPPED), "ours, shipped hand, whole frame")

    def test_versions_and_day_are_in_the_footnote_and_charts_are_drawn(self):
        self.assertEqual(plot.footnote(plot.read(self.csv)), "ours 0.1.0, MuJoCo 3.12.1. 2026-11-25")
        self.assertEqual(plot.main(["plot", self.csv]), 0)
        self.assertIn("summary.png", os.listdir(os.path.dirname(self.csv)))

    def test_crowds_are_drawn_with_the_labels_of_their_table(self):
        folder = os.path.dirname(self.csv)
        with open(self.csv, "w") as file:
            file.write(HEAD + "".join("%s,ode,default,0.001,9,9,0.5,mm,0,0.16.2,2026-11-25\n" % scene
                                      for scene in ("crowd_flush_50", "crowd_wall_48_sunk")))
        with open(os.path.join(folder, "step_times.csv"), "w") as file:
            file.write("scene,engine,setting,step_s,us_mean,us_max\n" + "".join(
                "%s,ode,default,0.001,9,90\n" % scene for scene in ("crowd_flush_50", "crowd_wall_48")))
        rows, times = race_tables.read(folder)
        figure, axes = plot.plt.subplots()
        self.addCleanup(plot.plt.close, figure)
        plot.draw_crowd_panel(axes, times, rows, lambda *crowd: plot.crowd_error(rows, *crowd), "error [mm]")
        labels = [label.get_text() for label in axes.get_xticklabels()]
        self.assertEqual(labels, ["a wall of 48 bricks falls", "50 of them, no gaps"])
        self.assertEqual(labels, [line[0] for line in race_tables.crowds(rows, times)[1]])
        self.assertEqual(list(axes.lines[0].get_ydata()), [0.5, 0.5])
        plot.main(["plot", self.csv])
        self.assertIn("crowds.png", os.listdir(folder))


class Tables(unittest.TestCase):
    def test_the_fastest_and_the_most_accurate_peer_are_those_that_did_not_fail(self):
        def row(engine, setting, time, error, failed=False):
            return plot.Row("slap_speed", engine, setting, race_tables.STEP, time, time, error, "%", failed, "1", "2026-11-25")
        ours = [row(plot.OURS, setting, 1.0, 0.1) for setting in race_tables.HANDS.values()]
        peers = [row("ode", "", 2.0, 9.0, True), row("jolt", "", 3.0, 8.0), row("mujoco", "", 20.0, 0.0)]
        head, (line,) = race_tables.results(ours + peers)
        self.assertEqual(len(head), len(line))
        self.assertEqual(line[3:], ["Jolt 8, 3", "MuJoCo 0, 20"])

    def test_sentences_name_ours_beside_the_peer_that_did_not_fail(self):
        def row(engine, setting, step, time, error, failed=False):
            return plot.Row("pinch_swing", engine, setting, step, time, time, error, "mm", failed, "1", "2026-11-25")
        stiff, long, short = "; stiffness 2000000", race_tables.FRAME, race_tables.STEP
        rows = [row(plot.OURS, "implicit", short, 2.0, 0.1), row(plot.OURS, "implicit; whole frame", short, 7.0, 0.1),
                row(plot.OURS, "implicit" + stiff, long, 3.0, 0.02),
                row(plot.OURS, "implicit; shipped hand%s; whole frame" % stiff, long, 9.0, 0.03),
                row("ode", "", short, 1.0, 9.0, True), row("box3d", "", short, 5.0, 0.5), row("jolt", "", short, 8.0, 0.01),
                row("ode", "", long, 1.0, 0.0, True), row("box3d", "", long, 5.0, 0.5), row("jolt", "", long, 8.0, 0.01)]
        self.assertEqual(race_tables.long_steps(rows), "Jolt is off by 0.01 mm in 8 µs a step; ours at 2 000 000 N/m by 0.02 mm in "
                         "3 µs, with the shipped hand and its rendering by 0.03 mm in 9 µs")
        self.assertEqual(race_tables.whole_frame(rows), "2 µs and the whole frame 7 µs; the fastest peer's step takes 5 µs (Box3D)")

    def test_our_slowest_crowd_is_the_one_that_the_fastest_engine_beats_most(self):
        times = {(scene, engine, "implicit"): (time, time) for scene, engine, time in (
            ("crowd_heap_8", plot.OURS, 6.0), ("crowd_heap_8", "ode", 4.0), ("crowd_heap_8", "jolt", 2.0),
            ("crowd_wall_48", plot.OURS, 8.0), ("crowd_wall_48", "jolt", 4.0))}
        self.assertEqual(race_tables.slowest_crowd([], times), "3")

    def test_a_crowd_shows_an_engine_s_fastest_setting_that_did_not_fail(self):
        def row(setting, error, failed):
            return plot.Row("crowd_heap_8_sunk", "jolt", setting, 0.001, 1.0, 1.0, error, "mm", failed, "1", "2026-11-25")
        times = {("crowd_heap_8", "jolt", "a"): (1.0, 2.0), ("crowd_heap_8", "jolt", "b"): (5.0, 12345.0)}
        head, lines = race_tables.crowds([row("a", 9.0, True), row("b", 0.5, False)], times)
        self.assertEqual(head[1:], ["Jolt"])
        self.assertEqual(lines, [["8 dice dropped", "5, 12345; 0.5"]])


if __name__ == "__main__":
    unittest.main()
