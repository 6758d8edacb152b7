#!/usr/bin/python3
"""Segments the simulated MRIs of ../shared/data/phantom with atlases free of the subject, and prints the distances.

usage: evaluate_segmentation.py --coxa build/release/coxa [--shared ../shared] [--work DIR] [--error MM] [--seed N] [--only NAME,…] [--judge]

Subjects are taken out in groups (GROUPS), one atlas per group; every atlas is free of all libhip hip bones, so that the
hip-bone column is of a bone whose like the atlas has not seen (all phantoms' hip bones are warps of one bone: a weak test).
Landmarks come from the truth surfaces by the rules below, with normal noise of --error mm (standard error of the distance).
The phantoms thigh_* show other people's hips and thighs (thigh_phantoms.py): each has an atlas free of its own body, and
Visible Human bones are judged by surface_distance.py --image, those of label maps by label_distance.py.
Atlases are kept in DIR and reused: delete it to start afresh; --judge segments nothing and judges the results there.  Distances
by surface_distance.py --image; of each cartilage also its sides, its thickness and where it is thick its overlap (cartilage_figures.py).
"""
import time

import numpy as np

import cartilage_figures
import thigh_phantoms
from evaluation import begin, distance_text, distances, noisy, run, write_landmarks
from evaluation import parser as evaluation_parser
from libhip import surface_path

GROUPS = [("m2", "m4"), ("m5", "m6", "m8"), ("m1", "m3", "m10", "m11")]
STRUCTURES = ["femur", "hip_bone", "femoral_cartilage", "acetabular_cartilage"]


def truth_path(shared, subject, side, structure):
    return surface_path(shared / "data/libhip" / subject / side, structure)


def truth_points(shared, name, surfaces):
    if thigh_phantoms.is_thigh(name):
        return thigh_phantoms.truth_points(shared, name, surfaces)
    subject, side = subject_and_side(name)
    return {s: surfaces.arrays(surfaces.read(str(truth_path(shared, subject, side, s))))[0] for s in STRUCTURES}


def subject_and_side(name):
    return thigh_phantoms.subject_and_side(name) if thigh_phantoms.is_thigh(name) else name.split("_")[:2]


def landmarks_of(shared, name, surfaces):
    """Landmarks of the truth, LPS mm: extreme points in the frame of a right hip with the head's centre as origin."""
    side = subject_and_side(name)[1]
    mirror = np.array([-1.0 if side == "left" else 1.0, 1.0, 1.0])
    points = {s: p * mirror for s, p in truth_points(shared, name, surfaces).items()}
    cartilage = points["femoral_cartilage"]
    centre = np.linalg.lstsq(np.c_[2 * cartilage, np.ones(len(cartilage))], (cartilage ** 2).sum(1), rcond=None)[0][:3]
    femur, bone, socket = (points[s] - centre for s in ("femur", "hip_bone", "acetabular_cartilage"))
    radius = np.linalg.norm(femur, axis=1)

    def extreme(p, direction, mask):
        p = p[mask]
        return p[(p @ np.array(direction)).argmax()]

    marks = {
        "femoral_head_centre": np.zeros(3),
        "femoral_neck_centre": femur[(radius > 32) & (radius < 38)].mean(0),
        "greater_trochanter_tip": extreme(femur, (0, 0, 1), femur[:, 0] < -32),
        "lesser_trochanter_tip": extreme(femur, (0.6, 0.8, 0), (femur[:, 2] > -75) & (femur[:, 2] < -45)),
        "asis": extreme(bone, (0, -1, 0), bone[:, 2] > 45),
        "aiis": extreme(bone, (0, -1, 0), (bone[:, 2] > 15) & (bone[:, 2] < 42) & (bone[:, 0] < 15)),
        "psis": extreme(bone, (0, 1, 0), bone[:, 2] > 30),
        "pubic_tubercle": extreme(bone, (0, -1, 0), (bone[:, 0] > 40) & (bone[:, 2] < 10)),
        "ischial_tuberosity": extreme(bone, (0, 0, -1), bone[:, 2] < 0),
        "acetabular_rim_superior": extreme(socket, (-0.5, 0, 0.866), socket[:, 2] > -100),
    }
    return {name: (p + centre) * mirror for name, p in marks.items()}


