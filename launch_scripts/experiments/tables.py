"""Tables and tests of experiment.sh, from rows: failures rank last, pairs are runs of the same building and seed."""

import collections
import csv
import math

import numpy as np
from scipy import stats

Result = collections.namedtuple("Result", "test pairs effect low high better p")

LARGER_IS_BETTER = ("explored", "iou", "tracked", "completed")
RESAMPLES = 10000
POWER_TRIALS = 2000
LEVEL = 0.05

NAMES = {  # heading, factor, digits
    "keyframe_ate_se3_rmse_m": ("key-frame ATE SE(3), cm", 100, 2),
    "keyframe_ate_origin_rmse_m": ("key-frame ATE, first pose, cm", 100, 2),
    "full_map_error_mean_m": ("map error, cm", 100, 2),
    "full_iou_top8_mean": ("IoU of 8 classes, %", 100, 1),
    "floor_map_error_mean_m": ("map error at true poses, cm", 100, 2),
    "floor_iou_top8_mean": ("IoU of 8 classes at true poses, %", 100, 1),
    "ideal_map_error_mean_m": ("map error (ideal), cm", 100, 2),
    "ideal_iou_top8_mean": ("IoU of 8 classes (ideal), %", 100, 1),
    "mesh_map_error_mean_m": ("map error (mesh), cm", 100, 2),
    "mesh_iou_top8_mean": ("IoU of 8 classes (mesh), %", 100, 1),
    "explored_volume_m3": ("explored, m³", 1, 1),
    "explored_share": ("explored, %", 100, 1),
    "path_length_m": ("path, m", 1, 1),
    "loop_closures": ("loops", 1, 0),
    "lost_share": ("lost, %", 100, 1),
    "decision_time_p50_s": ("decision, ms", 1000, 0),
}


def name_of(figure):
    return NAMES.get(figure, (figure, 1, 3))


def is_larger_better(figure):
    return any(word in figure for word in LARGER_IS_BETTER)


def worst(figure):
    return -math.inf if is_larger_better(figure) else math.inf


def has_failed(protocol, row):
    """A run that did not end as it should, or with too little of a figure."""
    if row["outcome"] in ("FAILED", "lost", "planner failed"):
        return True
    return any(not row.get(figure) or float(row[figure]) < least for figure, least in protocol["failed_below"].items())


def value_of(protocol, row, figure):
    """A figure of a run; the worst of all when the run has failed or does not have it."""
    if has_failed(protocol, row) or not row.get(figure):
        return worst(figure)
    return float(row[figure])


def by_pair(protocol, rows, figure):
    """{method: {(building, seed): value}}"""
    values = {label: {} for label in protocol["methods"]}
    for row in rows:
        if row["method"] in values:
            values[row["method"]][row["scene"], row["seed"]] = value_of(protocol, row, figure)
    return values


def pairs_of(values, method, against):
    """Two arrays, of the buildings that both have."""
    common = sorted(set(values[method]) & set(values[against]))
    return np.array([values[method][k] for k in common]), np.array([values[against][k] for k in common])


def quantile(values, share):
    """By ranks, so that infinite values (failures) are only the last; between two, their mean when both are finite."""
    ordered = np.sort(values)
    place = share * (len(ordered) - 1)
    low, high = ordered[int(math.floor(place))], ordered[int(math.ceil(place))]
    if not (math.isfinite(low) and math.isfinite(high)):
        return low if place == math.floor(place) else high
    return low + (place - math.floor(place)) * (high - low)


def bootstrap(statistic, *arrays, seed=1):
    """90 % interval of a statistic over resampled buildings: percentiles."""
    random = np.random.default_rng(seed)
    count = len(arrays[0])
    picks = random.integers(0, count, (RESAMPLES, count))
    results = np.array([statistic(*(array[pick] for array in arrays)) for pick in picks])
    return quantile(results, 0.05), quantile(results, 0.95)


def effects(a, b, is_ratio):
    """Of each pair: logarithm of the ratio, or the difference. Where one has failed it is infinite; where both have, 0."""
    result = np.zeros(len(a))
    for i, (x, y) in enumerate(zip(a, b)):
        if math.isinf(x) and math.isinf(y):
            continue
        if is_ratio and (math.isinf(x) or math.isinf(y)):
            result[i] = math.inf if abs(x) > abs(y) else -math.inf
            if x < 0 or y < 0:  # of figures of which more is better the worst is minus infinity
                result[i] = -result[i]
        else:
            result[i] = math.log(max(x, 1e-12) / max(y, 1e-12)) if is_ratio else x - y
    return result


