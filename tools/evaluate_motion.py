#!/usr/bin/python3
"""Measures `coxa track` against known movements and prints the tables of docs/motion.md.

usage: evaluate_motion.py [--coxa build/release/coxa] [--shared ../shared] [--only star|perturbed|functional|simulated]
                          [--draws 50] [--seeds 30] [--first-seed 6001] [--methods paper,rigid,...]

star        motion/foroit/star_arc, calibrated on its first frame from the bone pins, every method
perturbed   the same with 2 mm errors in marker registration and pelvis centre, 1 mm in the femur's; then simulated
            examinations, one draw each
functional  the same with the joint centre found by SCoRE from the thigh markers' rigid poses; then simulated examinations
simulated   eval/sta_simulate.py, three movements and one with a common rotation of 6 degrees
"""
import argparse, csv, json, os, subprocess, sys, tempfile
import numpy as np

METHODS = ["paper", "rigid", "point_cluster", "ball_joint", "ball_joint_ml", "coxa"]
AXES = ("flexion", "adduction", "internal_rotation")
HERE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def table(path):
    with open(path) as f:
        rows = list(csv.DictReader(line for line in f if not line.startswith("#")))
    return {key: np.array([float(r[key]) for r in rows]) for key in rows[0]}


def stack(t, *keys):
    return np.stack([t[k] for k in keys], 1)


def track(coxa, markers, model, method, folder):
    """Runs `coxa track`; returns errors' companions: angles, intervals (degrees) and head (mm)."""
    json.dump(model, open(f"{folder}/model.json", "w"))
    with open(f"{folder}/config.toml", "w") as f:
        f.write(f'model_file = "model.json"\nmethod = "{method}"\n')
    command = [coxa, "track", "--markers", markers, "--config", f"{folder}/config.toml", "--out", f"{folder}/m.csv", "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(command)}\n{done.stdout}{done.stderr}")
    t = table(f"{folder}/m.csv")
    return (stack(t, *(a + "_deg" for a in AXES)), stack(t, *(a + "_interval_deg" for a in AXES)),
            stack(t, "head_x_mm", "head_y_mm", "head_z_mm"))


def truth_of(path):
    t = table(path)
    return stack(t, "hip_flex_deg", "hip_add_deg", "hip_introt_deg"), stack(t, "RHJC_x", "RHJC_y", "RHJC_z"), t


def figures(result, angles, head):
    error = (result[0] - angles + 180) % 360 - 180
    return {"mean": error.mean(0), "rms": np.sqrt((error ** 2).mean(0)), "sd": error.std(0, ddof=1),
            "inside": (np.abs(error) <= result[1]).mean(0), "width": result[1].mean(0),
            "head": np.sqrt(((result[2] - head) ** 2).sum(1).mean())}


def read_trc(path):
    lines = open(path).read().split("\n")
    names = [n for n in lines[3].split("\t")[2:] if n.strip()]
    frames = np.array([[float(v) for v in l.split("\t")[2:2 + 3 * len(names)]] for l in lines[6:] if l.strip()])
    return names, frames.reshape(len(frames), -1, 3)


def star_model(shared):
    """The hip model that an MRI with markers would give: everything from the first frame of the truth."""
    folder = f"{shared}/data/motion/foroit"
    angles, centre, t = truth_of(f"{folder}/star_arc_truth.csv")
    names, markers = read_trc(f"{folder}/star_arc.trc")
    pose = {b: (np.array([[t[f"{b}R{i}{j}"][0] for j in range(3)] for i in range(3)]),
                np.array([t[f"{b}_t{k}"][0] for k in "xyz"])) for b in ("pelvis", "femur")}
    local = lambda bone, p: (pose[bone][0].T @ (p - pose[bone][1])).tolist()
    model = {"side": "right", "calibration_frame": 1, "source": "bone pins, first frame",
             "joint_centre_pelvis_mm": local("pelvis", centre[0]), "joint_centre_femur_mm": local("femur", centre[0]),
             "pelvis_landmarks_mm": {n: local("pelvis", p) for n, p in zip(names, markers[0]) if "SI" in n},
             "thigh_markers_femur_mm": {n: local("femur", p) for n, p in zip(names, markers[0]) if "SI" not in n}}
    return f"{folder}/star_arc.trc", model, angles, centre