def atlas_without(name, options):
    """The atlas free of the phantom's subject, and of every libhip hip bone where the phantom's is one; built where it is not there yet."""
    subject = subject_and_side(name)[0]
    thigh = thigh_phantoms.is_thigh(name)
    group = (subject,) if thigh else next(g for g in GROUPS if subject in g)
    atlas = getattr(options, "atlases", options.work) / f"atlas_without_{'_'.join(group)}.coxa-atlas"
    if not atlas.exists():
        exclude = [a for s in group for a in ("--exclude", s)]
        warped = [] if thigh else ["--exclude-structure", "libhip:hip_bone"]
        run([options.coxa, "atlas", "build", "--data", options.shared / "data", *exclude, *warped, "--out", atlas])
    return atlas


def segment(image, name, marks, out, options, *more):
    """Segments one phantom from landmarks into a folder, the landmarks' table beside it.  Returns whether that went well."""
    side = subject_and_side(name)[1]
    table = out.with_name(out.name + "_landmarks.csv")
    write_landmarks(table, marks, side)
    return run([options.coxa, "segment", *more, "--image", image, "--side", side, "--landmarks", table, "--atlas", atlas_without(name, options),
                "--structures", getattr(options, "structures", "bones,cartilage"), "--out", out]).returncode == 0


def segmented(image, name, options, evaluator):
    """Segments one phantom from noisy landmarks into DIR/name.  Returns whether that went well."""
    marks = noisy(landmarks_of(options.shared, name, evaluator), name, options.error, options.seed)
    return segment(image, name, marks, options.work / name, options)


def judge(image, name, options, evaluator):
    """The distances of all structures in one line's cells, and a line on each cartilage."""
    cells, lines = [], []
    if thigh_phantoms.is_thigh(name):
        bones = thigh_phantoms.judge_bones(options.work, options.shared, name, image, evaluator)
        return [bones.get(s, "") for s in STRUCTURES], lines
    for structure in STRUCTURES:
        result = options.work / name / f"{structure}.ply"
        truth = truth_path(options.shared, *subject_and_side(name), structure)
        if not result.exists():
            cells.append("failed")
            continue
        cells.append(distance_text(distances(result, truth, image, evaluator)))
        if structure.endswith("cartilage"):
            f = cartilage_figures.figures(result, truth, evaluator)
            lines.append(f"    {structure:22s} bone side {f['bone_side']:.3f}  articular side {f['articular_side']:.3f}"
                         f"  mean thickness {f['thickness']:+.3f}  Dice where thick {f['dice']:.3f}")
    return cells, lines


def main():
    parser = evaluation_parser(__doc__)
    parser.add_argument("--error", type=float, default=3.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="")
    parser.add_argument("--judge", action="store_true")
    options, evaluator = begin(parser)
    wanted = [w for w in options.only.split(",") if w]
    print(f"{'phantom':22s} " + " ".join(f"{s:>26s}" for s in STRUCTURES) + "   seconds  (assd / hd95 / bias, mm)")
    for image in sorted((options.shared / "data/phantom").glob("*.nii.gz")):
        name = image.name[: -len(".nii.gz")]
        if name.endswith("_labels") or (wanted and name not in wanted):
            continue
        start = time.time()
        good = options.judge or segmented(image, name, options, evaluator)
        seconds = time.time() - start
        cells, lines = judge(image, name, options, evaluator) if good else (["failed"] * len(STRUCTURES), [])
        print(f"{name:22s} " + " ".join(f"{c:>26s}" for c in cells) + f"   {seconds:.0f}", *lines, sep="\n", flush=True)


if __name__ == "__main__":
    main()
