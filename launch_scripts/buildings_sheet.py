#!/usr/bin/python3
"""Draws a contact sheet of generated buildings: of each one a plan, and a view of its largest room (docs/buildings.md).

usage: buildings_sheet.py PNG_FILE [--kinds KIND,...] [--first SEED] [--count N]

Seeds are those for tuning, below 10,000; the others are not to be looked at. The programs are those of build/release, or
of the folder in LAPIS_BIN.
"""

import math
import pathlib
import subprocess
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.image  # noqa: E402
import matplotlib.patches  # noqa: E402
import matplotlib.pyplot  # noqa: E402
import yaml  # noqa: E402

import buildings  # noqa: E402

FLOORS = {"hallway": "#f3ead2", "hall": "#e6e6e6", "bath": "#cfe6ee", "kitchen": "#f6dcc0", "living": "#dfe9cf",
          "dining": "#e6efd2", "bedroom": "#e4dcee", "children": "#efdce4", "office": "#dbe4f0", "meeting": "#d6ecdf",
          "storage": "#dedad2", "lounge": "#efe6c4", "ward": "#d8e8f4", "examination": "#dcf0ea", "waiting": "#f0ecd8"}
OPENINGS = {"door": "#b5651d", "passage": "#f3ead2", "window": "#4aa3df", "leaf": "#6b3a12"}
DPI = 100


def is_along_x(rooms, at):
    """Whether the wall nearest to a point runs along x."""
    best, along_x = math.inf, True
    for room in rooms:
        polygon = room["polygon"]
        for a, b in zip(polygon, polygon[1:] + polygon[:1]):
            axis = 0 if abs(b[0] - a[0]) > abs(b[1] - a[1]) else 1
            if not min(a[axis], b[axis]) <= at[axis] <= max(a[axis], b[axis]):
                continue
            distance = abs(at[1 - axis] - a[1 - axis])
            if distance < best:
                best, along_x = distance, axis == 0
    return along_x


def draw_opening(axes, rooms, opening):
    kind = next(kind for kind in OPENINGS if kind in opening)
    at, half = opening[kind], opening["width"] / 2
    along, across = ([at[0] - half, at[0] + half], [at[1]] * 2), ([at[0]] * 2, [at[1] - half, at[1] + half])
    axes.plot(*(along if is_along_x(rooms, at) else across), color=OPENINGS[kind], linewidth=2.5, solid_capstyle="butt",
              zorder=4)


def draw_plan(axes, scene):
    rooms = scene["rooms"]
    for room in rooms:
        axes.add_patch(matplotlib.patches.Polygon(room["polygon"], facecolor=FLOORS.get(room["type"], "#ffffff"),
                                                  edgecolor="#303030", linewidth=1.2, zorder=1))
    for item in scene.get("furniture", []):
        if "at" not in item:
            continue
        width, depth, height = item["size"]
        color, order = ("#f7f7f2", 2) if height < 0.03 else ("#8c8c8c", 3)
        patch = matplotlib.patches.Rectangle((-width / 2, -depth / 2), width, depth, linewidth=0.4, edgecolor="#404040",
                                             facecolor=color, zorder=order)
        turn = matplotlib.transforms.Affine2D().rotate_deg(item.get("yaw_deg", 0)).translate(*item["at"])
        patch.set_transform(turn + axes.transData)
        axes.add_patch(patch)
    for opening in scene["openings"]:
        draw_opening(axes, rooms, opening)
    corners = [corner for room in rooms for corner in room["polygon"]]
    axes.set_xlim(min(c[0] for c in corners) - 0.5, max(c[0] for c in corners) + 0.5)
    axes.set_ylim(min(c[1] for c in corners) - 0.5, max(c[1] for c in corners) + 0.5)
    axes.set_aspect("equal")


def view_of(name, room):
    """The colours of the snapshot of one room."""
    with tempfile.TemporaryDirectory() as folder:
        command = [buildings.SIMULATOR, name, "--snapshot", folder, "--set", f"simulator.world.light_folder={folder}"]
        subprocess.run(command, check=True, capture_output=True)
        picture = matplotlib.image.imread(pathlib.Path(folder) / f"{room}_1.png")
    return picture[:, : picture.shape[1] // 3]


def draw_sheet(file, rows):
    """A row of buildings for each kind. rows: lists of (name, scene file)."""
    columns = 2 * max(len(row) for row in rows)
    size = (2.7 * columns, 2.1 * len(rows))
    figure, grid = matplotlib.pyplot.subplots(len(rows), columns, figsize=size, dpi=DPI, squeeze=False)
    for axes in grid.flat:
        axes.axis("off")
    for line, row in zip(grid, rows):
        for index, (name, scene) in enumerate(row):
            plan, view = line[2 * index], line[2 * index + 1]
            total = sum(buildings.area_m2(room["polygon"]) for room in scene["rooms"])
            draw_plan(plan, scene)
            plan.set_title(f"{name}, {total:.0f} m²", fontsize=9)
            largest = max(scene["rooms"], key=lambda room: buildings.area_m2(room["polygon"]) * (room["type"] != "hallway"))
            view.imshow(view_of(name, largest["id"]))
    figure.tight_layout(pad=0.3)
    figure.savefig(file)


def main():
    options = buildings.arguments(__doc__)
    draw_sheet(options.file, [[(f"{kind}_{seed}", yaml.safe_load(buildings.draw(kind, seed))) for seed in options.seeds]
                              for kind in options.kinds])


if __name__ == "__main__":
    main()
