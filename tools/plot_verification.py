#!/usr/bin/python3
"""Pictures of the verification table: coxa_verify --csv verification.csv; plot_verification.py verification.csv docs/figures

verification.png: every curve of the table, known answer and ours.  verification_errors.png: error over tolerance of every
figure.  rod.png: the elastic rod (Figure 6 of the paper) with theory, coxa and CalculiX (verify/calculix_rod.csv).
"""
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ROOT = pathlib.Path(__file__).resolve().parent.parent
X_AXES = {"a": "load P L²/EI", "b": "load q L³/EI", "c": "stretch", "i": "polar angle, degrees", "j": "twist, rad/mm", "k": "time T = H k t / h²",
          "m": "strain / amplitude", "s": "slope, degrees", "n": "time step, s"}


def number(row, key):
    return float(row[key])


def curves_of(rows):
    curves = {}
    for row in rows:
        if row["curve"]:
            curves.setdefault((row["case"], row["title"], row["curve"]), []).append(row)
    return curves


def draw_curves(rows, path):
    curves = curves_of(rows)
    columns = 4
    lines = -(-len(curves) // columns)
    figure, axes = plt.subplots(lines, columns, figsize=(4 * columns, 3 * lines), squeeze=False)
    for axis in axes.flat[len(curves):]:
        axis.axis("off")
    for axis, ((case, title, curve), points) in zip(axes.flat, curves.items()):
        at = [number(p, "at") for p in points]
        closed = case == "m"  # a loop starts where it ends
        again = points + points[:1] if closed else points
        axis.plot([number(p, "at") for p in again], [number(p, "reference") for p in again], "k-", lw=1, label="known")
        axis.plot(at, [number(p, "ours") for p in points], "o", ms=5, mfc="none", mec="tab:red", label="coxa")
        axis.set_title(f"({case}) {title}", fontsize=8)
        axis.set_xlabel(X_AXES.get(case, ""), fontsize=8)
        axis.set_ylabel(curve, fontsize=8)
        axis.tick_params(labelsize=7)
    axes.flat[0].legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(path, dpi=60)


def draw_errors(rows, path):
    figure, axis = plt.subplots(figsize=(10, 3.2))
    cases = sorted({row["case"] for row in rows})
    for k, case in enumerate(cases):
        shares = [max(number(r, "error") / number(r, "tolerance"), 1e-9)
                  for r in rows if r["case"] == case and number(r, "tolerance") > 0]
        axis.plot([k + 0.6 * (j + 0.5) / len(shares) - 0.3 for j in range(len(shares))], shares, ".", color="tab:red")
    axis.axhline(1.0, color="k", lw=1)
    axis.set_yscale("log")
    axis.set_xticks(range(len(cases)), [f"({case})" for case in cases])
    axis.set_ylabel("error / tolerance")
    figure.tight_layout()
    figure.savefig(path, dpi=70)


def draw_rod(rows, path):
    calculix = list(csv.DictReader((ROOT / "verify/calculix_rod.csv").open()))
    figure, axes = plt.subplots(2, 3, figsize=(12, 6), sharex=True)
    for k, curve in enumerate(("tip angle, degrees", "x / L", "w / L")):
        points = [r for r in rows if r["case"] == "a" and r["curve"] == curve]
        loads = [number(p, "at") for p in points]
        known = [number(p, "reference") for p in points]
        sources = {"coxa": [number(p, "ours") for p in points], "CalculiX": [float(r[curve]) for r in calculix]}
        axes[0, k].plot(loads, known, "k-", lw=1, label="elastica")
        for (name, values), mark in zip(sources.items(), ("o", "x")):
            axes[0, k].plot(loads, values, mark, mfc="none", label=name)
            errors = [100 * abs(v - t) / t for v, t in zip(values, known)]
            axes[1, k].plot(loads, errors, mark + "-", mfc="none", lw=0.6, label=f"{name}, at most {max(errors):.3f} %")
        axes[0, k].set_ylabel(curve)
        axes[1, k].set_ylabel("error, %")
        axes[1, k].set_xlabel("load P L²/EI")
        axes[1, k].legend(fontsize=8)
    axes[0, 0].legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=70)


def main():
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    rows = list(csv.DictReader(open(sys.argv[1])))
    folder = pathlib.Path(sys.argv[2])
    draw_curves(rows, folder / "verification.png")
    draw_errors(rows, folder / "verification_errors.png")
    draw_rod(rows, folder / "rod.png")


if __name__ == "__main__":
    main()
