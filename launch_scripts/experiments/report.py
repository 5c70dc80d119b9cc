"""The report of experiment.sh beside its rows: what was asked, what came out, tables and figures."""

import subprocess

from experiments import tables
from sources import REPOSITORY
from experiments.runs import in_file_name

FIGURES = {"runs": "All runs: boxes from quartile to quartile, whiskers to the extremes.",
           "progress": "Explored share over time and over path: median, and the band of 80 % of the runs.",
           "classes": "IoU with the whole building by class: means of the runs."}
MAPS = {"map_error": "Map by its error.", "beside_truth": "Explored map beside the building."}


def commit_of(file):
    """The last commit that changed a file; None outside of a repository."""
    result = subprocess.run(["git", "log", "-1", "--format=%h of %cs", "--", str(file)], cwd=REPOSITORY, capture_output=True,
                            text=True, check=False)
    return result.stdout.strip() or None


def sentence_of(result):
    test, (name, _, _) = result.test, tables.name_of(result.test["figure"])
    show = lambda value: tables.effect_text(test, value)
    of = f"{show(result.effect)} times that of {test['against']}" if tables.is_ratio(test) else (
        f"{show(result.effect)} beside {test['against']}")
    verdict = "a difference" if result.p < tables.LEVEL else "no difference is shown"
    text = (f"{name}: {test['method']} has {of} (median of {result.pairs} pairs; 90 % interval {show(result.low)} to "
            f"{show(result.high)}), and is better in {result.better}. p = {result.p:.4f} after Holm's correction: {verdict}.")
    expected = tables.expected_of(test)
    if expected is not None:
        place = "inside" if result.low <= expected <= result.high else "outside"
        text += f" Expected was {show(expected)}, {place} the interval."
    return text


def maps_of(protocol, rows, figures):
    """Those that there are of the first building, method by method."""
    lines = []
    for label in protocol["methods"]:
        for row in rows:
            for name, caption in MAPS.items():
                file = figures / f"{name}_{row['scene']}_{in_file_name(label)}_{row['seed']}.png"
                if row["method"] == label and file.is_file():
                    caption_of_run = f"{caption} {row['scene']}, {label}, seed {row['seed']}."
                    lines += [f"![{caption_of_run}](figures/{file.name})", "", caption_of_run, ""]
    return lines


def write(protocol, file, rows, wanted, folder):
    commits = sorted({row["commit"] for row in rows if row["commit"]})
    keys = sorted({row["key"] for row in rows})
    lines = [f"# {protocol['title'] or protocol['name']}", "",
             f"Experiment `{protocol['name']}`: {len(rows)} of {wanted} runs, world {protocol['world'] or 'as configured'}; "
             f"programs of {', '.join(commits) or 'an unknown commit'}, keys {', '.join(keys)}. "
             f"Protocol {commit_of(file) or 'not committed'}.", ""]
    if len(rows) < wanted:
        lines += ["**Not complete**: what follows is of the runs that are there.", ""]
    lines += [f"- {sentence_of(result)}" for result in tables.results_of(protocol, rows)]
    for cells in tables.condition_rows(protocol, rows):
        lines.append(f"- Condition {cells[0]}: {cells[1]} has {cells[4]} times that of {cells[2]} (one-sided 95 % bound "
                     f"{cells[5]}, least {cells[6]}): {'it holds' if cells[7] == 'yes' else 'it does not hold'}.")
    lines.append("")
    lines += [tables.as_text(*table) for table in tables.tables_of(protocol, rows) if table[2]]
    for name, caption in FIGURES.items():
        if (folder / "figures" / f"{name}.png").is_file():
            lines += [f"![{caption}](figures/{name}.png)", "", caption, ""]
    lines += maps_of(protocol, rows, folder / "figures")
    lines.append(f"`launch_scripts/experiment.sh {file} --table` writes this page anew from the rows.")
    (folder / "report.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
