#!/usr/bin/python3
"""Fits and judges the 95 % intervals (field uncertainty_mm) of segmented simulated hips.

usage: calibrate_uncertainty.py --work DIR [--shared ../shared]

DIR holds results of evaluate_segmentation.py (atlases free of the subject).  Per vertex the distance to the true surface is compared with
what the result knows of itself (include/coxa/segment/uncertainty.h): the 95th percentile is fitted by quantile regression, every
image counting the same.  The share of the surface (by area) whose true distance is within is printed as shipped in the results and as
fitted to the other half of the subjects (HALVES): only the latter is a test.  Last comes the table fitted to all cases, for
src/pipeline/segment_calibration.cpp.  What of a femur lies within 4 mm of the flat cut in which its true surface ends, or below, is not
judged.  Outside the view hip bones are judged only: the true femurs end there.
"""
import argparse
import pathlib
import sys

import nibabel
import numpy as np
import vtk
from scipy.optimize import minimize
from scipy.spatial import cKDTree
from vtk.util.numpy_support import vtk_to_numpy

from libhip import surface_path

HALVES = [("m1", "m3", "m5", "m8", "m10"), ("m2", "m4", "m6", "m11")]
STRUCTURES = ["femur", "hip_bone", "femoral_cartilage", "acetabular_cartilage"]
EDGE, RIM, BEYOND, SHARP, BLURRED, CUT = 4.0, 3.0, 5.0, 0.4, 5.0, 4.0  # mm, as in uncertainty.cpp; CUT of the true femur
LEAST = 0.01  # mm: smaller distances are equally good
RIDGE = 2e-3  # keeps coefficients that the cases do not tell near 0
BONE = ["constant", "doubt", "border", "edge", "blur"]
LAYER = ["constant", "doubt", "blur", "rim", "far_side"]
OUTSIDE = ["beyond", "growth"]


def read_result(path):
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    mesh = reader.GetOutput()
    data = mesh.GetPointData()
    fields = {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)).astype(float) for i in range(data.GetNumberOfArrays())}
    return vtk_to_numpy(mesh.GetPoints().GetData()).astype(float), vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3), fields


