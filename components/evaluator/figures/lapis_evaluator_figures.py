#!/usr/bin/python3
"""Draws the figures of a run folder: map, its error, trajectory, pose graph, coverage, errors, progress, IoU by class, a decision.

A figure whose input files are missing is left out, with a line saying which file; exit status 0 when at least one
figure was drawn, 1 when none was, 2 when the folder does not exist.
"""
import argparse
import sys
from pathlib import Path

from lapis_figures.against_truth import draw_beside_truth, draw_map_error
from lapis_figures.classes import draw_class_iou
from lapis_figures.decision import DECISIONS, draw_decision
from lapis_figures.inputs import MissingInput
from lapis_figures.plans import draw_classes, draw_pose_graph, draw_trajectory
from lapis_figures.progress import draw_coverage, draw_errors, draw_progress
from lapis_figures.style import FORMATS, save

FIGURES = {"map": draw_classes, "map_error": draw_map_error, "beside_truth": draw_beside_truth,
           "trajectory": draw_trajectory, "pose_graph": draw_pose_graph, "coverage": draw_coverage, "errors": draw_errors,
           "progress": draw_progress, "class_iou": draw_class_iou, "decision": draw_decision}


def parse():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("run", type=Path, help="run folder")
    parser.add_argument("--formats", nargs="+", choices=FORMATS, default=["png"], help="of the files; default: png")
    parser.add_argument("--only", nargs="+", choices=FIGURES, default=list(FIGURES), metavar="NAME",
                        help=f"these figures alone: {', '.join(FIGURES)}")
    return parser.parse_args()


def main():
    options = parse()
    run = options.run
    if not run.is_dir():
        print(f"figures: {run} is not a folder; give the run folder that the evaluator wrote", file=sys.stderr)
        return 2
    folder = run / "figures"
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        print(f"figures: cannot create {folder}: {error.strerror}", file=sys.stderr)
        return 2
    drawn = 0
    for name in options.only:
        if name == "decision" and not (run / DECISIONS).exists():
            continue  # a run without a planner
        try:
            save(FIGURES[name](run), folder, name, options.formats)
            drawn += 1
        except MissingInput as missing:
            print(f"figures: {name} left out: {missing}", file=sys.stderr)
        except OSError as error:
            print(f"figures: {name} cannot be written: {error.strerror}", file=sys.stderr)
    return 0 if drawn else 1


if __name__ == "__main__":
    sys.exit(main())
