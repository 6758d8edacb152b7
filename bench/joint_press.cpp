// Presses the head of a hip into its socket by a prescribed way and prints what comes of it: the
// case that tools/calculix_hip.py runs in CalculiX. Usage: joint_press JOINT.toml --way MM
// --along X Y Z (image axes) [--flexion DEG] [--rotation DEG] [--withdraw MM] [--no-penetration]
// [--decks DIR] [--ten-node]. The head is turned by flexion and internal rotation from the image
// pose and moved back by `withdraw` first, without strain: the way starts there.
#include <coxa/core/error.h>
#include <coxa/io/tets.h>
#include <coxa/joint/simulate.h>
#include <coxa/mesh/vertex_normals.h>
#include <coxa/pipeline/joint_stage.h>
#include <coxa/pipeline/motion_stage.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>
#include <string>
#include <utility>

#include "fem/shapes.h"

namespace {

using namespace coxa;

struct Arguments {
  double way = 0.7;  // mm
  Vec3 along = Vec3::Zero();
  motion::HipAngles turn;  // rad
  double withdraw = 0.0;   // mm, against `along`
  bool penalty_only = true;
  std::filesystem::path decks;  // empty: none
  bool ten_node = false;        // of the decks
};

Arguments read(int argc, char** argv) {
  require(argc > 2, "usage: joint_press JOINT.toml --way MM --along X Y Z");
  Arguments arguments;
  for (int k = 2; k < argc; ++k) {
    const std::string word = argv[k];
    const auto value = [&] { return k + 1 < argc ? std::string(argv[++k]) : std::string("0"); };
    if (word == "--way") arguments.way = std::stod(value());
    if (word == "--along")
      for (double& component : arguments.along) component = std::stod(value());
    if (word == "--flexion") arguments.turn.flexion = radians(std::stod(value()));
    if (word == "--rotation") arguments.turn.internal_rotation = radians(std::stod(value()));
    if (word == "--withdraw") arguments.withdraw = std::stod(value());
    if (word == "--no-penetration") arguments.penalty_only = false;
    if (word == "--decks") arguments.decks = value();
    if (word == "--ten-node") arguments.ten_node = true;
  }
  require(arguments.along.norm() > 0.0, "--along X Y Z is needed");
  arguments.along.normalize();
  return arguments;
}

/// Ten-node mesh whose articular mid nodes lie on the curved surface that the joint's contact takes
/// the facets for: a quarter of half the sum of the distances of an edge's ends from each other's
/// tangent plane (docs/collide.md).
TetMesh curved_ten_node(const TetMesh& mesh) {
  TetMesh ten = fem::test::with_mid_nodes(mesh);
  const TriMesh surface{mesh.points, joint::facets_with(mesh, FacetTag::articular_side)};
  const Points normals = vertex_normals(surface);
  std::set<std::pair<Index, Index>> edges;
  for (Index f = 0; f < surface.n_triangles(); ++f)
    for (int k = 0; k < 3; ++k)
      edges.insert(std::minmax(surface.triangles(f, k), surface.triangles(f, (k + 1) % 3)));
  constexpr int kEnds[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  std::set<Index> done;
  for (Index e = 0; e < ten.n_tets(); ++e)
    for (int k = 0; k < 6; ++k) {
      const auto [a, b] = std::minmax(ten.tets(e, kEnds[k][0]), ten.tets(e, kEnds[k][1]));
      const Index middle = ten.mid_nodes(e, k);
      if (edges.count({a, b}) == 0 || !done.insert(middle).second) continue;
      const Eigen::RowVector3d edge = mesh.points.row(b) - mesh.points.row(a);
      const double bulge = 0.5 * (edge.dot(normals.row(b)) - edge.dot(normals.row(a)));
      ten.points.row(middle) += 0.25 * bulge * (normals.row(a) + normals.row(b)).normalized();
    }
  return ten;
}

/// Where the head starts from, as its rest: turned in pelvis axes from the image pose.
void update_start(joint::JointModel& model, const Arguments& arguments) {
  const Mat3 R_PF = motion::rotation_from_angles(arguments.turn, model.side);
  const Mat3 turn = model.X_IP.R * R_PF * model.X_IP.R.transpose();
  const Vec3 centre = model.X_IF.p;
  const RigidTransform X{turn, centre - turn * centre - arguments.withdraw * arguments.along};
  model.femoral_cartilage.points = transformed(model.femoral_cartilage.points, X);
  model.X_IF = X * model.X_IF;
}

void write_decks(const joint::JointModel& model, const Arguments& arguments) {
  const auto write = [&](const TetMesh& mesh, const char* name) {
    io::write_tets(arguments.decks / name, arguments.ten_node ? curved_ten_node(mesh) : mesh);
  };
  write(model.acetabular_cartilage, "acetabular.inp");
  write(model.femoral_cartilage, "femoral.inp");
}

void press(const joint::JointModel& model, const Arguments& arguments) {
  motion::HipMotion motion;
  motion.time.push_back(0.0);
  motion.angles.push_back({});
  const RigidTransform shift{Mat3::Identity(), arguments.way * arguments.along};
  motion.X_PF.push_back(model.X_IP.inverse() * (shift * model.X_IF));
  joint::JointOptions options{.centre_shift = std::nullopt};
  if (arguments.penalty_only) options.penetration_tolerance = 1e3;
  const joint::JointResult result =
      joint::simulate(model, motion, joint::prescribed_pose(), options);
  const joint::FrameResult& frame = result.frames.front();
  if (frame.status != joint::FrameStatus::converged) fail(ErrorCode::no_convergence, frame.reason);
  const joint::ContactFigures& c = frame.contact;
  const Vec3 F = frame.balance.socket_reaction;
  std::printf(
      "tets %d + %d, way %.2f mm: force %.1f N (%.1f %.1f %.1f), area %.1f mm2, p95 %.3f, p99 "
      "%.3f MPa, centre of pressure %.2f %.2f %.2f, penetration %.3f mm, %d Newton steps, %.2f s\n",
      static_cast<int>(model.acetabular_cartilage.n_tets()),
      static_cast<int>(model.femoral_cartilage.n_tets()), arguments.way, F.norm(), F[0], F[1], F[2],
      c.contact_area, c.peak_pressure_p95, c.peak_pressure_p99, c.centre_of_pressure[0],
      c.centre_of_pressure[1], c.centre_of_pressure[2], c.deepest_sample, frame.iterations,
      result.seconds);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const Arguments arguments = read(argc, argv);
    const auto request = pipeline::read_joint_request(argv[1]);
    joint::JointModel model = pipeline::read_joint_model(
        request, pipeline::read_motion_artefacts(request.motion, request.side).frames);
    model.hip_bone = model.femur = {};
    update_start(model, arguments);
    if (!arguments.decks.empty()) write_decks(model, arguments);
    press(model, arguments);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
