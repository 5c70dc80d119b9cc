#!/usr/bin/python3
"""The chain maps by the labels of a network what it maps by those of the data set, to the byte."""
import csv
import itertools
import re
import shutil

import numpy
from PIL import Image

import chain

DURATION_S = 2
LEVELS = (32, 96, 160, 224)  # of a channel; a class is a mixture, and the picture's own grey moves it by less than half a step
GREY_SHARE = 0.2
UNLABELLED = 0


class SegmenterTest(chain.ChainTest):
    def classes(self, source):
        """Names of the classes by id."""
        with open(source / "classes.csv", encoding="utf-8", newline="") as file:
            return {int(row["class_id"]): row["class"] for row in csv.DictReader(file)}

    def coloured(self, source):
        """A copy of the recording in which each class has a colour of its own; its folder, and the classes' ids in order."""
        folder = self.folder / "coloured"
        shutil.copytree(source, folder, ignore=shutil.ignore_patterns("rgb"))
        (folder / "rgb").mkdir()
        labels = {file.name: numpy.asarray(Image.open(file)) for file in sorted((folder / "label").iterdir())}
        ids = [int(i) for i in numpy.unique(numpy.concatenate([numpy.unique(image) for image in labels.values()]))]
        colors = numpy.array(list(itertools.product(LEVELS, repeat=3))[: len(ids)])
        self.assertEqual(len(colors), len(ids), "more classes than colours")
        for name, label in labels.items():
            grey = numpy.asarray(Image.open(source / "rgb" / name).convert("L"), dtype=float) - 127.5
            image = colors[numpy.searchsorted(ids, label)] + GREY_SHARE * grey[..., None]
            Image.fromarray(image.round().astype(numpy.uint8)).save(folder / "rgb" / name)
        return folder, ids, colors

    def model(self, source, ids, colors):
        """A model file whose network finds these colours."""
        size = [int(re.search(rf"^{key}: (\d+)", (source / "camera.yaml").read_text(), re.M)[1])
                for key in ("width", "height")]
        names = self.classes(source)
        labels = self.folder / "labels.yaml"
        labels.write_text("\n".join(
            ["labels:", *(f"  - {{id: {i}, name: {name}}}" for i, name in names.items() if i != UNLABELLED), ""]))
        return chain.color_model(self.folder / "model", size, colors,
                                 {index: names[i] for index, i in enumerate(ids) if i != UNLABELLED}, labels)

    def test_labels_of_a_network_make_the_map_of_the_same_labels(self):
        source, ids, colors = self.coloured(chain.recording())
        options = ("--labels", source / "classes.csv", "--duration", str(DURATION_S))
        by_data_set = self.play(source, "data_set/run", *options)
        by_network = self.play(source, "network/run", *options, "--segmenter", self.model(source, ids, colors))
        self.assertEqual((by_network / "map.lapis").read_bytes(), (by_data_set / "map.lapis").read_bytes())
        self.assert_same_run(by_data_set, by_network, ("trajectory_estimate.txt", "map.ply", "reference_map.lapis"))
        log = (by_network / "logs/segmenter.log").read_text()
        print("figure: cost of the network:", re.findall(r"\d+ images labelled, .*", log)[-1])
        self.assertNotRegex(log, "dropped: (?!stamp was there before)")  # a tick may come again


if __name__ == "__main__":
    chain.main()
