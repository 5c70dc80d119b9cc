"""Figures over time: explored volume, errors of the pose, progress."""

import matplotlib.ticker
import numpy as np

from lapis_figures.inputs import (ESTIMATE, TRUTH, MissingInput, heading_error, interpolate, metric, numbers, read_table,
                                  read_trajectory)
from lapis_figures.style import BLUE, GREY, ORANGE, break_gaps, plt

TIERS = {"vision": "#66bb6a", "surfaces": "#42a5f5", "odometry": "#ffb300", "none": "#d32f2f"}  # frames.csv
PLANNER_STATES = {"EXPLORING": "#aed581", "RECOVERING": "#ffb300", "RETURNING": "#90caf9", "PAUSED": "#ce93d8", "IDLE": "#eeeeee",
                  "CONSOLIDATING": "#4db6ac", "DONE": "#2e7d32", "GAVE_UP": "#e65100", "FAILED": "#d32f2f"}
LEAST_SHOWN_M = 1e-3  # on a logarithmic axis


def draw_coverage(run):
    path = run / "timeline.csv"
    rows = read_table(path)
    seconds, volume, share = (numbers(rows, column, path) for column in
                              ("time_s", "explored_volume_m3", "explored_share"))
    if not np.isfinite(volume).any():
        raise MissingInput("timeline.csv has no explored volume")
    figure, axes = plt.subplots(figsize=(10, 5))
    axes.plot(seconds, volume, color=BLUE, linewidth=1.8)
    axes.set(xlabel="time since the first frame [s]", ylabel="explored volume [m³]", title="Explored volume over time")
    axes.set_xlim(0, seconds[-1])
    axes.set_ylim(bottom=0)
    axes.grid(color="#dddddd", linewidth=0.6)
    if not np.isfinite(share).any():
        return figure
    axes.yaxis.label.set_color(BLUE)
    right = axes.twinx()
    right.plot(seconds, 100 * share, color=ORANGE, linewidth=1.8)
    right.set_ylabel("share of the explorable volume [%]", color=ORANGE)
    right.set_ylim(0, 100)
    for level in (80, 90):
        reached = np.flatnonzero(100 * share >= level)
        if len(reached):
            first = seconds[reached[0]], 100 * share[reached[0]]
            right.plot(*first, "o", color=ORANGE)
            right.annotate(f"{level} % after {first[0]:.0f} s", first, xytext=(8, -14), textcoords="offset points",
                           color=ORANGE)
    return figure


def draw_errors(run):
    stamps, positions, quaternions = read_trajectory(run / ESTIMATE)
    truth = read_trajectory(run / TRUTH)
    true_positions, true_quaternions, valid = interpolate(*truth, stamps)
    if not valid.any():
        raise MissingInput(f"no stamp of {ESTIMATE} is near one of {TRUTH}")
    seconds = stamps[valid] - stamps[0]
    position_cm = 100 * np.linalg.norm((positions - true_positions)[valid], axis=1)
    heading_deg = np.degrees(heading_error(quaternions[valid], true_quaternions[valid]))
    figure, panels = plt.subplots(2, 1, figsize=(10, 6), sharex=True)
    for axes, values, name, colour in ((panels[0], position_cm, "position error [cm]", BLUE),
                                       (panels[1], heading_deg, "heading error [deg]", ORANGE)):
        axes.plot(*break_gaps(seconds, values), color=colour, linewidth=1.5)
        rmse = float(np.sqrt(np.mean(values**2)))
        axes.axhline(rmse, color=GREY, linewidth=1, linestyle="--", label=f"RMSE {rmse:.2f}")
        axes.set_ylabel(name)
        axes.grid(color="#dddddd", linewidth=0.6)
        axes.legend(loc="upper left", framealpha=0.9)
    panels[0].set_ylim(bottom=0)
    panels[0].set_title("Errors of the pose as published at its time, both in the map frame, not aligned")
    panels[1].set_xlabel("time since the first pose [s]")
    return figure


def runs_of_equal(seconds, values):
    """(value, begin, end) of each stretch of equal values; the time before a row is that row's."""
    found = []
    begin = seconds[0]
    for i in range(1, len(values)):
        if i + 1 == len(values) or values[i + 1] != values[i]:
            found.append((values[i], begin, seconds[i]))
            begin = seconds[i]
    return found


def stretches(seconds, tiers, duration_s):
    """(tier, begin, end) of each stretch that one tier held; as in the shares of metrics.json, before the first frame and
    after the last one there is no pose."""
    found = [("none", 0.0, seconds[0])] if seconds[0] > 0 else []
    found += runs_of_equal(seconds, tiers)
    if duration_s > seconds[-1]:
        found.append(("none", seconds[-1], duration_s))
    return found


def distance_driven(run, seconds, path_m):
    """Distance by time and what it is by: truth, else the estimate."""
    if np.isfinite(path_m).any():
        return seconds, path_m, "true path"
    stamps, positions, _ = read_trajectory(run / ESTIMATE)
    steps = np.linalg.norm(np.diff(positions, axis=0), axis=1)
    return stamps - stamps[0] + seconds[0], np.concatenate(([0.0], np.cumsum(steps))), "path by the estimate"


def metres(value, _):
    """A label of a logarithmic axis."""
    if value < 0.01:
        return f"{1000 * value:g} mm"
    return f"{100 * value:g} cm" if value < 1 else f"{value:g} m"


