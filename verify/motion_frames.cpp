// Bone frames on real bones: the table of docs/motion.md section 8.4.
#include <coxa/core/error.h>
#include <coxa/geom/fits.h>
#include <coxa/io/atlas_file.h>
#include <coxa/motion/joint_centre.h>
#include <coxa/pipeline/completed_bones.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>

#include "motion_cases.h"

namespace coxa::verify {

namespace fs = std::filesystem;

namespace {

// the vertices within `depth` of the farthest one along `direction`: their mean
Vec3 farthest(const Points& points, const Vec3& direction, double depth) {
  const VecX along = points * direction;
  const double limit = along.maxCoeff() - depth;
  Vec3 sum = Vec3::Zero();
  double n = 0.0;
  for (Index v = 0; v < points.rows(); ++v) {
    if (along[v] >= limit) sum += points.row(v).transpose(), n += 1.0;
  }
  return sum / n;
}

template <class Takes>
Points rows_where(const Points& points, const Takes& takes) {
  std::vector<Index> rows;
  for (Index v = 0; v < points.rows(); ++v) {
    if (takes(Vec3(points.row(v)))) rows.push_back(v);
  }
  return points(rows, Eigen::all);
}

// ASIS and PSIS of a whole hip bone: foremost and hindmost points of its iliac part, the patient
// lying on the back
motion::FrameLandmarks pelvis_landmarks(const fs::path& subject) {
  motion::FrameLandmarks landmarks;
  for (const auto& [word, side] : kSides) {
    const TriMesh bone = io::read_surface(subject / word / "hip_bone.ply");
    const TriMesh femur = io::read_surface(subject / word / "femur.ply");
    SurfaceSet alone;
    alone["femur"].mesh = femur;
    const Vec3 c = motion::find_joint_centre(alone, {.congruency_samples = 0}).chosen.centre;
    const Points above = rows_where(bone.points, [&](const Vec3& p) { return p.z() > c.z() + 45; });
    landmarks.points[std::string("asis_") + word] = farthest(above, -Vec3::UnitY(), 0.5);
    const Points behind =
        rows_where(bone.points, [&](const Vec3& p) { return p.z() > c.z() + 30; });
    landmarks.points[std::string("psis_") + word] = farthest(behind, Vec3::UnitY(), 0.5);
  }
  return landmarks;
}

// what a hip MRI shows: a box about the joint, mm
SurfaceSet cropped(const SurfaceSet& hip, const Vec3& c, double up, double down, double around) {
  SurfaceSet seen;
  for (const auto& [name, surface] : hip) {
    seen[name].mesh = part(surface.mesh, [&](const Vec3& p) {
      const Vec3 d = p - c;
      return d.z() < up && d.z() > -down && std::abs(d.x()) < around && std::abs(d.y()) < around;
    });
  }
  return seen;
}

// turn of `found` against `truth` about the true axes, degrees: x, y, z
Vec3 turn(const Mat3& truth, const Mat3& found) {
  return degrees(1.0) * rotation_vector(truth.transpose() * found);
}

// degrees by which the line of the upper shaft passes in front of the knee: means of two sides
constexpr double kBowOfVhf = 8.8, kBowOfVhm = 6.8;

}  // namespace

void print_frames(const fs::path& shared, const fs::path& atlas_file) {
  const shape::Atlas atlas = io::read_atlas(atlas_file);
  for (const std::string& name : atlas.subjects) {
    require(name.find("vhf") == std::string::npos && name.find("vhm") == std::string::npos,
            atlas_file.string(), " was made from ", name, " too");
  }
  std::printf(
      "| bone | in view | x anterior | y superior | z right | interval | against the same rule on "
      "the whole bone | source |\n"
      "|---|---|---|---|---|---|---|---|\n");
  struct View {
    const char* name;
    double up, down, around;
  };
  constexpr View kViews[] = {{"80 mm about the joint", 80, 80, 80},
                             {"100 mm up, 130 down, 100 around", 100, 130, 100},
                             {"80 mm up, 200 down, 90 around", 80, 200, 90}};
  for (const char* subject : {"vhf", "vhm"}) {
    const fs::path folder = shared / "data/visible_human" / subject;
    const motion::FrameLandmarks pelvis = pelvis_landmarks(folder);
    for (const auto& [word, side] : kSides) {
      SurfaceSet hip;
      for (const char* bone : {"femur", "hip_bone"})
        hip[bone].mesh = io::read_surface(folder / word / (std::string(bone) + ".ply"));
      SurfaceSet femur;
      femur["femur"] = hip["femur"];
      const Vec3 c = motion::find_joint_centre(femur, {.congruency_samples = 0}).chosen.centre;
      motion::FrameLandmarks all = pelvis;
      const motion::BoneFrames truth = motion::make_bone_frames(hip, all, c, side);
      const motion::BoneFrames uncut = pipeline::make_completed_frames(hip, {}, atlas, c, side);
      for (const View& view : kViews) {
        // the bow of the other person's femora, with all of the shaft in view
        const motion::BoneFrameOptions options{
            .mean_bow = radians(std::string(subject) == "vhf" ? kBowOfVhm : kBowOfVhf)};
        const auto found = pipeline::make_completed_frames(
            cropped(hip, c, view.up, view.down, view.around), {}, atlas, c, side, options);
        for (const auto& [bone, a, b, w] :
             {std::tuple{"pelvis", &truth.pelvis, &found.pelvis, &uncut.pelvis},
              std::tuple{"femur", &truth.femur, &found.femur, &uncut.femur}}) {
          const Vec3 t = turn(a->X_IB.R, b->X_IB.R), u = turn(w->X_IB.R, b->X_IB.R);
          std::printf("| %s %s %s | %s | %.1f | %.1f | %.1f | %.1f | %.1f / %.1f / %.1f | %s |\n",
                      subject, word, bone, view.name, t.x(), t.y(), t.z(), degrees(b->interval),
                      u.x(), u.y(), u.z(), b->source.c_str());
        }
        for (const std::string& text : found.warnings)
          std::printf("    warning: %s\n", text.c_str());
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace coxa::verify