def simulate(a, folder, seed, motion, extra=()):
    """One trial of sta_simulate.py: markers, model, angles, head."""
    subprocess.run(["/usr/bin/python3", f"{a.shared}/eval/sta_simulate.py", f"{folder}/s", "--seed", str(seed),
                    "--motion", motion, *extra], check=True, stdout=subprocess.DEVNULL)
    model = {**json.load(open(f"{folder}/s_model.json")), "calibration_frame": 1}
    angles, head, _ = truth_of(f"{folder}/s_truth.csv")
    return f"{folder}/s.trc", model, angles, head


def print_row(label, f):
    print(f"{label:26s} | rms {' / '.join(f'{v:.2f}' for v in f['rms'])} | mean {' / '.join(f'{v:.2f}' for v in f['mean'])}"
          f" | sd {' / '.join(f'{v:.2f}' for v in f['sd'])} | inside {' / '.join(f'{100 * v:.0f}' for v in f['inside'])} %"
          f" | width {' / '.join(f'{v:.1f}' for v in f['width'])} | head {f['head']:.1f} mm", flush=True)


def mean_of(all_figures):
    return {k: np.mean([f[k] for f in all_figures], 0) for k in all_figures[0]}


def run_star(a, folder):
    markers, model, angles, centre = star_model(a.shared)
    for method in a.methods:
        print_row(f"star_arc {method}", figures(track(a.coxa, markers, model, method, folder), angles, centre))


def perturbed(model, rng):
    m = json.loads(json.dumps(model))
    m.update(marker_sd_mm=2, pelvis_centre_sd_mm=2, femur_centre_sd_mm=1)
    for label, p in m["thigh_markers_femur_mm"].items():
        m["thigh_markers_femur_mm"][label] = list(np.array(p) + rng.normal(0, 2, 3))
    m["joint_centre_pelvis_mm"] = list(np.array(model["joint_centre_pelvis_mm"]) + rng.normal(0, 2, 3))
    m["joint_centre_femur_mm"] = list(np.array(model["joint_centre_femur_mm"]) + rng.normal(0, 1, 3))
    return m


def run_perturbed(a, folder):
    markers, model, angles, centre = star_model(a.shared)
    for method in a.methods:
        rng = np.random.default_rng(7)
        print_row(f"perturbed {method}", mean_of([figures(track(a.coxa, markers, perturbed(model, rng), method, folder),
                                                          angles, centre) for _ in range(a.draws)]))
    rows = {m: [] for m in a.methods}
    for seed in range(a.first_seed, a.first_seed + a.seeds):
        markers, model, angles, head = simulate(a, folder, seed, "exam")
        model = perturbed(model, np.random.default_rng(seed))
        for method in a.methods:
            rows[method].append(figures(track(a.coxa, markers, model, method, folder), angles, head))
    for method in a.methods:
        print_row(f"perturbed exam {method}", mean_of(rows[method]))


def rigid_poses(x, y):
    xc, yc = x - x.mean(0), y - y.mean(1, keepdims=True)
    U, _, Vt = np.linalg.svd(np.einsum("nmi,mj->nij", yc, xc))
    D = np.tile(np.eye(3), (len(y), 1, 1))
    D[:, 2, 2] = np.linalg.det(U @ Vt)
    R = U @ D @ Vt
    return R, y.mean(1) - np.einsum("nij,j->ni", R, x.mean(0))


