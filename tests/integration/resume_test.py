#!/usr/bin/env python3
"""A recording goes on in the map of an earlier run: slam finds its place there, and the others take the new session."""
import chain

FIRST_S = 5


class ResumeTest(chain.ChainTest):
    def test_goes_on_in_the_run_folder_of_before(self):
        first = self.play(chain.AWS, "run", "--duration", str(FIRST_S))
        saved = (first / "slam.lapis").read_bytes()
        poses = (first / "keyframes.txt").read_text().splitlines()
        kept = self.folder / "kept.lapis"
        kept.write_bytes(saved)

        second = self.play(chain.AWS, "run", "--start", str(FIRST_S), "--duration", "3",
                           "--set", f"slam.resume_from={first / 'slam.lapis'}")
        metrics = chain.metrics_of(second)
        self.assertEqual(metrics["exit_reason"], "completed")
        self.assertEqual(metrics["frames_tracked"], metrics["frames_total"] - 2, "two frames confirm the place")
        self.assertGreater(len((second / "slam.lapis").read_bytes()), len(saved))
        keyframes = (second / "keyframes.txt").read_text().splitlines()
        stamps = [line.split()[0] for line in poses if not line.startswith("#")]
        self.assertEqual([line.split()[0] for line in keyframes if not line.startswith("#")][:len(stamps)], stamps)
        self.assertFalse((second / "slam.1.lapis").exists())

        again = self.play(chain.AWS, "again/run", "--start", str(FIRST_S), "--duration", "3",
                          "--set", f"slam.resume_from={kept}")
        self.assert_same_run(second, again)


if __name__ == "__main__":
    chain.main()
