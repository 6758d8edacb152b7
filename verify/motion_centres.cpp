// Joint centres on the femora of libhip: the tables of docs/motion.md section 8.3.
#include <coxa/core/error.h>
#include <coxa/core/rng.h>
#include <coxa/io/head_shape_file.h>
#include <coxa/motion/joint_centre.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "motion_cases.h"

namespace coxa::verify {

namespace fs = std::filesystem;

namespace {

struct Hip {
  int person = 0;
  std::string name;
  Side side = Side::right;
  SurfaceSet surfaces;
  motion::JointCentreResult centres;
};

std::vector<Hip> read_hips(const fs::path& shared) {
  std::vector<Hip> hips;
  for (const int person : {1, 2, 3, 4, 5, 6, 8, 10, 11}) {
    for (const auto& [word, side] : kSides) {
      const std::string name = "m" + std::to_string(person);
      Hip hip{person, name + " " + word, side, read_hip(shared / "data/libhip" / name / word), {}};
      if (hip.surfaces.contains("femur")) hips.push_back(std::move(hip));
    }
  }
  return hips;
}

// heads of everybody but one person (0: of everybody)
motion::HeadShape heads_without(const std::vector<Hip>& hips, int person) {
  std::vector<motion::HeadExample> examples;
  for (const Hip& hip : hips) {
    if (hip.person != person) examples.push_back({hip.surfaces.at("femur").mesh, hip.side});
  }
  return motion::learn_head_shape(examples);
}

TriMesh noisy(TriMesh mesh, double sd, Rng& rng) {
  for (Index v = 0; v < mesh.n_vertices(); ++v) mesh.points.row(v) += sd * rng.normal3();
  return mesh;
}

motion::JointCentre head_of(const TriMesh& femur, const Vec3& start,
                            const std::optional<motion::HeadPrior>& prior) {
  SurfaceSet alone;
  alone["femur"].mesh = femur;
  return motion::find_joint_centre(alone,
                                   {.start = start, .congruency_samples = 0, .head_prior = prior})
      .chosen;
}

// the head when only the half on the side of `direction` is seen, with noise
struct HalfHead {
  TriMesh femur;
  Vec3 start;
};
HalfHead half_head(const TriMesh& femur, const motion::JointCentre& head, const Vec3& direction,
                   Rng& rng) {
  constexpr double kNoise = 0.5;  // mm, of every coordinate of every vertex
  const double reach = 1.15 * head.radius;
  const TriMesh half = part(femur, [&](const Vec3& p) {
    const Vec3 d = p - head.centre;
    return d.norm() > reach || d.dot(direction) >= 0;
  });
  const Vec3 start = head.centre + 3.0 * rng.normal3();
  return {noisy(half, kNoise, rng), start};
}

void print_definitions(std::vector<Hip>& hips) {
  std::printf(
      "| hip | radius | femoral cartilage | acetabular cartilage | acetabulum | congruency | "
      "largest spread |\n|---|---|---|---|---|---|---|\n");
  for (Hip& hip : hips) {
    hip.centres = motion::find_joint_centre(hip.surfaces);
    const auto& centres = hip.centres;
    std::printf("| %s | %.1f |", hip.name.c_str(), centres.chosen.radius);
    for (std::size_t k = 1; k < centres.all.size(); ++k)
      std::printf(" %.2f |", (centres.all[k].centre - centres.chosen.centre).norm());
    std::printf(" %.2f |\n", centres.largest_spread);
    std::fflush(stdout);
  }
}

constexpr const char* kViewNames[] = {"whole",     "upper",  "anterior",
                                      "posterior", "medial", "off the neck"};
constexpr Index kViews = 6;

struct Moves {
  Eigen::Array<double, kViews, 1> plain, completed, inside;  // mm; 1 where the interval holds it
};

// how far the head's centre moves in each view, without and with the shape of other people's heads
Moves moves_of(const Hip& hip, const motion::HeadShape& others) {
  const TriMesh& femur = hip.surfaces.at("femur").mesh;
  const motion::JointCentre& head = hip.centres.chosen;
  const Vec3 off_neck = head.centre - femur.points.colwise().mean().transpose();
  const Vec3 medial = hip.side == Side::right ? Vec3(Vec3::UnitX()) : Vec3(-Vec3::UnitX());
  const Vec3 views[] = {Vec3::Zero(),  Vec3::UnitZ(), -Vec3::UnitY(),
                        Vec3::UnitY(), medial,        off_neck};
  Rng rng(1);
  Moves moves;
  for (Index k = 0; k < kViews; ++k) {
    const HalfHead half = half_head(femur, head, views[k], rng);
    const motion::HeadPrior prior{others, hip.side};
    const auto found = head_of(half.femur, half.start, prior);
    moves.plain[k] = (head_of(half.femur, half.start, {}).centre - head.centre).norm();
    moves.completed[k] = (found.centre - head.centre).norm();
    moves.inside[k] =
        ((found.centre - head.centre).cwiseAbs().array() <= found.interval).cast<double>().mean();
  }
  return moves;
}

void print_row(const char* name, const Eigen::Array<double, kViews, 1>& values) {
  std::printf("| %s |", name);
  for (Index k = 0; k < kViews; ++k) std::printf(" %.2f |", values[k]);
  std::printf("\n");
}

// rows of all hips, each with the heads of `others` that are not the same person's
void print_moves(const std::vector<Hip>& hips, const std::vector<Hip>& others) {
  std::printf("| hip |");
  for (const char* name : kViewNames) std::printf(" %s |", name);
  std::printf("\n|---|---|---|---|---|---|---|\n");
  const Moves zero{Eigen::Array<double, kViews, 1>::Zero(), Eigen::Array<double, kViews, 1>::Zero(),
                   Eigen::Array<double, kViews, 1>::Zero()};
  Moves sum = zero, largest = zero;
  for (const Hip& hip : hips) {
    const Moves moves = moves_of(hip, heads_without(others, hip.person));
    std::printf("| %s |", hip.name.c_str());
    for (Index k = 0; k < kViews; ++k)
      std::printf(" %.2f / %.2f |", moves.plain[k], moves.completed[k]);
    std::printf("\n");
    std::fflush(stdout);
    sum.plain += moves.plain;
    sum.completed += moves.completed;
    sum.inside += moves.inside;
    largest.plain = largest.plain.max(moves.plain);
    largest.completed = largest.completed.max(moves.completed);
  }
  const auto n = static_cast<double>(hips.size());
  print_row("mean, sphere", sum.plain / n);
  print_row("mean, completed", sum.completed / n);
  print_row("largest, sphere", largest.plain);
  print_row("largest, completed", largest.completed);
  print_row("share of coordinates inside the interval", sum.inside / n);
}

// heads of other people, from another source: no part of what heads are learned from
std::vector<Hip> read_visible_human(const fs::path& shared) {
  std::vector<Hip> hips;
  for (const char* body : {"vhf", "vhm"}) {
    for (const auto& [word, side] : kSides) {
      Hip hip{-1, std::string(body) + " " + word, side, {}, {}};
      hip.surfaces["femur"] = read_hip(shared / "data/visible_human" / body / word).at("femur");
      hip.centres = motion::find_joint_centre(hip.surfaces, {.congruency_samples = 0});
      hips.push_back(std::move(hip));
    }
  }
  return hips;
}

}  // namespace

void print_centres(const fs::path& shared) {
  std::vector<Hip> hips = read_hips(shared);
  print_definitions(hips);
  std::printf("\ncentre of the head moves by, mm, with 0.5 mm of noise: sphere / completed\n");
  print_moves(hips, hips);
  std::printf("\nthe same, other bodies\n");
  print_moves(read_visible_human(shared), hips);
}

void learn_heads(const fs::path& shared, const fs::path& out) {
  const std::vector<Hip> hips = read_hips(shared);
  motion::HeadShape shape = heads_without(hips, 0);
  shape.source = join_text(hips.size(),
                           " heads of 9 men of LibHip (MIT licence, Copyright (c) DIKU; "
                           "Moshfeghifar et al. 2022, doi 10.1016/j.cmpb.2022.107140)");
  io::write_head_shape(out, shape);
  std::printf("%s: degree %d, %s\n", out.c_str(), shape.degree, shape.source.c_str());
}

}  // namespace coxa::verify
