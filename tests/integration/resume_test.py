#!/usr/bin/env python3
"""A recording continues in an earlier run's maps: slam finds its place there, and the others take the new session."""
import json
import subprocess

import chain

FIRST_S = 5


def frames_in(map_file):
    """How many frames a saved semantic map is made of."""
    command = [chain.BIN / "lapis_semantic_mapper", "info", map_file, "--json"]
    result = subprocess.run(command, capture_output=True, text=True, check=True)
    return int(json.loads(result.stdout)["provenance"]["frames"])


class ResumeTest(chain.ChainTest):
    def test_resumes_in_the_run_folder_of_before(self):
        first = self.play(chain.recording(), "run", "--duration", str(FIRST_S))
        saved = (first / "slam.lapis").read_bytes()
        poses = (first / "keyframes.txt").read_text().splitlines()
        kept, kept_map = self.folder / "kept.lapis", self.folder / "kept_map.lapis"
        kept.write_bytes(saved)
        kept_map.write_bytes((first / "map.lapis").read_bytes())

        second = self.play(chain.recording(), "run", "--start", str(FIRST_S), "--duration", "3",
                           "--set", f"slam.resume_from={first / 'slam.lapis'}",
                           "--set", f"semantic_mapper.resume_from={first / 'map.lapis'}")
        metrics = chain.metrics_of(second)
        self.assertEqual(metrics["exit_reason"], "completed")
        self.assertEqual(metrics["frames_tracked"], metrics["frames_total"] - 2, "two frames confirm the place")
        self.assertGreater(len((second / "slam.lapis").read_bytes()), len(saved))
        keyframes = (second / "keyframes.txt").read_text().splitlines()
        stamps = [line.split()[0] for line in poses if not line.startswith("#")]
        self.assertEqual([line.split()[0] for line in keyframes if not line.startswith("#")][:len(stamps)], stamps)
        self.assertFalse((second / "slam.1.lapis").exists())
        self.assertGreater(frames_in(second / "map.lapis"), frames_in(kept_map), "the map has the frames of both runs")
        self.assertFalse((second / "map.1.lapis").exists())

        again = self.play(chain.recording(), "again/run", "--start", str(FIRST_S), "--duration", "3",
                          "--set", f"slam.resume_from={kept}", "--set", f"semantic_mapper.resume_from={kept_map}")
        self.assert_same_run(second, again)


if __name__ == "__main__":
    chain.main()
