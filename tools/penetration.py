#!/usr/bin/python3
"""How deep closed surfaces of a segmented hip enter each other: an independent check by points spread over each.

usage: penetration.py DIR [--samples 6000] [--muscles]

Prints every pair with more than 0.05 mm, deepest first, and the greatest depth.  --muscles leaves pairs without a muscle out.
"""
import argparse
import itertools
import pathlib
import sys

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

FIRM = ("femur", "hip_bone", "femoral_cartilage", "acetabular_cartilage")
TOLERATED = 0.05


def spread(mesh, n, rng):
    points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
    corners = points[vtk_to_numpy(mesh.GetPolys().GetData()).reshape(-1, 4)[:, 1:]]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    chosen = rng.choice(len(corners), n, p=area / area.sum())
    w = rng.dirichlet((1, 1, 1), n)
    return np.concatenate([points, np.einsum("nk,nkd->nd", w, corners[chosen])])


def depth(points, mesh):
    """Greatest depth of the points inside a closed surface, mm."""
    low, high = np.array(mesh.GetBounds()).reshape(3, 2).T
    points = points[((points > low) & (points < high)).all(1)]
    if len(points) == 0:
        return 0.0
    cloud, place = vtk.vtkPolyData(), vtk.vtkPoints()
    place.SetData(numpy_to_vtk(points, deep=True))
    cloud.SetPoints(place)
    enclosed = vtk.vtkSelectEnclosedPoints()
    enclosed.SetInputData(cloud)
    enclosed.SetSurfaceData(mesh)
    enclosed.Update()
    inside = vtk_to_numpy(enclosed.GetOutput().GetPointData().GetArray("SelectedPoints")) > 0
    points = points[inside]
    if len(points) == 0:
        return 0.0
    signed = vtk.vtkImplicitPolyDataDistance()
    signed.SetInput(mesh)
    values = vtk.vtkDoubleArray()
    signed.FunctionValue(numpy_to_vtk(points, deep=True), values)
    return max(0.0, -vtk_to_numpy(values).min())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--samples", type=int, default=6000)
    parser.add_argument("--muscles", action="store_true")
    options = parser.parse_args()
    meshes = {}
    for path in sorted(options.folder.glob("*.ply")):
        if path.stem.startswith("union_"):
            continue
        reader = vtk.vtkPLYReader()
        reader.SetFileName(str(path))
        reader.Update()
        meshes[path.stem] = reader.GetOutput()
    if len(meshes) < 2:
        sys.exit(f"{options.folder} holds no two surfaces (.ply)")
    rng = np.random.default_rng(1)
    points = {name: spread(mesh, options.samples, rng) for name, mesh in meshes.items()}
    rows = []
    for a, b in itertools.permutations(meshes, 2):
        if options.muscles and all(n in FIRM for n in (a, b)):
            continue
        rows.append((depth(points[a], meshes[b]), a, b))
    rows.sort(reverse=True)
    for d, a, b in rows:
        if d > TOLERATED:
            print(f"{a} in {b}: {d:.3f} mm")
    print(f"greatest depth {rows[0][0]:.3f} mm; {sum(d > TOLERATED for d, _, _ in rows)} of {len(rows)} ordered pairs above {TOLERATED} mm")


if __name__ == "__main__":
    main()
