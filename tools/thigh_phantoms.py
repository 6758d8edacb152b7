"""The phantoms thigh_*: whose they are, their true surfaces and labels, and how results are judged on them."""
import pathlib
import subprocess

import nibabel as nib
import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk

from evaluation import distance_text, distances

VISIBLE_HUMAN = ("vhf", "vhm")
# label numbers (../shared/data/README.md); structures that a label map merges are judged as one
BODY_LABELS = {name: [i + 5] for i, name in enumerate([
    "gluteus_maximus", "gluteus_medius", "gluteus_minimus", "tensor_fasciae_latae", "sartorius", "rectus_femoris",
    "vastus_lateralis", "vastus_medialis", "vastus_intermedius", "iliacus", "psoas_major", "pectineus", "adductor_brevis",
    "adductor_longus", "adductor_magnus", "gracilis", "biceps_femoris_long", "biceps_femoris_short", "semitendinosus",
    "semimembranosus", "piriformis", "obturator_externus", "obturator_internus", "quadratus_femoris", "gemellus_superior",
    "gemellus_inferior"])}
BODY_BONES = {"femur": [2], "hip_bone": [1]}
MAP_BONES = {"femur": [2], "hip_bone": [1]}
MAP_LABELS = {
    "gluteus_maximus": [5], "gluteus_medius": [6], "gluteus_minimus": [7], "iliacus": [8], "obturator_externus": [9],
    "obturator_internus": [10], "pectineus": [11], "piriformis": [12], "psoas_major": [13],
    "adductor_brevis+adductor_longus+adductor_magnus": [14], "biceps_femoris_long+biceps_femoris_short": [15],
    "gracilis": [16], "rectus_femoris": [17], "sartorius": [18], "semimembranosus": [19], "semitendinosus": [20],
    "tensor_fasciae_latae": [21], "vastus_lateralis+vastus_intermedius": [22], "vastus_medialis": [23]}


def is_thigh(name):
    return name.startswith("thigh_")


def subject_and_side(name):
    return name.split("_")[1:3]


def bones_of(name):
    return BODY_BONES if subject_and_side(name)[0] in VISIBLE_HUMAN else MAP_BONES


def muscles_of(name):
    return BODY_LABELS if subject_and_side(name)[0] in VISIBLE_HUMAN else MAP_LABELS


def read_labels(shared, name):
    image = nib.load(shared / f"data/phantom/{name}_labels.nii.gz")
    affine = image.affine.copy()
    affine[:2] *= -1
    return np.asarray(image.dataobj), affine


def surface_of_mask(mask, affine, smoothing=1.0):
    """Surface of a mask, LPS mm, smoothed by about a millimetre against the slices' steps."""
    from scipy import ndimage as ndi
    spacing = np.linalg.norm(affine[:3, :3], axis=0)
    values = np.pad(ndi.gaussian_filter(mask.astype(np.float32), smoothing / spacing), 1)
    grid = vtk.vtkImageData()
    grid.SetDimensions(values.shape)
    grid.GetPointData().SetScalars(numpy_to_vtk(values.ravel(order="F"), deep=True))
    contour = vtk.vtkMarchingCubes()
    contour.SetInputData(grid)
    contour.SetValue(0, 0.5)
    place = vtk.vtkTransform()
    matrix = affine @ np.array([[1, 0, 0, -1], [0, 1, 0, -1], [0, 0, 1, -1], [0, 0, 0, 1.0]])
    place.SetMatrix(matrix.ravel())
    moved = vtk.vtkTransformPolyDataFilter()
    moved.SetTransform(place)
    moved.SetInputConnection(contour.GetOutputPort())
    moved.Update()
    return moved.GetOutput()


def fit_sphere(points):
    x = np.linalg.lstsq(np.c_[2 * points, np.ones(len(points))], (points ** 2).sum(1), rcond=None)[0]
    return x[:3], np.sqrt(x[3] + (x[:3] ** 2).sum())


def joint_of_bones(femur, hip_bone):
    """Points of the femoral head and of the socket: where each bone faces the other."""
    from scipy.spatial import cKDTree
    head = femur[cKDTree(hip_bone).query(femur)[0] < 7]
    for _ in range(10):
        centre, radius = fit_sphere(head)
        head = femur[np.abs(np.linalg.norm(femur - centre, axis=1) - radius) < 1.5]
    return head, hip_bone[np.linalg.norm(hip_bone - centre, axis=1) < radius + 6]


def truth_points(shared, name, surfaces):
    """Points of femur, hip bone, head and socket, LPS mm, by the names that landmarks are found from."""
    subject, side = subject_and_side(name)
    if subject in VISIBLE_HUMAN:
        folder = shared / "data/visible_human" / subject / side
        points = {s: surfaces.arrays(surfaces.read(str(folder / f"{s}.ply")))[0] for s in ("femur", "hip_bone")}
    else:
        labels, affine = read_labels(shared, name)
        points = {s: surfaces.arrays(surface_of_mask(np.isin(labels, v), affine))[0] for s, v in MAP_BONES.items()}
    points["femoral_cartilage"], points["acetabular_cartilage"] = joint_of_bones(points["femur"], points["hip_bone"])
    return points


