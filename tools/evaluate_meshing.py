#!/usr/bin/python3
"""Meshes the cartilages of ../shared/data/libhip (or other surfaces) and prints the figures against the limits asked for.

usage: evaluate_meshing.py --coxa build/release/coxa [--shared ../shared] [--layers N] [--tets N] [--order 2] [--only TEXT,…]
                           [--work DIR] [--seconds N] [--resume] [--all-cartilages | --bodies | --labels | --table] [SURFACE …]

--bodies: bones, muscles, ligaments, labra and the cartilages other than libhip's, each at the size that coxa chooses; --labels: the
largest piece of every label of ../shared/data/labels, its surface by marching cubes, evened.  Where a surface was repaired, the
envelope error against the repaired surface is told too.  Every outcome is kept in DIR beside
the mesh; --table meshes nothing and shows all kept outcomes by class of body.

Figures by ../shared/eval/mesh_quality.py; time is processor time of `coxa mesh`, so that neighbours on the machine do not count,
and memory its largest resident set.  Default limits without --layers: those of the paper mesh; with it, or with
--order 2: of the mechanics mesh.
With --order 2 elements have ten nodes: each facet of the boundary is judged as four triangles by its mid-edge nodes, and `jacobian`
is the least Jacobian determinant over that of the corners, a bound that coxa gives for the whole of each element.
"""
import argparse
import json
import os
import pathlib
import resource
import subprocess
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
# figure: (limit, aim, +1 where more is better), for the mesh without layers; None: no aim
PAPER = {"tets": (20000, None, -1), "aspect_mean": (0.72, 0.77, 1), "aspect_p05": (0.50, 0.60, 1), "aspect_min": (0.15, 0.25, 1),
         "dihedral_min": (10, 15, 1), "dihedral_max": (165, 155, -1), "envelope_rms": (0.05, 0.03, -1),
         "envelope_max": (0.30, 0.15, -1), "inverted": (0, None, -1), "manifold": (1, None, 1), "seconds": (5, None, -1),
         "megabytes": (500, None, -1)}
MECHANICS = {**PAPER, "tets": (90000, None, -1), "aspect_mean": (0.70, None, 1), "aspect_p05": (0.50, None, 1),
             "aspect_min": (0.15, None, 1), "seconds": (15, None, -1), "megabytes": (1000, None, -1)}
TEN_NODE = {**MECHANICS, "tets": (20000, None, -1), "jacobian": (0.0, None, 1)}
# bodies of any size: no limit of elements or time
BODY = {**PAPER, "tets": (400000, None, -1), "seconds": (60, None, -1), "megabytes": (1000, None, -1)}
FORMATS = {"tets": "6.0f", "inverted": "3.0f", "manifold": "3.0f", "dihedral_min": "6.1f", "dihedral_max": "6.1f", "seconds": "5.1f",
           "megabytes": "5.0f"}


def cartilages(shared, every):
    kinds = ("femoral", "acetabular", "sacroiliac") if every else ("femoral", "acetabular")
    folder = shared / "data/libhip"
    return sorted(p for kind in kinds for p in folder.glob(f"*/*/{kind}_cartilage.ply"))


def class_of(name):
    """Of a body, by the words in its name; labels carry a number, whatever is not named is a muscle."""
    if name.rsplit("_", 1)[-1].isdigit():
        return "labels"
    kinds = {"labrum": "labra", "ligament": "ligaments",
             "femoral_cartilage": "femoral and acetabular cartilages", "acetabular_cartilage": "femoral and acetabular cartilages",
             "cartilage": "sacroiliac and pubic cartilages", "femur": "femora", "hip_bone": "hip bones", "sacrum": "sacra",
             "patella": "patellae"}
    return next((kind for word, kind in kinds.items() if word in name), "muscles")