def wilcoxon(differences):
    """Two-sided p of Wilcoxon's signed ranks; pairs without a difference share their signs (Pratt). Infinite differences
    have the highest rank."""
    differences = np.array(differences, dtype=float)
    finite = np.abs(differences[np.isfinite(differences)])
    largest = 2.0 * (finite.max() if finite.size else 1.0) + 1.0
    differences = np.clip(differences, -largest, largest)
    if not np.any(differences):
        return 1.0
    return float(stats.wilcoxon(differences, zero_method="zsplit").pvalue)


def holm(p_values):
    """Holm's corrected p, in the order that they came in."""
    order = sorted(range(len(p_values)), key=p_values.__getitem__)
    corrected, most = [0.0] * len(p_values), 0.0
    for rank, i in enumerate(order):
        most = max(most, min(1.0, (len(p_values) - rank) * p_values[i]))
        corrected[i] = most
    return corrected


def is_ratio(test):
    return "difference" not in test


def effect_text(test, value):
    if math.isinf(value):
        return "∞" if value > 0 else "0" if is_ratio(test) else "-∞"
    if is_ratio(test):
        return f"{math.exp(value):.2f}"
    _, factor, digits = name_of(test["figure"])
    return f"{factor * value:+.{digits}f}"


def results_of(protocol, rows):
    """Of each test that has two pairs or more."""
    found = []
    for test in protocol["tests"]:
        a, b = pairs_of(by_pair(protocol, rows, test["figure"]), test["method"], test["against"])
        if len(a) >= 2:
            found.append((test, effects(a, b, is_ratio(test))))
    corrected = holm([wilcoxon(of_pairs) for _, of_pairs in found])
    results = []
    for (test, of_pairs), p in zip(found, corrected):
        low, high = bootstrap(lambda x: quantile(x, 0.5), of_pairs)
        sign = -1 if is_larger_better(test["figure"]) else 1
        results.append(Result(test, len(of_pairs), quantile(of_pairs, 0.5), low, high, int(np.sum(sign * of_pairs < 0)), p))
    return results


def expected_of(test):
    """As an effect; None when the protocol does not say."""
    if "ratio" in test:
        return math.log(test["ratio"])
    return test.get("difference")


def test_rows(protocol, rows):
    """Cells of the table of tests."""
    table = []
    for result in results_of(protocol, rows):
        test, expected = result.test, expected_of(result.test)
        table.append([name_of(test["figure"])[0], test["method"], test["against"], str(result.pairs),
                      effect_text(test, result.effect),
                      f"{effect_text(test, result.low)} to {effect_text(test, result.high)}",
                      f"{result.better} of {result.pairs}", f"{result.p:.4f}",
                      "-" if expected is None else effect_text(test, expected)])
    return table


def condition_rows(protocol, rows):
    table = []
    for condition in protocol["conditions"]:
        a, b = pairs_of(by_pair(protocol, rows, condition["figure"]), condition["method"], condition["against"])
        if len(a) < 2:
            continue
        found = effects(a, b, True)
        low = bootstrap(lambda x: quantile(x, 0.5), found)[0]
        holds = "yes" if math.exp(low) >= condition["least_ratio"] else "no"
        table.append([name_of(condition["figure"])[0], condition["method"], condition["against"], str(len(a)),
                      f"{math.exp(quantile(found, 0.5)):.3f}", f"{math.exp(low):.3f}", str(condition["least_ratio"]), holds])
    return table


def best_counts(values):
    """In how many of the buildings that all methods have, each is the best; ties count for each."""
    common = set.intersection(*(set(of) for of in values.values()))
    return common, lambda method, pick: sum(values[method][key] == pick(of[key] for of in values.values()) for key in common)


