"""The decision with most candidates: where they are, and what each one costs and gives."""

import collections
import itertools
import json
import math
import textwrap

import numpy as np

from lapis_figures.inputs import ESTIMATE, MissingInput, numbers, read_table, read_trajectory
from lapis_figures.plans import finish_plan
from lapis_figures.style import BLUE, ORANGE, plt

DECISIONS, DECISION_PLAN = "decisions.csv", "decision.json"
OTHER_METHODS = (("s", BLUE), ("D", "#6a1b9a"), ("^", "#2e7d32"), ("v", "#c62828"), ("p", "#00838f"))
DECISION_BARS = (("utility", "utility"), ("path_information_nats", "information\nof the path\n[nat]"),
                 ("cost_m", "cost [m]"), ("d_optimality", "D-optimality"))
CHOSEN_BY = "is_chosen_by_"  # and a method: a column of decisions.csv


def read_decision_plan(run):
    """What the planner knew at the decision with most candidates; None where it left no such file, as it did before."""
    path = run / DECISION_PLAN
    try:
        return json.loads(path.read_text()) if path.is_file() else None
    except ValueError as error:
        raise MissingInput(f"{path.name} is damaged ({error})") from error


def shown_decision(rows, number):
    """Rows of a decision, those that were not rejected first and the best of them foremost, and their number."""
    of = [row for row in rows if int(row["decision"]) == number]
    of.sort(key=lambda row: (bool(row["rejection"]), -float(row["utility"])))
    return of, sum(not row["rejection"] for row in of)


def with_most_candidates(rows):
    """Number of the first decision with most candidates that were not rejected."""
    accepted = collections.Counter(int(row["decision"]) for row in rows if not row["rejection"])
    return accepted.most_common(1)[0][0] if accepted else int(rows[0]["decision"])


def draw_floor_plan(axes, plan):
    """Free, occupied and unknown cells, and frontiers, as they were then; returns what the legend says of them."""
    rows = plan["plan"]["rows"]
    if not rows:
        return []
    shades = {" ": 0.85, ".": 1.0, "#": 0.35}
    x, y = plan["plan"]["lower_left_m"]
    cell = plan["resolution_m"]
    axes.imshow([[shades[c] for c in row] for row in rows], cmap="gray", vmin=0, vmax=1, origin="lower", zorder=0,
                extent=(x, x + cell * len(rows[0]), y, y + cell * len(rows)))
    cells = np.array([cell for frontier in plan["frontiers"] for cell in frontier["cells_m"]]).reshape(-1, 2)
    frontiers, = axes.plot(*cells.T, "s", color="#ffcc80", markersize=3, zorder=1)
    return [(frontiers, "frontiers")]


def draw_paths(axes, plan, rows, shade):
    """To the candidates that were not rejected, by rank."""
    for row, colour in zip(rows, shade):
        corners = np.array(plan["paths_m"][int(row["candidate"])]).reshape(-1, 2)
        axes.plot(*corners.T, color=colour, linewidth=1.2)


