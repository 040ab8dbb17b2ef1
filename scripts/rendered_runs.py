# SPDX-License-Identifier: BSD-3-Clause
"""What the tables of rendered sequences with a hard passage (rendered_runs.sh) have in common."""
import csv
import statistics

# An error beyond this share of the true path: the submap or map is wrong.
WRONG_PERCENT = 3.0
KINDS = ["blur", "dark", "textureless", "rotation"]


def identity(run):
    """Sequence, kind and seed of a rendering, by its folder."""
    sequence, kind, seed = run.name.rsplit("_", 2)
    return {"sequence": sequence, "kind": kind, "seed": int(seed)}


def spread(values, scale=1.0, digits=1):
    values = [v * scale for v in values if v is not None]
    if not values:
        return "-"
    mean = f"{statistics.fmean(values):.{digits}f}"
    return f"{mean} ± {statistics.stdev(values):.{digits}f}" if len(values) > 1 else mean


def write_csv(path, header, rows):
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        writer.writerows(rows)


def write_table(path, columns, rows):
    """As CSV, and in Markdown to the terminal."""
    write_csv(path, columns, rows)
    print("| " + " | ".join(columns) + " |\n|" + "---|" * len(columns))
    for row in rows:
        print("| " + " | ".join(row) + " |")


def write_tables(runs, columns, table_row, runs_file, table_file):
    """The runs as they are; a row for each sequence and kind, each kind and all as CSV, and in Markdown to the terminal.

    runs: dictionaries that begin with their identity(). table_row(sequence, kind, runs): texts for the columns.
    """
    runs.sort(key=lambda r: (r["sequence"], KINDS.index(r["kind"]) if r["kind"] in KINDS else 9, r["kind"], r["seed"]))
    write_csv(runs_file, list(runs[0]), [list(r.values()) for r in runs])
    groups = dict.fromkeys((r["sequence"], r["kind"]) for r in runs)
    rows = [table_row(*g, [r for r in runs if (r["sequence"], r["kind"]) == g]) for g in groups]
    for kind in dict.fromkeys(r["kind"] for r in runs):
        rows.append(table_row("all", kind, [r for r in runs if r["kind"] == kind]))
    rows.append(table_row("all", "all", runs))
    write_table(table_file, columns, rows)
