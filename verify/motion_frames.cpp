// Joint centres and bone frames on real bones: the tables of docs/motion.md sections 8.3 and 8.4.
#include <coxa/core/error.h>
#include <coxa/core/rng.h>
#include <coxa/geom/fits.h>
#include <coxa/io/atlas_file.h>
#include <coxa/io/surfaces.h>
#include <coxa/mesh/topology.h>
#include <coxa/motion/joint_centre.h>
#include <coxa/pipeline/completed_bones.h>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace {

using namespace coxa;
namespace fs = std::filesystem;

constexpr std::pair<const char*, Side> kSides[] = {{"left", Side::left}, {"right", Side::right}};

TriMesh read_if_there(const fs::path& path) {
  return fs::exists(path) ? io::read_surface(path) : TriMesh{};
}

SurfaceSet read_hip(const fs::path& folder) {
  SurfaceSet surfaces;
  for (const char* name : {"femur", "hip_bone", "femoral_cartilage", "acetabular_cartilage"}) {
    const TriMesh mesh = read_if_there(folder / (std::string(name) + ".ply"));
    if (!mesh.empty()) surfaces[name].mesh = mesh;
  }
  return surfaces;
}

template <class Keep>
TriMesh part(const TriMesh& mesh, const Keep& keep) {
  std::vector<Index> kept;
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    const Vec3 p = mesh.points(mesh.triangles.row(t), Eigen::all).colwise().mean();
    if (keep(p)) kept.push_back(t);
  }
  return sub_mesh(mesh, kept).mesh;
}

TriMesh noisy(TriMesh mesh, double sd, Rng& rng) {
  for (Index v = 0; v < mesh.n_vertices(); ++v) mesh.points.row(v) += sd * rng.normal3();
  return mesh;
}

// ---- joint centres ----

Vec3 head_centre(const TriMesh& femur, const Vec3& start) {
  SurfaceSet alone;
  alone["femur"].mesh = femur;
  return motion::find_joint_centre(alone, {.start = start, .congruency_samples = 0}).chosen.centre;
}

// the head's centre when only the half on the side of `direction` is seen, with noise
double move_of_half(const TriMesh& femur, const motion::JointCentre& head, const Vec3& direction,
                    double noise, Rng& rng) {
  const double reach = 1.15 * head.radius;
  const TriMesh half = part(femur, [&](const Vec3& p) {
    const Vec3 d = p - head.centre;
    return d.norm() > reach || d.dot(direction) >= 0;
  });
  const Vec3 start = head.centre + 3.0 * rng.normal3();
  return (head_centre(noisy(half, noise, rng), start) - head.centre).norm();
}

