#!/usr/bin/python3
"""Flexion with internal rotation on every hip of ../shared/data/libhip: where the cartilage is strained most, and where the bones meet.

usage: evaluate_joint.py --coxa build/release/coxa [--shared ../shared] [--work DIR] [--frames N] [--only m2_left,…]

Each hip runs the whole chain from its surfaces (500 N into the socket, cartilage E 12 MPa, Poisson's ratio 0.42).  The hip
bones are m1's, warped to fit each cartilage: the angle at which bones meet is no measurement of these people.  Results stay
in DIR and are not computed again.
"""
import argparse
import csv
import pathlib
import subprocess

from libhip import surface_path

ROOT = pathlib.Path(__file__).resolve().parent.parent
REGIONS = ["superior", "anterosuperior", "anteroinferior", "inferior", "posteroinferior", "posterosuperior"]


def subject_file(work, folder, name, frames):
    lines = [f'name = "{name}"', f'side = "{folder.name}"', "[surfaces]"]
    for structure in ("femur", "hip_bone", "femoral_cartilage", "acetabular_cartilage"):
        lines.append(f'{structure} = "{surface_path(folder, structure).resolve()}"')
    lines += ["[motion]", 'pattern = "flexion_internal_rotation"', f"frames = {frames}"]
    path = work / f"{name}.toml"
    path.write_text("\n".join(lines) + "\n")
    return path


def largest_share(rows, column):
    """Of the contact force, in any frame, percent."""
    return max(100.0 * float(r[column]) / float(r["contact_force_N"]) for r in rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--coxa", default=ROOT / "build/release/coxa")
    parser.add_argument("--shared", type=pathlib.Path, default=ROOT.parent / "shared")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("/tmp/coxa_joint"))
    parser.add_argument("--frames", type=int, default=13)
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    wanted = [w for w in options.only.split(",") if w]
    print(f"{'hip':11s} {'converged':>9s} {'beyond':>6s} {'failed':>6s} {'last':>12s} {'p99 MPa':>8s} {'area %':>7s} {'force %':>8s} "
          f"{'reaction':>9s} {'on bone %':>9s} {'on thin %':>9s}  strained most at the last frame (mean effective strain)")
    for folder in sorted((options.shared / "data/libhip").glob("m*/*")):
        name = f"{folder.parent.name}_{folder.name}"
        if not (folder / "femoral_cartilage.ply").exists() or (wanted and name not in wanted):
            continue
        out = options.work / name
        subject = subject_file(options.work, folder, name, options.frames)
        done = subprocess.run([str(options.coxa), "run", str(subject), "--out", str(out), "--resume", "--quiet"],
                              capture_output=True, text=True)
        table = out / "joint/summary.csv"
        if done.returncode or not table.exists():
            print(f"{name:11s} ended with {done.returncode}: {done.stderr.strip().splitlines()[-1][:150]}", flush=True)
            continue
        rows = list(csv.DictReader(table.open()))
        good = [r for r in rows if r["status"] == "converged"]
        count = {s: sum(r["status"] == s for r in rows) for s in ("beyond_bony_limit", "failed")}
        last = good[-1]
        region = max(REGIONS, key=lambda n: float(last[f"strain_{n}"] or "nan"))
        pose = f"{float(last['flexion_deg']):.0f} + {float(last['internal_rotation_deg']):.0f}"
        print(f"{name:11s} {len(good):9d} {count['beyond_bony_limit']:6d} {count['failed']:6d} {pose:>12s} "
              f"{float(last['peak_pressure_p99_MPa']):8.2f} {float(last['contact_area_percent']):7.1f} "
              f"{max(float(r['force_error_percent']) for r in good):8.3f} {max(float(r['reaction_error']) for r in good):9.1e} "
              f"{largest_share(good, 'force_on_bare_bone_N'):9.0f} {largest_share(good, 'force_on_thin_cartilage_N'):9.0f}  "
              f"{region} ({float(last[f'strain_{region}']):.3f})", flush=True)


if __name__ == "__main__":
    main()