def draw_tiers(band, panels, held):
    """The band of tiers with their shares of the time; other panels are tinted where vision does not hold the pose."""
    for tier, begin, end in sorted(held, key=lambda stretch: list(TIERS).index(stretch[0])):  # the worst one on top,
        seen = {} if tier == "vision" else {"edgecolor": TIERS[tier], "linewidth": 0.8}  # and a single frame is seen, too
        band.axvspan(begin, end, facecolor=TIERS[tier], **seen)
        for axes in panels if tier != "vision" else ():
            axes.axvspan(begin, end, facecolor=TIERS[tier], edgecolor="none", alpha=0.18)
    whole = sum(end - begin for _, begin, end in held)
    shares = {name: sum(end - begin for tier, begin, end in held if tier == name) / whole for name in TIERS}
    patches = [plt.Rectangle((0, 0), 1, 1, facecolor=colour) for colour in TIERS.values()]
    band.legend(patches, [f"{'no pose' if name == 'none' else name} {100 * share:.1f} %" for name, share in shares.items()],
                loc="upper center", bbox_to_anchor=(0.5, -0.15), ncols=len(TIERS), frameon=False)
    band.set_ylabel("pose by", rotation=0, ha="right", va="center")
    band.set_yticks([])


def draw_sureness(axes, seconds, sigma_m, error_m):
    """How far slam thinks that it may be off, and how far it is."""
    for values, colour, name in ((sigma_m, BLUE, "sigma by slam"), (error_m, ORANGE, "error against the truth")):
        if np.isfinite(values).any():
            axes.plot(seconds, np.maximum(values, LEAST_SHOWN_M), color=colour, linewidth=1.5, label=name)
    axes.set_yscale("log")
    axes.set_ylim(LEAST_SHOWN_M, max(0.1, axes.get_ylim()[1]))
    axes.yaxis.set_major_locator(matplotlib.ticker.LogLocator(subs=(1, 2, 5)))
    axes.yaxis.set_major_formatter(metres)
    axes.yaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
    axes.set_ylabel("position")
    axes.grid(which="both", color="#dddddd", linewidth=0.6)
    if axes.lines:
        axes.legend(loc="upper left", framealpha=0.9)


def draw_explored(axes, band, run):
    """What share of the building is known, on an axis of its own, stretches without progress, and the planner's state in a
    band; nothing of what the run does not know."""
    path = run / "timeline.csv"
    rows = read_table(path) if path.is_file() else []
    band.set_yticks([])
    if len(rows) < 2:
        return band.set_visible(False)
    seconds = numbers(rows, "time_s", path)
    column = next((name for name in ("explored_share_with_margin", "explored_share")
                   if any(row.get(name) for row in rows)), None)
    if column:
        right = axes.twinx()
        right.plot(seconds, 100 * numbers(rows, column, path), color=ORANGE, linewidth=1.8)
        right.set_ylabel("explored [%]", color=ORANGE)
        right.set_ylim(0, 100)
    for is_stalled, begin, end in runs_of_equal(seconds, [row.get("is_stalled") == "1" for row in rows]):
        if is_stalled:
            axes.axvspan(begin, end, facecolor="none", edgecolor=GREY, hatch="///", linewidth=0)
            axes.annotate(f"no progress\n{end - begin:.0f} s", ((begin + end) / 2, 0.97), xycoords=("data", "axes fraction"),
                          ha="center", va="top", fontsize=8)
    states = [row.get("planner_state") or "" for row in rows]
    shown = [state for state in PLANNER_STATES if state in states]
    if not shown:
        return band.set_visible(False)
    for state, begin, end in runs_of_equal(seconds, states):
        if state in PLANNER_STATES:
            band.axvspan(begin, end, facecolor=PLANNER_STATES[state], edgecolor=PLANNER_STATES[state], linewidth=0.8)
    patches = [plt.Rectangle((0, 0), 1, 1, facecolor=PLANNER_STATES[state]) for state in shown]
    band.legend(patches, shown, loc="upper center", bbox_to_anchor=(0.5, -0.15), ncols=len(shown), frameon=False)
    band.set_ylabel("planner", rotation=0, ha="right", va="center")


def draw_progress(run):
    """How far the robot has come and what it knows, what held its pose, what it did, and what that cost."""
    path = run / "frames.csv"
    rows = read_table(path)
    if len(rows) < 2:
        raise MissingInput("frames.csv holds no two frames")
    seconds, path_m, sigma_m, error_m = (numbers(rows, column, path) for column in
                                         ("time_s", "path_length_m", "position_sigma_m", "position_error_m"))
    tiers = [row.get("tier") for row in rows]
    if not np.isfinite(seconds).all() or not set(tiers) <= set(TIERS):
        raise MissingInput("frames.csv is damaged")
    figure, (distance, band, doing, sureness) = plt.subplots(
        4, 1, figsize=(11, 8), sharex=True, gridspec_kw={"height_ratios": [4, 0.45, 0.45, 4], "hspace": 0.4})
    at, driven_m, source = distance_driven(run, seconds, path_m)
    duration_s = metric(run, "duration_s") or seconds[-1]
    draw_tiers(band, (distance, sureness), stretches(seconds, tiers, duration_s))
    distance.plot(at, driven_m, color="black", linewidth=1.8)
    distance.set(ylabel=f"distance driven [m]\n({source})", title=f"Progress and pose: {run.resolve().name}")
    distance.set_ylim(bottom=0)
    distance.grid(color="#dddddd", linewidth=0.6)
    draw_explored(distance, doing, run)
    draw_sureness(sureness, seconds, sigma_m, error_m)
    sureness.set_xlabel("time since the first frame [s]")
    sureness.set_xlim(0, max(duration_s, seconds[-1]))
    return figure
