#!/usr/bin/python3
"""Distance of segmented bones to the outlines drawn by hand in ../shared/data/mri/one_patient.

usage: evaluate_outlines.py SEGMENT_FOLDER [--shared ../shared]

For every axial slice of the pelvis stack the bones' surfaces are cut at the slice's height; reported is the distance within
the slice from the points of the cut to the nearest drawn border, mm, whatever bone was drawn there.
Needs Debian's python3-h5py, python3-pydicom and python3-scipy.
"""
import argparse
import pathlib
import sys

import h5py
import numpy as np
import pydicom
from scipy import ndimage
from scipy.spatial import cKDTree

ROOT = pathlib.Path(__file__).resolve().parent.parent
PELVIS_STACK = (505.0, 650.0)  # z of its slices, LPS mm
BONE = 4  # the drawings' label


def cut(points, triangles, z):
    """Points where the edges of a surface cross the height z."""
    corners = points[triangles]
    crossings = []
    for i, j in ((0, 1), (1, 2), (2, 0)):
        a, b = corners[:, i], corners[:, j]
        crossing = (a[:, 2] - z) * (b[:, 2] - z) < 0
        share = ((z - a[crossing, 2]) / (b[crossing, 2] - a[crossing, 2]))[:, None]
        crossings.append(a[crossing] + share * (b[crossing] - a[crossing]))
    return np.vstack(crossings)


def drawn_border(header, drawing):
    """Border pixels of the drawn bones, LPS mm; drawings are stored x first."""
    mask = drawing.T == BONE
    rows, columns = np.nonzero(mask & ~ndimage.binary_erosion(mask))
    across = np.array(header.ImageOrientationPatient, float)
    spacing = np.array(header.PixelSpacing, float)
    origin = np.array(header.ImagePositionPatient, float)
    return origin + np.outer(columns * spacing[1], across[:3]) + np.outer(rows * spacing[0], across[3:])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("segment", type=pathlib.Path)
    parser.add_argument("--shared", type=pathlib.Path, default=ROOT.parent / "shared")
    options = parser.parse_args()
    sys.path.insert(0, str(options.shared / "eval"))
    import surface_distance as surfaces

    patient = options.shared / "data/mri/one_patient"
    bones = {}
    for name in ("femur", "hip_bone"):
        points, triangles = surfaces.arrays(surfaces.read(str(options.segment / f"{name}.ply")))[:2]
        bones[name] = (np.array(points), np.array(triangles))
    distances = {name: [] for name in bones}
    for path in sorted((patient / "dicom").glob("*.dcm")):
        header = pydicom.dcmread(path, stop_before_pixels=True)
        z = float(header.ImagePositionPatient[2])
        if not PELVIS_STACK[0] < z < PELVIS_STACK[1]:
            continue
        with h5py.File(patient / "segmentation" / f"{path.stem}_Segmentation.h5") as file:
            border = drawn_border(header, np.squeeze(file["segmentation"][()]))
        tree = cKDTree(border[:, :2])
        for name, (points, triangles) in bones.items():
            section = cut(points, triangles, z)
            if len(section):
                distances[name].append(tree.query(section[:, :2])[0])
    for name, parts in distances.items():
        d = np.concatenate(parts)
        print(f"{name:10s} average {d.mean():.2f}  median {np.median(d):.2f}  95 % {np.percentile(d, 95):.2f} mm  points {len(d)}")


if __name__ == "__main__":
    main()
