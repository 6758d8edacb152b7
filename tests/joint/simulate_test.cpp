#include <coxa/joint/simulate.h>

#include <coxa/core/error.h>
#include <coxa/core/parallel.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <string>

#include "joint/layers.h"
#include "joint/movements.h"

namespace coxa::joint {
namespace {

/// Small meshes, so that a run takes a fraction of a second.
test::BallInCup small_shape() {
  test::BallInCup shape;
  shape.cup_rings = 8;
  shape.head_rings = 11;
  shape.layers = 1;
  return shape;
}
const JointModel congruent = test::make_ball_in_cup(small_shape());
const motion::HipMotion at_rest = test::movement_to({}, 1);
const JointOptions quick = {.centre_shift = std::nullopt};

FrameResult only_frame(const JointModel& model, const LoadCase& load,
                       const JointOptions& options = quick) {
  return simulate(model, at_rest, load, options).frames.front();
}
bool mentions(const std::string& text, const std::string& word) {
  return text.find(word) != std::string::npos;
}

}  // namespace

TEST(Simulate, PressureOfACongruentBallInACupIsTheCosineOfTheClosedForm) {
  // Winkler bed, cap of half-angle th: p0 = 3 F / (2 pi R^2 (1 - cos^3 th))
  const FrameResult frame =
      only_frame(test::make_ball_in_cup(), passive_examination(congruent, 2000.0));
  ASSERT_EQ(frame.status, FrameStatus::converged) << frame.reason;
  const double p0 = 3.0 * 2000.0 / (2.0 * kPi * 625.0 * (1.0 - 0.125));
  EXPECT_NEAR(frame.contact.peak_pressure_p99, p0, 0.02 * p0);
  EXPECT_NEAR(frame.contact.peak_pressure_patch, p0, 0.02 * p0);
  EXPECT_NEAR(frame.contact.mean_pressure, 0.75 * p0, 0.02 * p0);
  EXPECT_NEAR(frame.contact.contact_area, kPi * 625.0, 0.01 * kPi * 625.0);
  EXPECT_GT(frame.contact.contact_share, 0.99);
  // the layers' bed: p0 = M d / (2 h), bulging at the rim and curvature aside
  EXPECT_NEAR(frame.translation.z(), p0 * 3.0 / 30.63, 0.1 * frame.translation.z());
}
TEST(Simulate, ForcesAndReactionsBalance) {
  const FrameResult frame = only_frame(congruent, passive_examination(congruent, 500.0));
  ASSERT_EQ(frame.status, FrameStatus::converged) << frame.reason;
  EXPECT_NEAR(frame.balance.applied_force.norm(), 500.0, 1e-9);
  EXPECT_LT(frame.balance.force_error, 1e-3);
  EXPECT_LT(frame.balance.reaction_error, 1e-3);
  EXPECT_LT(frame.contact.penetration, 0.01);
  EXPECT_LT((frame.balance.socket_reaction - frame.balance.applied_force).norm(), 0.5);
}
TEST(Simulate, NodalPressuresCarryTheForceOnBothSides) {
  const FrameResult frame = only_frame(congruent, passive_examination(congruent, 500.0));
  const auto force = [](const TetMesh& mesh, const Points& displacement, const VecX& pressure) {
    Vec3 sum = Vec3::Zero();
    const Triangles facets = facets_with(mesh, FacetTag::articular_side);
    const Points x = mesh.points + displacement;
    for (Index f = 0; f < facets.rows(); ++f) {
      const Vec3 a = x.row(facets(f, 0)), b = x.row(facets(f, 1)), c = x.row(facets(f, 2));
      const double mean =
          (pressure[facets(f, 0)] + pressure[facets(f, 1)] + pressure[facets(f, 2)]) / 3.0;
      sum -= mean * 0.5 * (b - a).cross(c - a);
    }
    return sum;
  };
  const Vec3 on_socket = force(congruent.acetabular_cartilage, frame.acetabular_displacement,
                               frame.acetabular_pressure);
  const Vec3 on_head =
      force(congruent.femoral_cartilage, frame.femoral_displacement, frame.femoral_pressure);
  EXPECT_NEAR(on_socket.z(), 500.0, 10.0);
  EXPECT_NEAR(on_head.z(), -500.0, 15.0);
}
TEST(Simulate, StartsFromAGapOrAnOverlapLikeFromTouching) {
  const FrameResult touching = only_frame(congruent, passive_examination(congruent, 500.0));
  for (const double offset : {-1.5, 0.6}) {
    test::BallInCup shape = small_shape();
    shape.head_offset = Vec3(0.2, -0.1, offset);
    const JointModel model = test::make_ball_in_cup(shape);
    const FrameResult frame = only_frame(model, passive_examination(model, 500.0));
    ASSERT_EQ(frame.status, FrameStatus::converged) << frame.reason;
    EXPECT_NEAR(frame.contact.peak_pressure_p99, touching.contact.peak_pressure_p99, 0.005);
    EXPECT_LT((frame.translation + shape.head_offset - touching.translation).norm(), 2e-3);
  }
}
TEST(Simulate, TurningABallChangesNothing) {
  const auto motion = test::movement_to({radians(12.0), 0.0, radians(4.0)}, 3);
  const JointResult result =
      simulate(congruent, motion, passive_examination(congruent, 500.0), quick);
  ASSERT_EQ(result.n_converged(), 3);
  const double peak = result.frames[0].contact.peak_pressure_p99;
  for (const FrameResult& frame : result.frames) {
    // facets of 3 mm that slide over each other: their patches differ from the sphere by a few
    // micrometres
    EXPECT_NEAR(frame.contact.peak_pressure_p99, peak, 0.12 * peak);
    EXPECT_NEAR(frame.contact.mean_pressure, result.frames[0].contact.mean_pressure, 0.02 * peak);
    EXPECT_LT(frame.balance.force_error, 1e-3);
  }
  EXPECT_NEAR(result.frames[2].angles.flexion, radians(12.0), 1e-12);
  const Mat3 turn = result.frames[2].X_II.R;
  EXPECT_NEAR(std::acos(0.5 * (turn.trace() - 1.0)), radians(12.6), radians(0.2));
}
TEST(Simulate, WorkOfTheFemurIsTheStoredEnergy) {
  // pressed in by a prescribed way in small steps: the trapezium rule is exact to second order
  auto motion = test::movement_to({}, 9);
  for (Index k = 0; k < 9; ++k) {
    motion.X_PF[static_cast<std::size_t>(k)].p = Vec3(0, 0.02 * k, 0);  // superior
  }
  JointOptions options = quick;
  options.penetration_tolerance = 1e-3;
  const JointResult result = simulate(congruent, motion, prescribed_pose(), options);
  ASSERT_EQ(result.n_converged(), 9) << result.frames[8].reason;
  const BalanceFigures& last = result.frames[8].balance;
  EXPECT_GT(last.elastic_energy, 1.0);
  EXPECT_NEAR(last.work, last.elastic_energy, 0.03 * last.elastic_energy);
}
TEST(Simulate, PrescribedPosePressesByConfinedModulusOverThickness) {
  auto motion = test::movement_to({}, 2);
  motion.X_PF[1].p = Vec3(0, 0.1, 0);
  const JointResult result = simulate(test::make_ball_in_cup(), motion, prescribed_pose(), quick);
  ASSERT_EQ(result.frames[1].status, FrameStatus::converged) << result.frames[1].reason;
  const double p0 = 30.63 * 0.1 / 3.0;  // the cap is 60 degrees: bulging takes some of it
  EXPECT_NEAR(result.frames[1].contact.peak_pressure_p99, p0, 0.12 * p0);
  EXPECT_NEAR(result.frames[1].translation.z(), 0.1, 1e-12);
  EXPECT_LT(result.frames[0].contact.peak_pressure_p99, 0.15 * p0);
}
TEST(Simulate, LoadFollowsTheFrames) {
  LoadCase load = passive_examination(congruent, 200.0);
  load.force_P = load.force_P.replicate(2, 1).eval();
  load.force_P.row(1) *= 2.0;
  const JointResult result = simulate(congruent, test::movement_to({}, 2), load, quick);
  EXPECT_NEAR(result.frames[0].balance.contact_force.norm(), 200.0, 0.5);
  EXPECT_NEAR(result.frames[1].balance.contact_force.norm(), 400.0, 1.0);
}
TEST(Simulate, ForceOutOfTheSocketFailsWithTheReason) {
  LoadCase load = passive_examination(congruent, 500.0);
  load.force_P *= -1.0;
  const JointResult result = simulate(congruent, test::movement_to({}, 2), load, quick);
  EXPECT_EQ(result.n_converged(), 0);
  for (const FrameResult& frame : result.frames) {
    EXPECT_EQ(frame.status, FrameStatus::failed);
    EXPECT_TRUE(mentions(frame.reason, "head leaves the socket") ||
                mentions(frame.reason, "nothing to press"))
        << frame.reason;
    EXPECT_EQ(frame.acetabular_pressure.size(), 0);
  }
}
TEST(Simulate, ForceAcrossTheSocketThatItCannotBearFails) {
  LoadCase load;
  load.force_P = Vec3(500.0, -50.0, 0.0).transpose();  // anterior, and a little out of the cup
  const FrameResult frame = only_frame(congruent, load);
  EXPECT_EQ(frame.status, FrameStatus::failed);
  EXPECT_FALSE(frame.reason.empty());
}
TEST(Simulate, IsBitIdenticalForOneAndEightThreads) {
  const auto run = [&] {
    const auto motion = test::movement_to({radians(2.0), 0.0, 0.0}, 2);
    return simulate(congruent, motion, passive_examination(congruent), quick)
        .frames[1]
        .acetabular_displacement;
  };
  const Points one = with_threads(1, run), eight = with_threads(8, run);
  ASSERT_GT(one.rows(), 0);
  EXPECT_EQ(one, eight);
}
TEST(Simulate, BothLawsAgreeAtSmallStrain) {
  JointModel model = congruent;
  model.material.law = MaterialLaw::st_venant_kirchhoff;
  const double corotational =
      only_frame(congruent, passive_examination(congruent, 50.0)).contact.peak_pressure_p99;
  const double unrotated =
      only_frame(model, passive_examination(model, 50.0)).contact.peak_pressure_p99;
  EXPECT_NEAR(unrotated, corotational, 0.02 * corotational);
}
TEST(Simulate, SofterCartilageIsPressedDeeper) {
  JointModel soft = congruent;
  soft.material.youngs_modulus = 6.0;
  const double stiff_way = only_frame(congruent, passive_examination(congruent)).translation.z();
  EXPECT_NEAR(only_frame(soft, passive_examination(soft)).translation.z(), 2.0 * stiff_way,
              0.2 * stiff_way);
}
TEST(Simulate, SectorsMirrorTheSymmetryOfTheCup) {
  const FrameResult frame = only_frame(congruent, passive_examination(congruent, 500.0));
  double total = 0.0;
  for (const SectorFigures& sector : frame.sectors) {
    EXPECT_NEAR(sector.mean_pressure, frame.sectors[0].mean_pressure,
                0.05 * frame.sectors[0].mean_pressure);
    EXPECT_NEAR(sector.strain, frame.sectors[0].strain, 0.1 * frame.sectors[0].strain);
    EXPECT_LT(sector.compression, 0.0);
    total += sector.volume;
  }
  // volume of the shell over the cap: 2 pi (1 - cos 60) (26.5^3 - 25^3) / 3
  EXPECT_NEAR(total, kPi / 3.0 * (std::pow(26.5, 3) - std::pow(25.0, 3)), 0.02 * total);
  double regions = 0.0;
  for (const SectorFigures& region : frame.regions) regions += region.volume;
  EXPECT_NEAR(regions, total, 1e-9 * total);
}
TEST(Simulate, SensitivityTellsWhatAShiftOfTheHeadIsWorth) {
  const JointResult result =
      simulate(congruent, at_rest, passive_examination(congruent, 500.0), {.centre_shift = 0.02});
  ASSERT_TRUE(result.sensitivity.has_value());
  const auto& peak = result.sensitivity->peak;
  // superior is into the cup; anterior and right are alike by symmetry
  EXPECT_GT(peak(1, 1), result.sensitivity->at_rest + 0.05);
  EXPECT_LT(peak(1, 0), result.sensitivity->at_rest - 0.05);
  EXPECT_NEAR(peak(0, 0), peak(0, 1), 0.03);
  EXPECT_NEAR(peak(0, 0), peak(2, 0), 0.03);
  EXPECT_NEAR(result.sensitivity->at_rest, result.frames[0].contact.peak_pressure_p99, 1e-12);
}
TEST(Simulate, StopsWhenCancelled) {
  const std::atomic<bool> cancel{true};
  Monitor monitor;
  monitor.cancel_flag = &cancel;
  EXPECT_THROW(simulate(congruent, at_rest, passive_examination(congruent), quick, monitor), Error);
}

TEST(CartilageLaws, AgreeWhileStrainsAreSmall) {
  JointModel model = congruent;
  const LoadCase load = passive_examination(model, 500.0);  // strains of 1.5 %
  const FrameResult known = only_frame(model, load);
  for (const MaterialLaw law : {MaterialLaw::st_venant_kirchhoff, MaterialLaw::neo_hookean}) {
    model.material.law = law;
    const FrameResult frame = only_frame(model, load);
    ASSERT_EQ(frame.status, FrameStatus::converged) << frame.reason;
    EXPECT_NEAR(frame.contact.mean_pressure, known.contact.mean_pressure,
                0.05 * known.contact.mean_pressure);
    // patches of elements are softer than elements, and the laws part by a few percent
    EXPECT_NEAR(frame.translation.z(), known.translation.z(), 0.15 * known.translation.z());
  }
}
TEST(CartilageLaws, NeoHookeanMayBeNearlyIncompressible) {
  JointModel model = congruent;
  model.material = {MaterialLaw::neo_hookean, 40.67, 0.495};
  const FrameResult frame = only_frame(model, passive_examination(model, 1000.0));
  ASSERT_EQ(frame.status, FrameStatus::converged) << frame.reason;
  EXPECT_LT(frame.balance.force_error, 1e-3);
  // about the pole all three principal stresses are near the pressure, the patches' part included
  const TetMesh& mesh = model.acetabular_cartilage;
  const auto near_axis = [](const Vec3& p) { return p.head<2>().norm() < 8.0; };
  const StressFields socket = acetabular_fields(model, frame);
  double stress = 0.0, pressure = 0.0;
  int elements = 0, nodes = 0;
  for (Index t = 0; t < mesh.n_tets(); ++t) {
    const Vec3 middle = mesh.points(mesh.tets.row(t), Eigen::all).colwise().mean();
    if (!near_axis(middle)) continue;
    stress -= socket.principal_stress.row(t).mean();
    ++elements;
  }
  for (Index i = 0; i < mesh.n_vertices(); ++i) {
    if (!(frame.acetabular_pressure[i] > 0.0) || !near_axis(mesh.points.row(i))) continue;
    pressure += frame.acetabular_pressure[i];
    ++nodes;
  }
  EXPECT_NEAR(stress / elements, pressure / nodes, 0.15 * pressure / nodes);
}

TEST(StressFields, OfAPressedCupAreCompressiveAlongItsAxis) {
  const FrameResult frame = only_frame(congruent, passive_examination(congruent, 500.0));
  const StressFields socket = acetabular_fields(congruent, frame),
                     head = femoral_fields(congruent, frame);
  for (const auto& [fields, mesh] : {std::pair{&socket, &congruent.acetabular_cartilage},
                                     std::pair{&head, &congruent.femoral_cartilage}}) {
    Index pole = 0;  // the element nearest the cup's axis
    double nearest = kInfinity;
    for (Index t = 0; t < mesh->n_tets(); ++t) {
      const Vec3 middle = mesh->points(mesh->tets.row(t), Eigen::all).colwise().mean();
      if (middle.head<2>().norm() < nearest) pole = t;
      nearest = std::min(nearest, middle.head<2>().norm());
    }
    const double p0 = 3.0 * 500.0 / (2.0 * kPi * 625.0 * (1.0 - 0.125));
    EXPECT_NEAR(-fields->cauchy_stress(pole, 2), p0, 0.15 * p0);
    EXPECT_NEAR(fields->principal_stress(pole, 2), fields->cauchy_stress(pole, 2), 0.01);
    EXPECT_LT(fields->green_strain(pole, 2), 0.0);
    EXPECT_GT(fields->von_mises[pole], 0.0);
  }
  EXPECT_THROW(acetabular_fields(congruent, FrameResult{}), Error);
}

}  // namespace coxa::joint
