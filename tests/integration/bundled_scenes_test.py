#!/usr/bin/env python3
"""The bundled scenes pass their own validator and are what their users count on: rooms, items, classes, and the two rings
of large_building. They pass without the furniture package as well."""
import concurrent.futures
import os
import re
import subprocess
from pathlib import Path

import chain

FURNITURE = {"installed": (), "parametric": chain.NO_FURNITURE}
IS_INSTALLED = Path("/usr/share/sweethome3d/furniture").is_dir()
JOBS = (("large_building", "installed"), ("large_building", "parametric"), ("apartment", "installed"),
        ("apartment", "parametric"), ("blank_corridor", "installed"), ("blank_corridor", "parametric"))


def figure(table, pattern):
    """First number that a line of the table has at the pattern's group."""
    found = re.search(pattern, table, re.MULTILINE)
    assert found, f"no {pattern} in\n{table}"
    return float(found.group(1))


class BundledScenesTest(chain.ChainTest):
    def validate(self, scene, furniture):
        out = self.folder / f"{scene}_{furniture}"
        out.mkdir()
        command = [chain.BIN / "lapis_simulator", scene, "--validate", *FURNITURE[furniture],
                   "--set", f"simulator.output_dir={out}", "--set", f"simulator.world.light_folder={out}"]
        result = subprocess.run(command, capture_output=True, text=True, check=False, timeout=500)
        return scene, furniture, out, result

    def test_every_scene_passes(self):
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            jobs = [pool.submit(self.validate, *job) for job in JOBS]
            results = [job.result() for job in jobs]
        for scene, furniture, out, result in results:
            with self.subTest(scene=scene, furniture=furniture):
                self.assertGreater((out / f"{scene}_navmap.png").stat().st_size, 1000)
                for row in ("starts", "rooms", "tour", "doors", "loops", "floating", "overlaps", "walls"):
                    self.assertRegex(result.stdout, rf"(?m)^OK +{row} ", result.stderr)
                if scene == "large_building":
                    self.assertRegex(result.stdout, r"(?m)^OK +corridors ", result.stdout)
                self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
                if furniture == "installed" and IS_INSTALLED:
                    self.assert_promises(scene, result.stdout)

    def assert_promises(self, scene, table):
        if scene == "apartment":
            self.assertEqual(figure(table, r"^OK +rooms +(\d+) rooms"), 7)
            self.assertGreaterEqual(figure(table, r"^OK +classes +(\d+) items"), 80)
            self.assertGreaterEqual(figure(table, r"^OK +classes .* (\d+) classes,"), 20)
        if scene == "large_building":
            self.assertGreaterEqual(figure(table, r"^OK +rooms +(\d+) rooms"), 14)
            rings = re.findall(r"^ +([0-9.]+) m around .*: (.*corridor_middle.*)$", table, re.MULTILINE)
            self.assertEqual(len(rings), 2, table)
            for length, _ in rings:
                self.assertTrue(20.0 <= float(length) <= 40.0, table)
            self.assertEqual(figure(table, r"^OK +loops +(\d+) of"), 2)
        if scene != "blank_corridor":
            share = figure(table, r"^OK +features +([0-9.]+) %")
            self.assertTrue(0.5 <= share <= 4.0, table)


if __name__ == "__main__":
    chain.main()
