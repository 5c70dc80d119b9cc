"""What figures have in common."""

import os

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of backend)

BLUE, ORANGE, GREY = "#1565c0", "#e65100", "#9e9e9e"
FORMATS = {"png": {"Software": None}, "pdf": {"CreationDate": None}, "svg": {"Date": None}}  # without date or version
matplotlib.rcParams["svg.hashsalt"] = "lapis"  # equal runs, equal bytes


def break_gaps(stamps, values):
    """The values with NaN rows put in where time jumps, so that lines do not bridge lost stretches."""
    steps = np.diff(stamps)
    gaps = np.flatnonzero(steps > max(0.5, 5 * np.median(steps))) + 1 if len(steps) else []
    return np.insert(stamps.astype(float), gaps, np.nan), np.insert(values.astype(float), gaps, np.nan, axis=0)


def save(figure, folder, name, formats=("png",)):
    """Written beside and renamed; equal runs give equal files."""
    try:
        for extension in formats:
            path = folder / f"{name}.{extension}"
            part = path.with_name(path.name + ".part")
            try:
                figure.savefig(part, format=extension, dpi=110, bbox_inches="tight", metadata=FORMATS[extension])
                os.replace(part, path)
            finally:
                part.unlink(missing_ok=True)
    finally:
        plt.close(figure)