def areas_and_normals(points, triangles):
    """Area of each vertex, a third of its triangles', and its normal."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    areas, normals = np.zeros(len(points)), np.zeros_like(points)
    for k in range(3):
        np.add.at(areas, triangles[:, k], np.linalg.norm(cross, axis=1) / 6)
        np.add.at(normals, triangles[:, k], cross)
    return areas, normals / np.linalg.norm(normals, axis=1)[:, None]


def view_depth_and_blur(points, normals, image):
    """mm inside the box of voxel centres (negative outside), and half a voxel along each normal."""
    affine = np.diag([-1.0, -1.0, 1.0, 1.0]) @ image.affine
    spacing = np.linalg.norm(affine[:3, :3], axis=0)
    axes = affine[:3, :3] / spacing
    way = (points - affine[:3, 3]) @ axes
    margin = np.minimum(way, (np.array(image.shape[:3]) - 1) * spacing - way)
    inside = margin.min(1)
    depth = np.where(inside >= 0, inside, -np.linalg.norm(np.minimum(margin, 0), axis=1))
    return depth, 0.5 * np.linalg.norm(normals @ axes * spacing, axis=1)


def rim_and_side(points, triangles):
    """Distance of a cartilage's vertices from its rim, and 1 on the articular side."""
    sheet = triangles[: len(triangles) // 2]
    edges, count = np.unique(np.sort(np.vstack([sheet[:, [0, 1]], sheet[:, [1, 2]], sheet[:, [2, 0]]]), axis=1), axis=0, return_counts=True)
    far = np.ones(len(points))
    far[np.unique(sheet)] = 0.0
    return cKDTree(points[np.unique(edges[count == 1])]).query(points)[0], far


def evidence(folder, image, structure, truth, evaluator):
    """Columns of what the result knows of itself, and true distances, of the vertices judged."""
    points, triangles, fields = read_result(folder / f"{structure}.vtp")
    areas, normals = areas_and_normals(points, triangles)
    depth, blur = view_depth_and_blur(points, normals, image)
    case = {"distance": np.abs(evaluator.signed(points, truth)), "area": areas, "depth": depth,
            "shipped": fields.get("uncertainty_mm", np.full(len(points), np.nan)), "constant": np.ones(len(points)),
            "doubt": 1 - fields["confidence"], "edge": np.exp(-np.maximum(depth, 0) / EDGE),
            "blur": np.log(np.clip(blur, SHARP, BLURRED) / SHARP), "beyond": np.ones(len(points)),
            "growth": np.log1p(np.maximum(-depth, 0) / BEYOND)}
    if structure.endswith("cartilage"):
        rim, case["far_side"] = rim_and_side(points, triangles)
        case["rim"] = np.exp(-rim / RIM)
    else:
        case["border"] = np.log(fields["border_deviation_mm"])
    judged = np.ones(len(points), bool)
    if structure == "femur":
        judged = points[:, 2] > evaluator.arrays(truth)[0][:, 2].min() + CUT
    return {k: v[judged] for k, v in case.items()}


def fitted(cases, columns, seen):
    """Coefficients by which the 95th percentile of log distance is linear in the columns; every case counts the same."""
    X, y, w = [], [], []
    for case in cases:
        here = (case["depth"] >= 0) == seen
        if here.sum() < 20:
            continue
        X.append(np.column_stack([case[c][here] for c in columns]))
        y.append(np.log(np.maximum(case["distance"][here], LEAST)))
        w.append(case["area"][here] / case["area"][here].sum())
    X, y, w = np.vstack(X), np.concatenate(y), np.concatenate(w) / len(w)

    def pinball(b, soft=0.02, q=0.95):
        r = y - X @ b
        side = np.where(r > 0, q, 1 - q)
        near = np.abs(r) < soft
        loss = np.where(near, side * r * r / (2 * soft), side * (np.abs(r) - soft / 2))
        slope = np.where(near, side * r / soft, side * np.sign(r))
        ridge = np.r_[0, b[1:]]
        return (w * loss).sum() + RIDGE * (ridge ** 2).sum(), -X.T @ (w * slope) + 2 * RIDGE * ridge

    start = np.zeros(len(columns))
    start[0] = np.quantile(y, 0.95)
    return minimize(pinball, start, jac=True, method="L-BFGS-B", options={"maxiter": 3000}).x


def calibration(cases, structure):
    """Coefficients by name; outside the view a femur is taken to be as uncertain as a hip bone."""
    columns = LAYER if structure.endswith("cartilage") else BONE
    found = dict(zip(columns, fitted(cases[structure], columns, True)))
    found.update(zip(OUTSIDE, fitted(cases["hip_bone"], OUTSIDE, False)))
    return found


def half_widths(case, coefficients):
    part = {seen: sum(c * case[k] for k, c in coefficients.items() if (k in OUTSIDE) != seen) for seen in (True, False)}
    return np.exp(np.where(case["depth"] >= 0, part[True], part[False]))


def share_within(case, half_width, seen):
    """Share of the area whose true distance is within, and the area's median half width; NaN where there is nothing."""
    here = (case["depth"] >= 0) == seen
    if here.sum() < 20 or np.isnan(half_width[here]).any():
        return np.nan, np.nan
    w = case["area"][here]
    return (w * (case["distance"][here] <= half_width[here])).sum() / w.sum(), np.median(half_width[here])


def read_cases(options, evaluator):
    cases, names = {s: [] for s in STRUCTURES}, []
    for path in sorted((options.shared / "data/phantom").glob("m*.nii.gz")):
        name = path.name[: -len(".nii.gz")]
        if not (options.work / name / "segment.json").exists():
            continue
        names.append(name)
        image = nibabel.load(path)
        for s in STRUCTURES:
            truth = evaluator.read(str(surface_path(options.shared / "data/libhip" / pathlib.Path(*name.split("_")[:2]), s)))
            cases[s].append(evidence(options.work / name, image, s, truth, evaluator))
    return names, cases


def of_subjects(cases, names, subjects):
    return {s: [c for n, c in zip(names, cs) if n.split("_")[0] in subjects] for s, cs in cases.items()}


def print_shares(names, cases):
    print("share of the area within the 95 % interval, and median half width, mm: as shipped; fitted to the other half")
    other = {m: {s: calibration(of_subjects(cases, names, HALVES[1 - h]), s) for s in STRUCTURES} for h, half in enumerate(HALVES) for m in half}
    for s in STRUCTURES:
        for seen in (True, False) if s == "hip_bone" else (True,):
            print(f"{s}, {'in view' if seen else 'outside the view'}")
            rows = []
            for name, case in zip(names, cases[s]):
                rows.append([*share_within(case, case["shipped"], seen),
                             *share_within(case, half_widths(case, other[name.split("_")[0]][s]), seen)])
                print(f"  {name:22s} {rows[-1][0]:6.3f} {rows[-1][1]:6.2f}   {rows[-1][2]:6.3f} {rows[-1][3]:6.2f}")
            mean = np.nanmean(rows, axis=0)
            print(f"  {'mean':22s} {mean[0]:6.3f} {mean[1]:6.2f}   {mean[2]:6.3f} {mean[3]:6.2f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shared", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parents[2] / "shared")
    parser.add_argument("--work", type=pathlib.Path, required=True)
    options = parser.parse_args()
    sys.path.insert(0, str(options.shared / "eval"))
    import surface_distance as evaluator

    names, cases = read_cases(options, evaluator)
    if all(any(n.split("_")[0] in half for n in names) for half in HALVES):
        print_shares(names, cases)
    print(f"fitted to all {len(names)} cases:")
    for s in STRUCTURES:
        print(f'      {{"{s}", {{' + ", ".join(f".{k} = {c:.3f}" for k, c in calibration(cases, s).items()) + "}},")


if __name__ == "__main__":
    main()