def with_score_centre(model, markers):
    """The model with SCoRE's joint centre, and how far it is off in the pelvis and in the femur."""
    names, data = read_trc(markers)
    is_pelvis = np.array(["SI" in n for n in names])
    RP, tP = rigid_poses(np.array([model["pelvis_landmarks_mm"][n] for n in names if "SI" in n]), data[:, is_pelvis])
    RF, tF = rigid_poses(np.array([model["thigh_markers_femur_mm"][n] for n in names if "SI" not in n]), data[:, ~is_pelvis])
    c = np.linalg.lstsq(np.concatenate([RP, -RF], 2).reshape(-1, 6), (tF - tP).ravel(), rcond=None)[0]
    off = [np.linalg.norm(c[:3] - model["joint_centre_pelvis_mm"]), np.linalg.norm(c[3:] - model["joint_centre_femur_mm"])]
    # 6.6 mm: of functional centres against dual fluoroscopy (docs/motion.md section 2), in both bones alike
    return {**model, "joint_centre_pelvis_mm": list(c[:3]), "joint_centre_femur_mm": list(c[3:]),
            "pelvis_centre_sd_mm": 6.6, "femur_centre_sd_mm": 6.6}, off


def run_functional(a, folder):
    markers, model, angles, centre = star_model(a.shared)
    model, off = with_score_centre(model, markers)
    print(f"SCoRE centre is {off[0]:.1f} mm from the true one in the pelvis, {off[1]:.1f} mm in the femur")
    for method in a.methods:
        print_row(f"functional {method}", figures(track(a.coxa, markers, model, method, folder), angles, centre))
    rows, offs = {m: [] for m in a.methods}, []
    for seed in range(a.first_seed, a.first_seed + a.seeds):
        markers, model, angles, head = simulate(a, folder, seed, "exam")
        model, off = with_score_centre(model, markers)
        offs.append(off)
        for method in a.methods:
            rows[method].append(figures(track(a.coxa, markers, model, method, folder), angles, head))
    print("simulated: SCoRE centre is off by {:.1f} mm in the pelvis, {:.1f} mm in the femur (RMS)".format(
        *np.sqrt(np.mean(np.square(offs), 0))))
    for method in a.methods:
        print_row(f"functional exam {method}", mean_of(rows[method]))


def run_simulated(a, folder):
    for motion, extra in (("exam", []), ("gait", []), ("squat", []), ("exam", ["--bias", "6"])):
        rows = {m: [] for m in a.methods}
        for seed in range(a.first_seed, a.first_seed + a.seeds):
            markers, model, angles, head = simulate(a, folder, seed, motion, extra)
            for method in a.methods:
                rows[method].append(figures(track(a.coxa, markers, model, method, folder), angles, head))
        for method in a.methods:
            print_row(f"{motion}{'+bias' if extra else ''} {method}", mean_of(rows[method]))


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--coxa", default=f"{HERE}/build/release/coxa")
    p.add_argument("--shared", default=os.path.join(os.path.dirname(HERE), "shared"))
    p.add_argument("--only", choices=["star", "perturbed", "functional", "simulated"])
    p.add_argument("--draws", type=int, default=50)
    p.add_argument("--seeds", type=int, default=30)
    p.add_argument("--first-seed", type=int, default=6001, help="of sta_simulate.py; 1-30, 1001-2100 and 5001-5030 were looked at while the method was made")
    p.add_argument("--methods", type=lambda s: s.split(","), default=METHODS)
    p.add_argument("--write-star-model", metavar="FILE", help="write star_arc's hip model as JSON and stop")
    a = p.parse_args()
    if a.write_star_model:
        json.dump(star_model(a.shared)[1], open(a.write_star_model, "w"), indent=1)
        return
    runs = {"star": run_star, "perturbed": run_perturbed, "functional": run_functional, "simulated": run_simulated}
    with tempfile.TemporaryDirectory() as folder:
        for name, run in runs.items():
            if a.only in (None, name):
                run(a, folder)


if __name__ == "__main__":
    main()
