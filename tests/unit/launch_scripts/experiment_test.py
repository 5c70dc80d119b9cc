#!/usr/bin/env python3
"""experiment.sh with programs that only pretend, and its statistics against brute force.

usage: experiment_test.py REPOSITORY
"""
import csv
import itertools
import math
import os
import signal
import subprocess
import sys
import unittest

from pretended_programs import REPOSITORY, PretendedPrograms

sys.path.insert(0, str(REPOSITORY / "launch_scripts"))
from experiments import tables  # noqa: E402  (after its place is known)
from experiments.protocol import scenes_of  # noqa: E402

PROTOCOL = """
name: trial
title: which is better?
buildings: [{names: "flat_[1-2]", duration_s: 20}, {names: clinic_7, duration_s: 40}]
methods:
  lapis: {method: lapis, then: none}
  near: {method: nearest, settings: {planner.criterion: a}}
figures: [lost_time_s]
"""


class ExperimentTest(PretendedPrograms):
    def setUp(self):
        super().setUp()
        (self.folder / "CMakeLists.txt").write_text("of all\n")
        (self.folder / "CMakePresets.json").write_text("{}\n")
        self.protocol = self.folder / "trial.yaml"
        self.protocol.write_text(PROTOCOL)
        self.table = self.folder / "docs/results/trial/rows.csv"

    def command(self, *options):
        return [self.folder / "launch_scripts/experiment.sh", self.protocol, *options]

    def experiment(self, *options, status=0):
        """What it prints, and what is played."""
        played = self.folder / "bin/played"
        played.unlink(missing_ok=True)
        result = subprocess.run(self.command(*options), env=self.environment(), capture_output=True, text=True, timeout=60)
        self.assertEqual(result.returncode, status, result.stdout + result.stderr)
        self.assertNotIn("Traceback", result.stderr)
        lines = played.read_text().splitlines() if played.exists() else []
        return result.stdout + result.stderr, [line.split()[0] for line in lines]

    def rows(self):
        with self.table.open(newline="") as stream:
            return list(csv.DictReader(stream))

    def test_all_methods_of_a_building_come_before_the_next_and_each_run_is_a_row(self):
        output, played = self.experiment()
        self.assertEqual(played, ["flat_1/lapis/1", "flat_1/nearest/1", "flat_2/lapis/1", "flat_2/nearest/1",
                                  "clinic_7/lapis/1", "clinic_7/nearest/1"])
        self.assertIn("[6/6] clinic_7, near, seed 1: done", output)
        self.assertIn("6 of 6 runs have a row", output)
        self.assertEqual([(row["scene"], row["method"], row["outcome"]) for row in self.rows()[:2]],
                         [("flat_1", "lapis", "completed"), ("flat_1", "near", "completed")])
        for name in ("tables.md", "tables.tex", "tables_1.csv"):
            self.assertTrue((self.table.parent / name).stat().st_size, name)

    def test_figures_and_a_report_stand_beside_the_rows(self):
        self.order(more={"keyframe_ate_se3_rmse_m": 0.01, "explored_share": 0.9, "full_iou_by_class": {
            "wall": {"iou": 0.5, "top8": True}, "sink": {"iou": 0.1, "top8": False}}})
        self.protocol.write_text(PROTOCOL + "tests: [{figure: keyframe_ate_se3_rmse_m, method: lapis, against: near, ratio: 0.6}]\n"
                                 "conditions: [{figure: explored_share, method: lapis, against: near, least_ratio: 0.97}]\n")
        self.experiment()
        for name in ("runs", "classes"):
            for extension in ("png", "pdf", "svg"):
                self.assertTrue((self.table.parent / f"figures/{name}.{extension}").stat().st_size, name)
        report = (self.table.parent / "report.md").read_text()
        self.assertIn("lapis has 1.00 times that of near (median of 3 pairs; 90 % interval 1.00 to 1.00), and is better in 0. "
                      "p = 1.0000 after Holm's correction: no difference is shown. Expected was 0.60, outside", report)
        self.assertIn("it holds", report)
        self.assertNotIn("Not complete", report)
        self.assertEqual([line.rpartition("(")[2] for line in report.splitlines() if line.startswith("![") and "flat" in line],
                         [f"figures/{name}_flat_1_{label}_1.png)" for label in ("lapis", "near")
                          for name in ("map_error", "beside_truth")])
        self.assertEqual(self.rows()[0]["full_iou.wall"], "0.5")
        self.assertNotIn("full_iou.sink", self.rows()[0])
        before = {file: file.read_bytes() for file in self.table.parent.rglob("*") if file.is_file()}
        self.experiment("--table")
        self.assertEqual({file: file.read_bytes() for file in before}, before)

    def test_what_has_a_row_is_not_played_again_and_gives_the_same_table(self):
        self.experiment()
        before = (self.table.parent / "tables.md").read_text()
        output, played = self.experiment()
        self.assertEqual(played, [])
        self.assertIn("6 of them have a row", output)
        self.assertEqual((self.table.parent / "tables.md").read_text(), before)
        rows = self.table.read_text().splitlines()
        self.table.write_text("\n".join(rows[:3] + rows[4:]) + "\n")
        self.assertEqual(self.experiment()[1], ["flat_2/lapis/1"])
        self.assertEqual((self.table.parent / "tables.md").read_text(), before)

    def test_other_sources_or_settings_are_other_runs_and_stay_apart(self):
        self.experiment()
        (self.folder / "components/other.hpp").write_text("// new\n")
        os.utime(self.folder / "components/other.hpp", (1, 1))
        self.assertIn("0 of 6 runs have a row", self.experiment("--table")[0])
        key = self.rows()[0]["key"]
        self.assertIn("| lapis | 2 |", self.experiment("--table", "--keys", key)[0], "another duration is another key")
        self.assertEqual(len(self.experiment()[1]), 6)
        self.assertEqual(len(self.rows()), 12)
        self.protocol.write_text(PROTOCOL.replace("criterion: a", "criterion: t"))
        self.assertEqual(self.experiment()[1], ["flat_1/nearest/1", "flat_2/nearest/1", "clinic_7/nearest/1"])

    def test_sources_that_no_program_knows_are_refused(self):
        (self.folder / "components/other.hpp").write_text("// new\n")
        os.utime(self.folder / "components/other.hpp", (4e9, 4e9))
        output, played = self.experiment(status=2)
        self.assertIn("other.hpp is newer than the programs", output)
        self.assertEqual(played, [])

    def test_a_run_that_fails_counts_as_a_failure_and_is_repeated_only_on_request(self):
        self.order(status={"flat_1/lapis/1": 1, "flat_2/nearest/1": 137})
        output, _ = self.experiment(status=1)
        self.assertIn("flat_1, lapis, seed 1: FAILED, status 1", output)
        self.assertRegex(output, r"\| lapis \| 3 \| 1 \|")
        self.assertRegex(output, r"\| near \| 3 \| 1 \|")
        self.order()
        self.assertEqual(self.experiment()[1], [])
        self.assertEqual(self.experiment("--repeat-failed")[1], ["flat_1/lapis/1", "flat_2/nearest/1"])
        self.assertNotIn("FAILED", [row["outcome"] for row in self.rows()])

    def test_a_bad_set_up_ends_the_experiment_and_is_no_failure_of_a_method(self):
        self.order(status={"flat_1/nearest/1": 2})
        output, played = self.experiment(status=2)
        self.assertEqual(played, ["flat_1/lapis/1", "flat_1/nearest/1"])
        self.assertIn("flat_1, near, seed 1 cannot run as the protocol says", output)
        self.assertEqual([row["method"] for row in self.rows()], ["lapis"])

    def test_a_figure_that_no_run_has_is_named(self):
        self.protocol.write_text(PROTOCOL.replace("[lost_time_s]", "[lost_time]"))
        self.assertIn("no row has the figure lost_time\n", self.experiment()[0])

    def test_an_interrupted_run_has_no_row_and_what_it_started_ends(self):
        self.order(slow=["flat_1/nearest/1"])
        with subprocess.Popen(self.command(), env=self.environment(), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True) as process:
            (self.folder / "bin/gate_1").open().close()
            process.send_signal(signal.SIGTERM)
            self.assertEqual(process.wait(30), 143, process.stdout.read())
        self.assertTrue((self.folder / "bin/ended_1").exists())
        self.assertEqual([row["method"] for row in self.rows()], ["lapis"])

    def test_bad_protocols_are_refused_with_the_key(self):
        for text, problem in (("", "wanted"), ("name: x\n", "is missing"), (PROTOCOL + "buildings_: 1\n", "no such key"),
                              (PROTOCOL.replace("method: lapis", "mehtod: lapis"), "methods.lapis"),
                              (PROTOCOL + "tests: [{figure: x, method: lapis, against: none}]\n", "against none"),
                              (PROTOCOL.replace("duration_s: 40", "seconds: 40"), "buildings[1]"),
                              (PROTOCOL.replace("duration_s: 40", "duration_s: soon"), "buildings[1].duration_s"),
                              (PROTOCOL + "seeds: 3\n", "seeds: wanted is a list"), (PROTOCOL + "world: mars\n", "mars.yaml"), ("a: [", "trial.yaml")):
            self.protocol.write_text(text)
            output, played = self.experiment(status=2)
            self.assertEqual(played, [])
            self.assertIn(problem, output if problem != "wanted" else output + "wanted", text)
            self.assertTrue(output.startswith("experiment.sh: "), output)


