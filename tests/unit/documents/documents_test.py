#!/usr/bin/env python3
"""Documents that are printed by the code stay equal to it, and every shipped configuration loads.

usage: documents_test.py REPOSITORY BIN_DIRECTORY
"""
import pathlib
import subprocess
import sys
import unittest

import yaml

REPOSITORY = pathlib.Path(sys.argv.pop(1))
BIN = pathlib.Path(sys.argv.pop(1))
COMPONENTS = ["sensor_replay", "recorder", "simulator", "slam", "segmenter", "semantic_mapper", "evaluator", "planner", "controller"]
KNOW_THE_ROBOT = ["simulator", "semantic_mapper", "planner", "controller"]


def output_of(*command):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, check=True).stdout


SHARED = ("dds.", "log.", "robot.", "lockstep.")  # sections that whoever has them gets from one place


def meanings_of(name):
    """Path and meaning of every key of a component outside of the shared sections."""
    rows = output_of(BIN / f"lapis_{name}", "--print-config-table").splitlines()[2:]
    keys = {row.split("`")[1]: row.removesuffix(" |").rsplit(" | ", 1)[1] for row in rows}
    return {path: meaning for path, meaning in keys.items() if not path.startswith(SHARED)}


def with_settings(configuration, settings):
    """A copy of a configuration in which the settings are as told."""
    changed = dict(configuration)
    for key, value in settings.items():
        changed[key] = with_settings(changed[key], value) if isinstance(value, dict) else value
    return changed


RENAMED = {  # keys of before, by the component that refuses them
    "controller": {"controller.local_map.passes_to_clear": "controller.local_map.misses_to_clear"},
    "semantic_mapper": {
        "semantic_mapper.obstacles.passes_to_clear": "semantic_mapper.obstacles.misses_to_clear",
        "semantic_mapper.sensor_model.pass_gain": "semantic_mapper.sensor_model.miss_gain",
    },
    "simulator": {"simulator.noise.wheels": "simulator.noise.odometry"},
    "planner": {
        "planner.hallucination.min_loop_way_m": "planner.hallucination.min_loop_path_m",
        "planner.sensor_model.pass_gain": "semantic_mapper.sensor_model.miss_gain",
    },
    "evaluator": {"evaluator.sensor_model.pass_gain": "semantic_mapper.sensor_model.miss_gain"},
}


class FormerKeys(unittest.TestCase):
    def test_each_is_refused_with_its_name_of_today(self):
        for name, keys in RENAMED.items():
            for former, now in keys.items():
                with self.subTest(former):
                    run = subprocess.run([BIN / f"lapis_{name}", "--set", f"{former}=1", "--check-config"],
                                         capture_output=True, text=True)
                    self.assertEqual(run.returncode, 2, run.stderr)
                    self.assertIn(f"{former}: is now '{now}'", run.stdout + run.stderr)


class Facts(unittest.TestCase):
    """No fact is configured in two processes: what one has to know of another comes with the data.

    A copy gives itself away: it has name and meaning of the other key, or its meaning says that it is as a key of another
    component. Keys of one name that are about two things mean something else, and say so: max_stamp_difference_s is each
    component's own tolerance between the streams that it joins.
    """

    def test_no_two_components_have_a_key_of_one_name_and_meaning(self):
        first = {}
        for name in COMPONENTS:
            for path, meaning in meanings_of(name).items():
                other = first.setdefault((path.rsplit(".", 1)[1], meaning), path)
                self.assertEqual(other.split(".")[0], name, f"{path} and {other} say the same: {meaning}")

    def test_no_key_is_said_to_be_as_another_components(self):
        for name in COMPONENTS:
            for path, meaning in meanings_of(name).items():
                for other in set(COMPONENTS) - {name}:
                    self.assertNotRegex(meaning, rf"\bas {other}\.", f"{path} is a copy")


class Documents(unittest.TestCase):
    def test_topics_page_is_what_lapis_topics_prints(self):
        self.assertEqual((REPOSITORY / "docs/topics.md").read_text(), output_of(BIN / "lapis_topics"),
                         "renew it: build/release/bin/lapis_topics > docs/topics.md")

    def test_default_configurations_are_what_print_config_prints(self):
        for name in COMPONENTS:
            with self.subTest(name):
                file = REPOSITORY / f"config/default/{name}.yaml"
                self.assertEqual(file.read_text(), output_of(BIN / f"lapis_{name}", "--print-config"),
                                 f"renew it: build/release/bin/lapis_{name} --print-config > config/default/{name}.yaml")

    def test_every_shipped_configuration_loads(self):
        files = [f for f in sorted(REPOSITORY.glob("config/**/*.yaml")) if f.stem in COMPONENTS]
        self.assertGreaterEqual(len(files), len(COMPONENTS))
        for file in files:
            with self.subTest(str(file)):
                output_of(BIN / f"lapis_{file.stem}", "--config", file, "--check-config")

    def test_presets_of_methods_are_of_methods_and_are_shown(self):
        presets = sorted(REPOSITORY.glob("config/methods/*/*.yaml"))
        self.assertTrue(presets)
        for preset in presets:
            with self.subTest(str(preset)):
                name = preset.stem
                output_of(BIN / "lapis_planner", "--set", f"planner.method={preset.parent.name}", "--check-config")
                shown = yaml.safe_load(output_of(BIN / f"lapis_{name}", "--config", preset, "--print-config"))
                settings = yaml.safe_load(preset.read_text())
                self.assertEqual(list(settings), [name])
                self.assertEqual(with_settings(shown[name], settings[name]), shown[name])

    def test_the_robot_file_says_what_the_defaults_are(self):
        for name in KNOW_THE_ROBOT:
            with self.subTest(name):
                program = BIN / f"lapis_{name}"
                self.assertEqual(output_of(program, "--config", REPOSITORY / "config/robot.yaml", "--print-config"),
                                 output_of(program, "--print-config"))
                output_of(program, "--config", REPOSITORY / "config/robot_wide.yaml", "--check-config")

    def test_component_pages_list_every_configuration_key(self):
        for name in COMPONENTS:
            with self.subTest(name):
                page = (REPOSITORY / f"components/{name}/README.md").read_text()
                table = output_of(BIN / f"lapis_{name}", "--print-config-table")
                self.assertIn(table, page, f"renew the table: build/release/bin/lapis_{name} --print-config-table")


if __name__ == "__main__":
    unittest.main()
