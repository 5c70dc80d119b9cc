#!/usr/bin/env python3
"""compare.sh: variants side by side, what is done is not done again, and a run that fails is reported."""
import chain


class CompareTest(chain.ChainTest):
    def compare(self, *variants, status=0):
        options = [option for variant in variants for option in ("--variant", variant)]
        command = [chain.REPOSITORY / "launch_scripts/compare.sh", "--data", chain.recording(), "--out",
                   self.folder / "compare", *options]
        run = chain.Process(command, self.folder / "compare.log")
        self.addCleanup(run.kill)
        self.assertEqual(run.wait(150), status, run.output())
        return run.output()

    def test_variants_stand_side_by_side_and_are_played_once(self):
        log_odds, coarse = "log_odds", "coarse semantic_mapper.resolution_m=0.5"
        first = self.compare(log_odds, coarse)
        self.assertIn("flat_tour, log_odds\n", first)
        self.assertIn("flat_tour, coarse\n", first)
        rows = [line for line in first.splitlines() if line.startswith("| flat_tour |")]
        self.assertEqual([row.split(" | ")[1] for row in rows], ["log_odds", "coarse"], first)
        errors = [chain.metrics_of(self.folder / "compare" / name / "flat_tour")["map_error_mean_m"]
                  for name in ("log_odds", "coarse")]
        for row, error in zip(rows, errors):
            self.assertIn(f" {100 * error:.2f} |", row)
        self.assertIn(f"| map error cm | coarse | 1 | {100 * (errors[1] - errors[0]):+.4f} |", first)
        again = self.compare(log_odds, coarse)
        self.assertNotIn("flat_tour, ", again)
        for row in rows:
            self.assertIn(row, again)

    def test_a_variant_that_cannot_run_is_reported(self):
        output = self.compare("good", "bad semantic_mapper.resolution_m=7", status=1)
        self.assertIn("semantic_mapper.resolution_m", output)


if __name__ == "__main__":
    chain.main()