def bodies(shared):
    """A joint capsule of the ligaments is an open sheet without volume, and a skin is no body to be meshed: both left out."""
    found = [p for folder in ("visible_human", "ligaments_cc_by_sa", "libhip") for p in (shared / "data" / folder).rglob("*.ply")]
    return sorted(p for p in found if p.stem not in ("joint_capsule", "skin_synthetic", "femur_fitted", "hip_bone_fitted") and
                  not ("libhip" in p.parts and p.stem in ("femoral_cartilage", "acetabular_cartilage")))


def label_surfaces(shared, work):
    """Surfaces of labels 1 to 23, written to `work`."""
    import vtk
    surfaces = []
    for path in sorted((shared / "data/labels").rglob("*.nii.gz")):
        reader = vtk.vtkNIFTIImageReader()
        reader.SetFileName(str(path))
        reader.Update()
        # a label at the border of the image gets a closed surface
        padded = vtk.vtkImageConstantPad()
        padded.SetInputConnection(reader.GetOutputPort())
        padded.SetOutputWholeExtent([e + step for e, step in zip(reader.GetOutput().GetExtent(), (-1, 1) * 3)])
        for label in range(1, 24):
            stages = [vtk.vtkDiscreteMarchingCubes(), vtk.vtkPolyDataConnectivityFilter(), vtk.vtkWindowedSincPolyDataFilter(),
                      vtk.vtkPLYWriter()]
            stages[0].SetValue(0, label)
            stages[1].SetExtractionModeToLargestRegion()
            stages[2].SetNumberOfIterations(30)
            stages[2].SetPassBand(0.02)
            stages[2].NormalizeCoordinatesOn()
            for before, after in zip([padded] + stages, stages):
                after.SetInputConnection(before.GetOutputPort())
            surfaces.append(work / f"{path.name.split('.')[0]}_{label}.ply")
            stages[3].SetFileName(str(surfaces[-1]))
            stages[3].Write()
    return surfaces


def run_mesh(coxa, surface, out, options, most_seconds):
    """Processor seconds, megabytes, whether the surface was repaired; raises RuntimeError with the program's last words."""
    def stop_in_time():
        if most_seconds:
            resource.setrlimit(resource.RLIMIT_CPU, (most_seconds, most_seconds))

    command = [str(coxa), "mesh", "--surface", str(surface), "--out", str(out), *options]
    log = out.with_suffix(".log")
    with open(log, "w") as words:
        process = subprocess.Popen(command, stdout=words, stderr=subprocess.STDOUT, preexec_fn=stop_in_time)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode < 0:
        raise RuntimeError(f"stopped after {usage.ru_utime + usage.ru_stime:.0f} s of processor time")
    if process.returncode != 0:
        raise RuntimeError(log.read_text().strip().splitlines()[-1])
    repaired = f"warning: {surface}" in log.read_text()
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, repaired


def outside(points, body):
    """Those outside a closed surface: what a repaired surface had within itself is no part of its shape."""
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    cloud = vtk.vtkPolyData()
    cloud.SetPoints(vtk.vtkPoints())
    cloud.GetPoints().SetData(numpy_to_vtk(points, deep=True))
    select = vtk.vtkSelectEnclosedPoints()
    select.SetInputData(cloud)
    select.SetSurfaceData(body)
    select.Update()
    return points[vtk_to_numpy(select.GetOutput().GetPointData().GetArray("SelectedPoints")) == 0]