def draw_candidates(axes, rows, count, shade, path):
    """Candidates from above, numbered by rank; returns what the legend says of them."""
    x, y, yaw = (numbers(rows, name, path) for name in ("x_m", "y_m", "yaw_rad"))
    entries = []
    if count < len(rows):
        rejected, = axes.plot(x[count:], y[count:], "x", color="#777777", markersize=6)
        entries.append((rejected, f"{len(rows) - count} rejected"))
    for i in reversed(range(count)):  # the best one on top
        axes.annotate("", (x[i] + 0.5 * math.cos(yaw[i]), y[i] + 0.5 * math.sin(yaw[i])), (x[i], y[i]),
                      arrowprops={"arrowstyle": "-|>", "color": shade[i], "linewidth": 1.6})
        axes.plot(x[i], y[i], "o", color=shade[i], markeredgecolor="black", markeredgewidth=0.5, markersize=6)
        axes.annotate(str(i + 1), (x[i], y[i]), xytext=(4, 4), textcoords="offset points", fontsize=8)
    others = [column for column in rows[0] if column.startswith(CHOSEN_BY)]
    rings = [("is_chosen", "o", ORANGE, "chosen")]
    rings += [(column, marker, colour, f"{column.removeprefix(CHOSEN_BY)} would choose")
              for column, (marker, colour) in zip(others, itertools.cycle(OTHER_METHODS))]
    for size, (column, marker, colour, name) in zip(itertools.count(15, 4), rings):
        chosen = [i for i, row in enumerate(rows) if row[column] == "1"]
        if chosen:
            ring, = axes.plot(x[chosen], y[chosen], marker, color="none", markeredgecolor=colour, markeredgewidth=1.8,
                              markersize=size)
            entries.append((ring, name))
    return entries


def draw_bars(panels, bars, rows, count, shade, path):
    """What each candidate that was not rejected costs and gives, by rank."""
    for panel, (column, name) in zip(panels, bars):
        panel.barh(np.arange(count), numbers(rows[:count], column, path), color=shade, height=0.7)
        panel.set_yticks(np.arange(count), np.arange(count) + 1, fontsize=8)
        panel.invert_yaxis()
        panel.set_title(name, fontsize=9)
        panel.locator_params(axis="x", nbins=3)
        panel.grid(axis="x", color="#dddddd", linewidth=0.6)
        panel.set_axisbelow(True)
    panels[0].set_ylabel("candidate, by utility")


def draw_decision(run):
    """What one decision was made from: where the candidates are, and what each one costs and gives."""
    path = run / DECISIONS
    table = read_table(path)
    if not table:
        raise MissingInput(f"{DECISIONS} holds no decision")
    stamps, positions, _ = read_trajectory(run / ESTIMATE)
    plan_of_then = read_decision_plan(run)
    try:
        rows, count = shown_decision(table, plan_of_then["decision"] if plan_of_then else with_most_candidates(table))
        number, method, time_s = rows[0]["decision"], rows[0]["method"], float(rows[0]["time_s"])
        explanation = next((row["explanation"] for row in rows if row.get("explanation")), "")  # older files have none
        bars = [bar for bar in DECISION_BARS if any(row[bar[0]] for row in rows)]  # not what the method does not ask for
        figure, (plan, *panels) = plt.subplots(1, 1 + len(bars), figsize=(13, 6.5),
                                               gridspec_kw={"width_ratios": [5] + [1] * len(bars)})
        shade = plt.get_cmap("viridis")(np.linspace(0.95, 0.05, count))
        entries = []
        if plan_of_then:
            entries = draw_floor_plan(plan, plan_of_then)
            draw_paths(plan, plan_of_then, rows, shade)
        gone = positions[stamps <= time_s]
        driven, = plan.plot(*gone[:, :2].T, color="black", linewidth=1.0)
        robot, = plan.plot(*gone[-1:, :2].T, "*", color="black", markersize=13)
        entries += draw_candidates(plan, rows, count, shade, path)
        draw_bars(panels, bars, rows, count, shade, path)
    except (KeyError, IndexError, TypeError, ValueError) as error:
        raise MissingInput(f"{path.name} or {DECISION_PLAN} is damaged ({error})") from error
    plan.legend(*zip((driven, "path until then"), (robot, "robot"), *entries), loc="upper center",
                bbox_to_anchor=(0.5, -0.1), ncols=3, frameon=False)
    finish_plan(plan, "", has_map=bool(plan_of_then))
    map_of_then = ", with the map of then" if plan_of_then else ""
    figure.suptitle(f"Decision {number} at {time_s:.1f} s by method {method}, the one with most candidates{map_of_then}\n"
                    + textwrap.fill(explanation, 140), fontsize=10)
    figure.tight_layout()
    return figure