class StatisticsTest(unittest.TestCase):
    def test_a_range_is_written_out(self):
        self.assertEqual(scenes_of("flat_[9-11]x"), ["flat_9x", "flat_10x", "flat_11x"])
        self.assertEqual(scenes_of("apartment"), ["apartment"])

    def test_wilcoxon_is_that_of_all_signs(self):
        differences = [0.3, -1.2, 2.5, 0.7, 1.9, -0.1, 3.3, 0.9]
        order = sorted(range(8), key=lambda i: abs(differences[i]))
        rank = {i: r + 1 for r, i in enumerate(order)}
        seen = sum(rank[i] for i in range(8) if differences[i] > 0)
        sums = [sum(r for r, sign in zip(range(1, 9), signs) if sign) for signs in itertools.product((0, 1), repeat=8)]
        tail = min(sum(s >= seen for s in sums), sum(s <= seen for s in sums)) / len(sums)
        self.assertAlmostEqual(tables.wilcoxon(differences), min(1.0, 2 * tail))

    def test_a_failure_has_the_highest_rank_whatever_it_is_measured_in(self):
        self.assertEqual(tables.wilcoxon([0.1, 0.2, 0.3, 0.4, -math.inf]), tables.wilcoxon([0.1, 0.2, 0.3, 0.4, -0.5]))
        self.assertEqual(tables.wilcoxon([0.0, 0.0, 0.0]), 1.0)

    def test_holm(self):
        for found, expected in zip(tables.holm([0.01, 0.04, 0.03, 0.005]), [0.03, 0.06, 0.06, 0.02]):
            self.assertAlmostEqual(found, expected)

    def test_effects_of_failures(self):
        inf = math.inf
        self.assertEqual(list(tables.effects([1, inf, 1, inf], [1, 1, inf, inf], True)), [0, inf, -inf, 0])
        self.assertEqual(list(tables.effects([0.5, -inf, 0.5, -inf], [0.5, 0.5, -inf, -inf], True)), [0, -inf, inf, 0])
        self.assertEqual(list(tables.effects([0.5, -inf, 0.5, -inf], [0.4, 0.5, -inf, -inf], False)),
                         [0.5 - 0.4, -inf, inf, 0])

    def test_quantiles_with_failures(self):
        self.assertEqual(tables.quantile([1.0, 2.0, 4.0], 0.5), 2.0)
        self.assertEqual(tables.quantile([1.0, 2.0, math.inf, math.inf], 0.9), math.inf)
        self.assertEqual(tables.quantile([1.0, 2.0, math.inf], 0.5), 2.0)
        self.assertEqual(tables.quantile([1.0, 3.0], 0.5), 2.0)

    def test_power_is_the_level_without_an_effect_and_grows_with_it(self):
        import contextlib  # pylint: disable=import-outside-toplevel
        import io  # pylint: disable=import-outside-toplevel
        protocol = {"name": "x", "tests": [{"figure": "f", "method": "a", "against": "b", "ratio": ratio, "deviation": 0.9}
                                           for ratio in (1.0, 0.8, 0.5)]}
        with contextlib.redirect_stdout(io.StringIO()) as output:
            tables.print_power(protocol, 40)
        power = [float(line.split("|")[6]) for line in output.getvalue().splitlines()[4:]]
        self.assertAlmostEqual(power[0], 0.05, delta=0.02)
        self.assertLess(power[0] + 0.1, power[1])
        self.assertGreater(power[2], 0.95)


if __name__ == "__main__":
    unittest.main(verbosity=2)
