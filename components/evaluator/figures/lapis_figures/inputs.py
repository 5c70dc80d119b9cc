"""Reads the files of a run folder that figures are drawn from."""

import csv
import json
import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np

ESTIMATE = "trajectory_estimate.txt"
TRUTH = "trajectory_ground_truth.txt"
MAX_GAP_S = 0.02  # as the evaluator: the nearest true pose must be closer than this
PLY_TYPES = {"float": "<f4", "double": "<f8", "uchar": "u1", "char": "i1", "ushort": "<u2", "short": "<i2",
             "uint": "<u4", "int": "<i4"}
PROGRAMS = Path(os.environ.get("LAPIS_BIN") or Path(__file__).resolve().parent.parent)


class MissingInput(Exception):
    """A file that a figure needs is absent or holds nothing to draw; the message names it."""


def read_trajectory(path):
    """TUM file to (stamps [n], positions [n, 3], quaternions xyzw [n, 4])."""
    if not path.is_file():
        raise MissingInput(f"{path.name} is missing")
    rows = [line.split() for line in path.read_text().splitlines() if line.strip() and not line.startswith("#")]
    if not rows:
        raise MissingInput(f"{path.name} holds no pose")
    try:
        table = np.array(rows, dtype=float).reshape(len(rows), 8)
    except ValueError as error:
        raise MissingInput(f"{path.name} is damaged ({error})") from error
    return table[:, 0], table[:, 1:4], table[:, 4:8]


def read_table(path):
    """CSV file to a list of rows, each a dictionary of texts."""
    if not path.is_file():
        raise MissingInput(f"{path.name} is missing")
    with path.open(newline="") as stream:
        return list(csv.DictReader(stream))


def numbers(rows, column, path):
    """A column of read_table [n]; NaN where a cell is empty."""
    try:
        return np.array([float(row[column]) if row[column] else np.nan for row in rows])
    except (KeyError, TypeError, ValueError) as error:
        raise MissingInput(f"{path.name} is damaged ({error})") from error


def read_map(path):
    """PLY points to (positions [n, 3], colours [n, 3] in 0..1, labels [n]), or None without a usable file."""
    if not path.is_file():
        return None
    data = path.read_bytes()
    head, separator, body = data.partition(b"end_header\n")
    lines = head.decode("ascii", "replace").splitlines()
    if not separator or "format binary_little_endian 1.0" not in lines:
        return None
    try:
        count = next(int(line.split()[2]) for line in lines if line.startswith("element vertex"))
        fields = [(line.split()[2], PLY_TYPES[line.split()[1]]) for line in lines if line.startswith("property")]
        vertices = np.frombuffer(body, dtype=np.dtype(fields), count=count)
        positions = np.stack([vertices[axis] for axis in "xyz"], axis=1).astype(float)
        colours = np.stack([vertices[name] for name in ("red", "green", "blue")], axis=1) / 255.0
        labels = vertices["label"].astype(int)
    except (StopIteration, KeyError, IndexError, ValueError):
        return None
    return (positions, colours, labels) if count else None


def read_map_file(path):
    """Map file (.lapis) to what read_map() gives, by way of the mapper's own tool."""
    tool = PROGRAMS / "lapis_semantic_mapper"
    with tempfile.TemporaryDirectory() as folder:
        points = Path(folder) / "map.ply"
        try:
            result = subprocess.run([tool, "convert", path, points], capture_output=True, text=True, check=False)
        except OSError as error:
            raise MissingInput(f"{tool}, which reads {path.name}, cannot be run: {error.strerror}") from error
        read = read_map(points)
    if read is None:
        raise MissingInput(f"{path.name} holds no map that can be read: {result.stderr.strip()}")
    return read


def read_pose_graph(path):
    """g2o file to (positions [n, 3], edges [m, 2] as indices of positions)."""
    if not path.is_file():
        raise MissingInput(f"{path.name} is missing")
    rows = [line.split() for line in path.read_text().splitlines()]
    try:
        vertices = [row for row in rows if row and row[0] == "VERTEX_SE3:QUAT"]
        index = {int(row[1]): i for i, row in enumerate(vertices)}
        positions = np.array([row[2:5] for row in vertices], dtype=float).reshape(len(vertices), 3)
        edges = [(index[int(row[1])], index[int(row[2])]) for row in rows if row and row[0] == "EDGE_SE3:QUAT"]
    except (IndexError, KeyError, ValueError) as error:
        raise MissingInput(f"{path.name} is damaged ({error})") from error
    if not vertices:
        raise MissingInput(f"{path.name} holds no pose")
    return positions, np.array(edges, dtype=int).reshape(len(edges), 2)


def class_names(run):
    """Names by class id, from what the simulator or a recording says of them; empty when nothing does."""
    try:
        classes = json.loads((run / "ground_truth/classes.json").read_text())["classes"]
        return {int(c["id"]): str(c["name"]) for c in classes}
    except (OSError, ValueError, KeyError, TypeError):
        return {}


def metric(run, key):
    """A figure of metrics.json; None where that does not say."""
    try:
        return json.loads((run / "metrics.json").read_text())[key]
    except (OSError, ValueError, KeyError, TypeError):
        return None


def interpolate(stamps, positions, quaternions, at):
    """True poses at the stamps `at` (linear, slerp), and a mask of those that exist."""
    after = np.clip(np.searchsorted(stamps, at), 0, len(stamps) - 1)
    before = np.where(stamps[after] == at, after, np.maximum(after - 1, 0))
    gap = np.minimum(np.abs(stamps[after] - at), np.abs(at - stamps[before]))
    valid = (gap < MAX_GAP_S) & (at >= stamps[0]) & (at <= stamps[-1])
    span = np.where(stamps[after] > stamps[before], stamps[after] - stamps[before], 1.0)
    share = ((at - stamps[before]) / span)[:, None]
    p = (1 - share) * positions[before] + share * positions[after]
    a, b = quaternions[before], quaternions[after]
    dot = np.sum(a * b, axis=1, keepdims=True)
    b = np.where(dot < 0, -b, b)
    angle = np.arccos(np.clip(np.abs(dot), 0, 1))
    sine = np.where(angle > 1e-6, np.sin(angle), 1.0)
    weights = np.where(angle > 1e-6, np.sin((1 - share) * angle) / sine, 1 - share), \
        np.where(angle > 1e-6, np.sin(share * angle) / sine, share)
    return p, weights[0] * a + weights[1] * b, valid


def heading_error(estimate, truth):
    """Turn about z [rad] in R_estimate * R_truth', from quaternions xyzw."""
    ax, ay, az, aw = estimate.T
    bx, by, bz, bw = -truth[:, 0], -truth[:, 1], -truth[:, 2], truth[:, 3]
    w = aw * bw - ax * bx - ay * by - az * bz
    z = aw * bz + ax * by - ay * bx + az * bw
    return (2 * np.arctan2(z, w) + np.pi) % (2 * np.pi) - np.pi
