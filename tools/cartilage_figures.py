"""Figures of a cartilage beside its true surface that one distance of both closed surfaces does not tell.

Both surfaces consist of two sides with a common rim, the bone side first: the truth's header says how many triangles that
is, a result of coxa has the same number on both sides.  Units mm.
"""
import numpy as np
import vtk
from scipy.spatial import cKDTree
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

THICK = 1.2       # cartilage at least so thick (mm) counts for the overlap
GRID = 0.4        # mm, of the overlap's voxels
PER_MM2 = 4.0     # samples


def n_bone_side(path, n_faces):
    """Triangles on the bone side: as the file's header says, else half of them."""
    with open(path, "rb") as file:
        for line in iter(file.readline, b""):
            words = line.split()
            if words[:2] == [b"comment", b"bone_side_faces"]:
                return int(words[2])
            if words == [b"end_header"]:
                break
    return n_faces // 2


def surface_of(points, faces):
    surface = vtk.vtkPolyData()
    vertices = vtk.vtkPoints()
    vertices.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    cells = vtk.vtkCellArray()
    cells.SetCells(len(faces), numpy_to_vtkIdTypeArray(np.insert(faces, 0, 3, axis=1).ravel().astype(np.int64), deep=True))
    surface.SetPoints(vertices)
    surface.SetPolys(cells)
    return surface


def sides(path, evaluator):
    """The bone side and the articular side, as open surfaces."""
    reader = vtk.vtkPLYReader()
    reader.SetFileName(str(path))
    reader.Update()
    points, faces = evaluator.arrays(reader.GetOutput())
    n = n_bone_side(path, len(faces))
    return surface_of(points, faces[:n]), surface_of(points, faces[n:])


def distance(a, b, evaluator):
    """Mean of both directions' mean distances of two surfaces."""
    there = np.abs(evaluator.signed(evaluator.sample(a, PER_MM2), b)).mean()
    back = np.abs(evaluator.signed(evaluator.sample(b, PER_MM2), a)).mean()
    return 0.5 * (there + back)


def thickness(bone_side, articular_side, evaluator):
    """Places on the bone side, spread evenly, and the distance of each to the articular side."""
    places = evaluator.sample(bone_side, PER_MM2)
    return places, np.abs(evaluator.signed(places, articular_side))


def overlap(result, truth, places, thick, evaluator):
    """Dice of the volumes nearest to places of the true bone side where the cartilage is thick enough."""
    surfaces = [evaluator.outward(evaluator.read(str(path))) for path in (result, truth)]
    bounds = np.array([s.GetBounds() for s in surfaces])
    low, high = bounds[:, ::2].min(0) - 1.0, bounds[:, 1::2].max(0) + 1.0
    size = np.ceil((high - low) / GRID).astype(int) + 1
    filled = [evaluator.fill(s, low, size, GRID) for s in surfaces]
    voxels = np.flatnonzero(filled[0] | filled[1])
    at = low + GRID * np.stack([voxels % size[0], voxels // size[0] % size[1], voxels // (size[0] * size[1])], axis=1)
    counted = voxels[thick[cKDTree(places).query(at)[1]] >= THICK]
    x, y = filled[0][counted], filled[1][counted]
    return 2.0 * (x & y).sum() / (x.sum() + y.sum()) if counted.size else float("nan")


def figures(result, truth, evaluator):
    """bone_side, articular_side: mean distances; thickness: error of its mean; dice: where the truth is thick."""
    ours, true = sides(result, evaluator), sides(truth, evaluator)
    places, thick = thickness(*true, evaluator)
    return {
        "bone_side": distance(ours[0], true[0], evaluator),
        "articular_side": distance(ours[1], true[1], evaluator),
        "thickness": thickness(*ours, evaluator)[1].mean() - thick.mean(),
        "dice": overlap(result, truth, places, thick, evaluator),
    }