def method_rows(protocol, rows):
    """Median, 90th percentile on the worse side and "best in n of N", by method."""
    table = []
    for label in protocol["methods"]:
        of = [row for row in rows if row["method"] == label]
        if not of:
            continue
        cells = [label, str(len(of)), str(sum(has_failed(protocol, row) for row in of))]
        for figure in protocol["figures"]:
            _, factor, digits = name_of(figure)
            values = np.array([value_of(protocol, row, figure) for row in of])
            tail = quantile(values, 0.1 if is_larger_better(figure) else 0.9)
            show = lambda x, f=factor, d=digits: "failed" if math.isinf(x) else f"{f * x:.{d}f}"
            common, count = best_counts({k: v for k, v in by_pair(protocol, rows, figure).items() if v})
            best = count(label, max if is_larger_better(figure) else min)
            cells.append(f"{show(quantile(values, 0.5))} ({show(tail)}; {best} of {len(common)})")
        table.append(cells)
    return table


def tables_of(protocol, rows):
    """(title, head, rows) of each table."""
    figures = [name_of(figure)[0] for figure in protocol["figures"]]
    head = ["method", "runs", "failed", *figures]
    whole = [row for row in rows if not has_failed(protocol, row)]
    yield "All runs, failures last: median (90th percentile on the worse side; best in n of N)", head, method_rows(protocol, rows)
    yield "Without runs that failed, as the paper has it", head, method_rows(protocol, whole)
    yield ("Pairs: median effect with 90 % bootstrap interval over buildings, Wilcoxon's test with Holm's correction",
           ["figure", "method", "against", "pairs", "effect", "interval", "better", "p", "expected"], test_rows(protocol, rows))
    yield ("Conditions: one-sided 95 % bound of the median ratio",
           ["figure", "method", "against", "pairs", "ratio", "bound", "least", "holds"], condition_rows(protocol, rows))


def as_text(title, head, rows):
    lines = [f"**{title}**", "", "| " + " | ".join(head) + " |", "|" + " --- |" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def as_latex(title, head, rows):
    escape = lambda cell: "".join({"%": r"\%", "_": r"\_", "&": r"\&", "³": "$^3$", "∞": r"$\infty$"}.get(c, c) for c in cell)
    lines = [f"% {title}", r"\begin{tabular}{l" + "r" * (len(head) - 1) + "}", r"\hline"]
    lines += [" & ".join(map(escape, row)) + r" \\" for row in [head]] + [r"\hline"]
    return "\n".join(lines + [" & ".join(map(escape, row)) + r" \\" for row in rows] + [r"\hline", r"\end{tabular}"]) + "\n"


def print_tables(protocol, rows, folder, wanted):
    """To the standard output, and as tables.md, tables.tex and tables_1.csv, ... beside the rows."""
    print(f"{protocol['name']}: {protocol['title']}\n{len(rows)} of {wanted} runs have a row\n")
    if not rows:
        return
    tables = [table for table in tables_of(protocol, rows) if table[2]]
    text = "\n".join(as_text(*table) for table in tables)
    print(text)
    (folder / "tables.md").write_text(text, encoding="utf-8")
    (folder / "tables.tex").write_text("\n".join(as_latex(*table) for table in tables), encoding="utf-8")
    for number, (_, head, cells) in enumerate(tables, 1):
        with (folder / f"tables_{number}.csv").open("w", newline="", encoding="utf-8") as stream:
            csv.writer(stream).writerows([head, *cells])


def print_power(protocol, pairs):
    """Share of simulated experiments in which a test alone, and one of all with Bonferroni's bound, finds what is expected;
    effects are normal with the expected median and the protocol's deviation."""
    random = np.random.default_rng(1)
    print(f"{protocol['name']}: power with {pairs} pairs\n")
    print("| figure | method | against | expected | deviation | power alone | power among all |\n|" + " --- |" * 7)
    for test in protocol["tests"]:
        expected = test.get("ratio", test.get("difference"))
        if expected is None or "deviation" not in test:
            continue
        centre = math.log(expected) if is_ratio(test) else expected
        p = np.array([wilcoxon(random.normal(centre, test["deviation"], pairs)) for _ in range(POWER_TRIALS)])
        print(f"| {name_of(test['figure'])[0]} | {test['method']} | {test['against']} | {expected} | {test['deviation']} | "
              f"{np.mean(p < LEVEL):.2f} | {np.mean(p < LEVEL / len(protocol['tests'])):.2f} |")