// Table of the definitions' distances from the femoral head's sphere, and of how far that sphere's
// centre moves when noise of 0.5 mm is added to every vertex and half of the head is not seen.
void print_centres(const fs::path& shared) {
  constexpr double kNoise = 0.5;  // mm, of every coordinate of every vertex
  std::printf(
      "| hip | radius | femoral cartilage | acetabular cartilage | acetabulum | "
      "congruency | largest spread | whole head | upper half | anterior | posterior | "
      "medial | half off the neck |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  VecX sum = VecX::Zero(6), largest = VecX::Zero(6);
  int n = 0;
  for (const int number : {1, 2, 3, 4, 5, 6, 8, 10, 11}) {
    for (const auto& [word, side] : kSides) {
      const SurfaceSet surfaces =
          read_hip(shared / "data/libhip" / ("m" + std::to_string(number)) / word);
      if (!surfaces.contains("femur")) continue;
      const TriMesh& femur = surfaces.at("femur").mesh;
      const auto result = motion::find_joint_centre(surfaces);
      std::printf("| m%d %s | %.1f |", number, word, result.chosen.radius);
      for (std::size_t k = 1; k < result.all.size(); ++k)
        std::printf(" %.2f |", (result.all[k].centre - result.chosen.centre).norm());
      std::printf(" %.2f |", result.largest_spread);
      const Vec3 off_neck = result.chosen.centre - femur.points.colwise().mean().transpose();
      const Vec3 medial = side == Side::right ? Vec3(Vec3::UnitX()) : Vec3(-Vec3::UnitX());
      const Vec3 halves[] = {Vec3::Zero(),  Vec3::UnitZ(), -Vec3::UnitY(),
                             Vec3::UnitY(), medial,        off_neck};
      Rng rng(1);
      for (Index k = 0; k < 6; ++k) {
        const double move = move_of_half(femur, result.chosen, halves[k], kNoise, rng);
        sum[k] += move;
        largest[k] = std::max(largest[k], move);
        std::printf(" %.2f |", move);
      }
      ++n;
      std::printf("\n");
      std::fflush(stdout);
    }
  }
  std::printf("mean    ");
  for (Index k = 0; k < 6; ++k) std::printf(" %.2f |", sum[k] / n);
  std::printf("\nlargest ");
  for (Index k = 0; k < 6; ++k) std::printf(" %.2f |", largest[k]);
  std::printf("\n");
}

// ---- bone frames ----

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

// Epicondyles of a whole femur: the outermost points of its lower end across the line of the
// posterior condyles; where an epicondyle is flat, the middle of what lies within 3 mm.
motion::FrameLandmarks knee_landmarks(const TriMesh& femur, const Vec3& centre, Side side) {
  const double lowest = femur.points.col(2).minCoeff();
  const Points low = rows_where(femur.points, [&](const Vec3& p) { return p.z() < lowest + 60; });
  const Vec3 middle = low.colwise().mean();
  const Vec3 y = (centre - middle).normalized();
  Vec3 lateral = side == Side::right ? Vec3(-Vec3::UnitX()) : Vec3(Vec3::UnitX());
  for (int round = 0; round < 20; ++round) {
    lateral = (lateral - lateral.dot(y) * y).normalized();
    const Vec3 posterior = side == Side::right ? lateral.cross(y) : y.cross(lateral);
    const auto condyle = [&](double sign) {
      return farthest(
          rows_where(low, [&](const Vec3& p) { return sign * (p - middle).dot(lateral) > 8.0; }),
          posterior, 0.3);
    };
    lateral = condyle(1.0) - condyle(-1.0);
  }
  lateral = (lateral - lateral.dot(y) * y).normalized();
  motion::FrameLandmarks landmarks;
  landmarks.points["lateral_epicondyle"] = farthest(low, lateral, 3.0);
  landmarks.points["medial_epicondyle"] = farthest(low, -lateral, 3.0);
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

void print_frames(const fs::path& shared, const fs::path& atlas_file) {
  const shape::Atlas atlas = io::read_atlas(atlas_file);
  for (const std::string& name : atlas.subjects) {
    require(name.find("vhf") == std::string::npos && name.find("vhm") == std::string::npos,
            atlas_file.string(), " was made from ", name, " too");
  }
  std::printf(
      "| bone | in view | x anterior | y superior | z right | interval | source |\n"
      "|---|---|---|---|---|---|---|\n");
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
      for (const auto& [name, p] : knee_landmarks(hip["femur"].mesh, c, side).points)
        all.points[name] = p;
      const motion::BoneFrames truth = motion::make_bone_frames(hip, all, c, side);
      for (const View& view : kViews) {
        // the bow of the other person's femora, with all of the shaft in view
        const motion::BoneFrameOptions options{
            .mean_bow = radians(std::string(subject) == "vhf" ? kBowOfVhm : kBowOfVhf)};
        const auto found = pipeline::make_completed_frames(
            cropped(hip, c, view.up, view.down, view.around), {}, atlas, c, side, options);
        for (const auto& [bone, a, b] : {std::tuple{"pelvis", &truth.pelvis, &found.pelvis},
                                         std::tuple{"femur", &truth.femur, &found.femur}}) {
          const Vec3 t = turn(a->X_IB.R, b->X_IB.R);
          std::printf("| %s %s %s | %s | %.1f | %.1f | %.1f | %.1f | %s |\n", subject, word, bone,
                      view.name, t.x(), t.y(), t.z(), degrees(b->interval), b->source.c_str());
        }
        for (const std::string& text : found.warnings)
          std::printf("    warning: %s\n", text.c_str());
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Joint centres and bone frames on real bones"};
  app.require_subcommand(1);
  std::string shared = "../shared", atlas;
  app.add_option("--shared", shared, "folder with data/libhip, data/visible_human");
  auto* centres = app.add_subcommand("centres", "spread of the definitions, noise, half a head");
  auto* frames = app.add_subcommand("frames", "frames of cropped bones against whole ones");
  frames->add_option("--atlas", atlas, "made without vhf and vhm")->required();
  CLI11_PARSE(app, argc, argv);
  try {
    if (centres->parsed()) print_centres(shared);
    if (frames->parsed()) print_frames(shared, atlas);
  } catch (const coxa::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