def judge_bones(work, shared, name, image, evaluator):
    """{structure: text}: against surfaces where there are any, else against the labels."""
    subject, side = subject_and_side(name)
    cells = {}
    for structure, values in bones_of(name).items():
        result = work / name / f"{structure}.ply"
        if not result.exists():
            cells[structure] = "failed"
        elif subject in VISIBLE_HUMAN:
            truth = shared / "data/visible_human" / subject / side / f"{structure}.ply"
            cells[structure] = distance_text(distances(result, truth, image, evaluator))
        else:
            cells[structure] = "{:.3f} / {:.2f} / {:+.2f}".format(*label_distance(result, shared, name, values))
    return cells


def label_distance(surface, shared, name, values):
    """assd, hd95 and bias by ../shared/eval/label_distance.py."""
    script = pathlib.Path(shared) / "eval/label_distance.py"
    labels = shared / f"data/phantom/{name}_labels.nii.gz"
    done = subprocess.run(["/usr/bin/python3", script, surface, labels, ",".join(map(str, values))],
                          capture_output=True, text=True)
    words = done.stdout.split()
    return (float(words[1]), float(words[3]), float(words[5])) if done.returncode == 0 and words else (np.nan,) * 3


def fill(surface_path, shape, affine, evaluator):
    """Which voxels of an axis-parallel grid lie in a closed surface."""
    spacing = np.diag(affine)[:3]
    if (spacing <= 0).any() or np.abs(affine[:3, :3] - np.diag(spacing)).max() > 1e-6:
        raise ValueError("the label map's grid must be parallel to the LPS axes")
    stencil = vtk.vtkPolyDataToImageStencil()
    stencil.SetInputData(evaluator.outward(evaluator.read(str(surface_path))))
    stencil.SetOutputOrigin(affine[:3, 3])
    stencil.SetOutputSpacing(spacing)
    stencil.SetOutputWholeExtent(0, shape[0] - 1, 0, shape[1] - 1, 0, shape[2] - 1)
    image = vtk.vtkImageStencilToImage()
    image.SetInputConnection(stencil.GetOutputPort())
    image.SetInsideValue(1)
    image.SetOutsideValue(0)
    image.SetOutputScalarTypeToUnsignedChar()
    image.Update()
    from vtk.util.numpy_support import vtk_to_numpy
    return vtk_to_numpy(image.GetOutput().GetPointData().GetScalars()).reshape(shape, order="F").astype(bool)


def distance_in_box(surface, labels, affine, values, evaluator, margin=15.0, step=0.8):
    """assd, hd95 and bias by the formula of ../shared/eval/label_distance.py, in a box about label and surface alone: the
    same within its own resolution (0.5 mm), in a tenth of the time."""
    from scipy import ndimage as ndi
    from scipy.spatial import cKDTree
    spacing = np.linalg.norm(affine[:3, :3], axis=0)
    mesh = evaluator.outward(evaluator.read(str(surface)))
    points = evaluator.sample(mesh, 2.0)
    index = (points - affine[:3, 3]) @ np.linalg.inv(affine[:3, :3]).T
    inner, last = 4 / spacing, np.array(labels.shape) - 1
    in_view = lambda at: ((at > inner) & (at < last - inner)).all(1)
    truth = np.argwhere(np.isin(labels, values))
    index = index[in_view(index)]
    if not len(truth) or not len(index):
        return (np.nan,) * 3
    low = np.maximum(0, np.floor(np.minimum(truth.min(0), index.min(0)) - margin / spacing)).astype(int)
    high = np.minimum(last, np.ceil(np.maximum(truth.max(0), index.max(0)) + margin / spacing)).astype(int) + 1
    box = np.isin(labels[tuple(slice(a, b) for a, b in zip(low, high))], values)
    fine = ndi.zoom(ndi.gaussian_filter(box.astype(np.float32), .5 / spacing), spacing / step, order=1)
    scale = (np.array(box.shape) - 1) / (np.array(fine.shape) - 1)
    depth = ndi.distance_transform_edt(fine < .5, sampling=step) - ndi.distance_transform_edt(fine >= .5, sampling=step)
    away = ndi.map_coordinates(depth, ((index - low) / scale).T, order=1)
    edge = np.argwhere((fine >= .5) & (np.abs(depth) < .9)) * scale + low
    edge = edge[in_view(edge)] @ affine[:3, :3].T + affine[:3, 3]
    missed = np.maximum(cKDTree(evaluator.sample(evaluator.read(str(surface)), 8.0)).query(edge)[0] - .3, 0)
    return ((np.abs(away).mean() + missed.mean()) / 2, max(np.percentile(np.abs(away), 95), np.percentile(missed, 95)), away.mean())


def judge_muscles(folder, shared, name, evaluator):
    """[(structures, millilitres in view, assd, hd95, bias, Dice)]; several in one where the label map merges them."""
    labels, affine = read_labels(shared, name)
    rows = []
    for structures, values in muscles_of(name).items():
        paths = [folder / f"{s}.ply" for s in structures.split("+")]
        if not all(p.exists() for p in paths):
            continue
        truth = np.isin(labels, values)
        found = np.any([fill(p, labels.shape, affine, evaluator) for p in paths], axis=0)
        dice = 2 * (truth & found).sum() / max(1, truth.sum() + found.sum())
        surface = paths[0]
        if len(paths) > 1:
            surface = folder / f"union_{structures.replace('+', '_')}.ply"
            writer = vtk.vtkPLYWriter()
            writer.SetInputData(surface_of_mask(found, affine, 0.5))
            writer.SetFileName(str(surface))
            writer.Write()
        distances = distance_in_box(surface, labels, affine, values, evaluator)
        rows.append((structures, truth.sum() * np.linalg.det(affine[:3, :3]) / 1000, *distances, dice))
    return rows
