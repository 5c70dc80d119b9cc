"""How well the classes of the map agree with the reference."""

import json

import numpy as np

from lapis_figures.inputs import MissingInput
from lapis_figures.style import BLUE, GREY, ORANGE, plt


def draw_class_iou(run):
    path = run / "metrics.json"
    if not path.is_file():
        raise MissingInput("metrics.json is missing")
    try:
        metrics = json.loads(path.read_text())
    except ValueError as error:
        raise MissingInput(f"metrics.json is damaged ({error})") from error
    classes = metrics.get("iou_by_class")
    if not classes:
        raise MissingInput("metrics.json has no iou_by_class (not measured)")
    names = list(classes)
    values = [classes[name]["iou"] for name in names]
    is_top = [classes[name]["top8"] for name in names]
    figure, axes = plt.subplots(figsize=(9, 1.4 + 0.36 * len(names)))
    rows = np.arange(len(names))
    axes.barh(rows, values, color=[BLUE if top else GREY for top in is_top], height=0.7)
    for row, name in enumerate(names):
        axes.text(values[row] + 0.01, row, f"{values[row]:.2f}  ({classes[name]['reference_voxels']} voxels)",
                  va="center", fontsize=9, bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0})
    mean = metrics.get("iou_top8_mean")
    if mean is not None:
        axes.axvline(mean, color=ORANGE, linewidth=1.4, linestyle="--")
        axes.set_title(f"IoU by class; mean of the 8 most frequent (blue, dashed line): {mean:.3f}")
    axes.set_yticks(rows, names)
    axes.invert_yaxis()
    axes.set_xlim(0, 1.18)
    axes.set_xticks(np.arange(0, 1.01, 0.2))
    axes.set_xlabel("intersection over union")
    axes.grid(axis="x", color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    return figure