def curved_boundary(mesh, facets):
    """Points of a ten-node mesh and its boundary, four triangles to a facet."""
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(mesh))
    reader.Update()
    points = vtk_to_numpy(reader.GetOutput().GetPoints().GetData()).astype(float)
    cells = vtk_to_numpy(reader.GetOutput().GetCells().GetConnectivityArray()).reshape(-1, 10)
    middle = {}
    for k, (a, b) in enumerate([(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]):
        middle.update(zip(map(tuple, np.sort(cells[:, [a, b]], axis=1)), cells[:, 4 + k]))
    parts = []
    for a, b, c in facets:
        ab, bc, ca = (middle[tuple(sorted(e))] for e in ((a, b), (b, c), (c, a)))
        parts += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return points, np.array(parts)


def figures_of(judge, mesh, surface, repaired, order):
    points, tets = judge.read_tets(str(mesh))
    truth = judge.read_surface(str(surface))
    volumes, dihedral, aspect = judge.quality(points, tets)
    facets = judge.boundary(tets)
    ways = np.concatenate([facets[:, [0, 1]], facets[:, [1, 2]], facets[:, [2, 0]]])
    counts = np.unique(np.sort(ways, axis=1), axis=0, return_counts=True)[1]
    oriented = len(np.unique(ways, axis=0)) == len(ways)
    envelope = judge.to_polydata(*(curved_boundary(mesh, facets) if order == 2 else (points, facets)))
    of_truth = judge.samples(truth)
    there = judge.distances(outside(of_truth, envelope) if repaired else of_truth, envelope)
    of_envelope = judge.samples(envelope)
    back = judge.distances(of_envelope, truth)
    filled = {}
    if order == 2:
        filled["jacobian"] = json.loads(mesh.with_suffix(".json").read_text())["figures"]["least_jacobian_ratio"]
    kept = mesh.with_name(mesh.stem + "_repaired.ply")
    if repaired and kept.exists():
        new = judge.read_surface(str(kept))
        both = np.concatenate([judge.distances(judge.samples(new), envelope), judge.distances(of_envelope, new)])
        filled |= {"filled_rms": np.sqrt(np.mean(both ** 2)), "filled_max": both.max()}
    return {**filled, "tets": len(tets), "aspect_mean": aspect.mean(), "aspect_p05": np.percentile(aspect, 5), "aspect_min": aspect.min(),
            "dihedral_min": dihedral.min(), "dihedral_max": dihedral.max(), "inverted": (volumes <= 0).sum(),
            "envelope_rms": np.sqrt(np.mean(np.concatenate([there, back]) ** 2)), "envelope_max": max(there.max(), back.max()),
            "manifold": int((counts == 2).all() and oriented)}


def missed(figures, limits, which):
    return [k for k, bound in limits.items() if bound[which] is not None and bound[2] * figures[k] < bound[2] * bound[which]]


def text_of(key, value):
    return format(value, FORMATS.get(key, "6.3f"))


def print_table(work, limits):
    """One row a class: how many were run, which limits how many of them miss, the worst (and median) figures, and for repaired
    surfaces the worst envelope error against what they were repaired to."""
    classes = {}
    for path in sorted(work.glob("*.figures.json")):
        outcome = json.loads(path.read_text())
        classes.setdefault(class_of(path.name.split(".")[0]), []).append(outcome)
    shown = ("tets", "aspect_mean", "aspect_p05", "aspect_min", "dihedral_min", "dihedral_max", "envelope_rms", "envelope_max", "seconds")
    print("| class | run | miss a limit |", " | ".join(shown), "| repaired: rms, max |")
    print("|---" * (4 + len(shown)) + "|")
    for kind, outcomes in sorted(classes.items()):
        rows = [o for o in outcomes if "failed" not in o]
        over = [k for r in rows for k in missed(r, limits, 0)] + ["no mesh"] * (len(outcomes) - len(rows))
        n_bad = sum(bool(missed(r, limits, 0)) for r in rows) + len(outcomes) - len(rows)
        words = ", ".join(f"{k} {over.count(k)}" for k in sorted(set(over)))
        new = [[r["filled_rms"], r["filled_max"]] for r in rows if "filled_rms" in r]
        mended = f"{len(new)}: {max(n[0] for n in new):.3f}, {max(n[1] for n in new):.3f}" if new else ""
        cells = []
        for k in shown if rows else ():
            values = [r[k] for r in rows]
            worst = min(values) if limits[k][2] > 0 else max(values)
            cells.append(f"{text_of(k, worst).strip()} ({text_of(k, np.median(values)).strip()})")
        print(f"| {kind} | {len(outcomes)} | {n_bad}{': ' + words if words else ''} |", " | ".join(cells), f"| {mended} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--coxa", type=pathlib.Path, default=ROOT / "build/release/coxa")
    parser.add_argument("--shared", type=pathlib.Path, default=ROOT.parent / "shared")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("/tmp/coxa_meshing"))
    parser.add_argument("--layers", type=int)
    parser.add_argument("--tets", type=int)
    parser.add_argument("--order", type=int, choices=(1, 2), default=1)
    parser.add_argument("--only", default="")
    parser.add_argument("--all-cartilages", action="store_true", help="sacroiliac ones too")
    parser.add_argument("--bodies", action="store_true", help="all but libhip's femoral and acetabular cartilages")
    parser.add_argument("--labels", action="store_true", help="surfaces of the label maps")
    parser.add_argument("--table", action="store_true", help="of the outcomes kept in --work")
    parser.add_argument("--resume", action="store_true", help="what has an outcome in --work is not meshed again")
    parser.add_argument("--seconds", type=int, help="of processor time after which a body is given up")
    parser.add_argument("surfaces", nargs="*", type=pathlib.Path)
    arguments = parser.parse_args()
    if arguments.table:
        print_table(arguments.work, BODY)
        return 0
    sys.path.insert(0, str(arguments.shared / "eval"))
    import mesh_quality as judge

    arguments.work.mkdir(parents=True, exist_ok=True)
    of_any_size = arguments.bodies or arguments.labels
    limits = BODY if of_any_size else TEN_NODE if arguments.order == 2 else MECHANICS if arguments.layers else PAPER
    most = arguments.tets or (None if of_any_size else limits["tets"][0])
    options = (["--tets", str(most)] if most else []) + (["--layers", str(arguments.layers)] if arguments.layers else [])
    options += ["--order", "2"] if arguments.order == 2 else []
    wanted = [w for w in arguments.only.split(",") if w]
    surfaces = (arguments.surfaces or (bodies(arguments.shared) if arguments.bodies else []) or
                (label_surfaces(arguments.shared, arguments.work) if arguments.labels else []) or
                cartilages(arguments.shared, arguments.all_cartilages))
    rows, failures, n_surfaces = [], 0, 0
    print(" ".join(limits), "| limits missed | aims missed")
    for surface in surfaces:
        name = "_".join(surface.with_suffix("").parts[-3:])
        if wanted and not any(w in name for w in wanted):
            continue
        out, kept = arguments.work / f"{name}.vtu", arguments.work / f"{name}.figures.json"
        if arguments.resume and kept.exists():
            continue
        n_surfaces += 1
        try:
            seconds, megabytes, repaired = run_mesh(arguments.coxa, surface, out, options, arguments.seconds)
            figures = {**figures_of(judge, out, surface, repaired, arguments.order), "seconds": seconds, "megabytes": megabytes}
        except RuntimeError as error:
            print(f"{name:34s} FAILED {error}", flush=True)
            kept.write_text(json.dumps({"failed": str(error)}))
            failures += 1
            continue
        kept.write_text(json.dumps(figures, default=float))
        rows.append(figures)
        over = missed(figures, limits, 0)
        failures += bool(over)
        print(f"{name:34s}", " ".join(text_of(k, figures[k]) for k in limits), "|", " ".join(over) or "none", "|",
              " ".join(k for k in missed(figures, limits, 1) if k not in over) or "none", "| repaired," if repaired else "",
              f"to the repaired surface {figures['filled_rms']:.3f} {figures['filled_max']:.3f}" if "filled_rms" in figures else "",
              flush=True)
    if rows:
        for k, (_, _, more) in limits.items():
            values = [r[k] for r in rows]
            worst = min(values) if more > 0 else max(values)
            print(f"{k:13s} median {text_of(k, np.median(values))} worst {text_of(k, worst)}")
    print(f"{failures} of {n_surfaces} surfaces miss a limit or fail")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
