#!/usr/bin/env python3
"""Two runs in one DDS domain do not disturb each other, and both say that they are not alone."""
import chain

NOTICE = "is in DDS domain"


class TwoRunsTest(chain.ChainTest):
    # The folders have the same last name, because a figure has it in its title.
    def test_each_is_as_if_it_were_alone(self):
        alone = self.play(chain.recording(), "alone/run")
        runs = [chain.replay(chain.recording(), self.folder / name / "run") for name in ("first", "second")]
        for run in runs:
            self.addCleanup(run.kill)
        for run in runs:
            self.assertEqual(run.wait(120), 0, run.output())
            self.assert_no_orphan(run)
            notices = [line for line in run.lines() if NOTICE in line]
            self.assertEqual(len(notices), 1, run.output())
            self.assertIn("ROS_DOMAIN_ID", notices[0])
        for name in ("first", "second"):
            self.assert_same_run(alone, self.folder / name / "run")


if __name__ == "__main__":
    chain.main()
