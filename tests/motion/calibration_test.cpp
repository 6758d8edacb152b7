#include <coxa/motion/calibration.h>

#include <coxa/core/error.h>
#include <coxa/motion/estimated_centre.h>
#include <coxa/motion/track_setup.h>
#include <gtest/gtest.h>

#include "motion/synthetic_hip.h"

namespace coxa::motion {
namespace {

// a hip standing neutral in frame 0, with knee markers, whose labels are those of the conventional
// gait model
test::SyntheticHip standing_hip(Side side) {
  auto hip = test::make_hip(120, 0.0, side);
  const double s = side == Side::right ? 1.0 : -1.0;
  const std::string letter = side == Side::right ? "R" : "L";
  for (const auto& [label, p] : {std::pair{letter + "KNE", Vec3(0, 0, s * 55)},
                                 std::pair{letter + "KNM", Vec3(0, 0, -s * 55)}}) {
    Points trajectory(120, 3);
    const auto X_LP = track_in_detail(hip.markers, hip.model, {.method = PoseMethod::rigid}).X_LP;
    for (Index f = 0; f < 120; ++f) {
      const auto k = static_cast<std::size_t>(f);
      const Mat3 R = rotation_from_angles(hip.angles[k], side);
      trajectory.row(f) = X_LP[k] * (hip.model.joint_centre_pelvis + R * (p - Vec3(0, 400, 0)));
    }
    hip.markers.labels.push_back(label);
    hip.markers.trajectories.push_back(trajectory);
  }
  return hip;
}

}  // namespace

TEST(Calibration, FindsTheModelOfAStandingHip) {
  for (const Side side : {Side::left, Side::right}) {
    const auto hip = standing_hip(side);
    CalibrationOptions options{.side = side, .map = default_marker_map(side), .end_frame = 1};
    options.map[MarkerRole::thigh] = {"T#"};
    options.joint_centre_pelvis = hip.model.joint_centre_pelvis - Vec3(40, 0, 0);  // from mid-ASIS
    // the pelvis frame of the test has its PSIS 10 mm above: use the same plane
    const Calibration calibration = calibrate(hip.markers, options);
    EXPECT_EQ(calibration.model.thigh_markers.size(), 10u);
    const auto tilt = std::atan2(10.0, 160.0);
    TrackSetup setup{.side = side, .calibration = options};
    const auto outcome = track_recording(hip.markers, nullptr, setup);
    // movement between frames is exact whatever the neutral pose's small offsets are
    for (std::size_t f = 0; f < hip.angles.size(); f += 7) {
      const double expected = hip.angles[f].flexion - hip.angles[0].flexion;
      EXPECT_NEAR(outcome.result.motion.angles[f].flexion - outcome.result.motion.angles[0].flexion,
                  expected, 0.06 + tilt);
    }
  }
}
TEST(Calibration, OffersEveryEstimateOfTheCentre) {
  const auto hip = standing_hip(Side::right);
  CalibrationOptions options{.map = default_marker_map(Side::right)};
  options.map[MarkerRole::thigh] = {"T#"};
  const auto calibration = calibrate(hip.markers, options);
  std::vector<std::string> names;
  for (const auto& centre : calibration.centres) names.push_back(centre.definition);
  EXPECT_EQ(names, (std::vector<std::string>{"harrington", "bell", "score", "functional_sphere"}));
  // functional centres are exact without artefact, from either method
  EXPECT_LE((calibration.centres[2].centre - calibration.centres[3].centre).norm(), 1e-3);
  options.centre = CentreSource::score;
  EXPECT_LE(
      (calibrate(hip.markers, options).model.joint_centre_pelvis - calibration.centres[2].centre)
          .norm(),
      1e-12);
}
TEST(Calibration, PinsTheHeadWhereTheSurfacesHaveIt) {
  const auto hip = standing_hip(Side::right);
  CalibrationOptions options{.map = default_marker_map(Side::right)};
  options.map[MarkerRole::thigh] = {"T#"};
  // the image: the pelvis somewhere else, the joint centre known
  const RigidTransform X_IP{rotation_from_vector(Vec3(0.3, -0.2, 0.9)), Vec3(12, -40, 300)};
  ImagedPelvis image{.joint_centre = X_IP * hip.model.joint_centre_pelvis};
  for (const auto& [name, label] : {std::pair{"asis_left", "LASI"},
                                    {"asis_right", "RASI"},
                                    {"psis_left", "LPSI"},
                                    {"psis_right", "RPSI"}})
    image.landmarks[name] = X_IP * hip.model.pelvis_markers.at(label);
  options.image = image;
  const auto calibration = calibrate(hip.markers, options);
  ASSERT_EQ(calibration.centres.front().definition, "surfaces");
  EXPECT_NE(calibration.model.source.find("surfaces"), std::string::npos);
  // functional centres are exact here
  const Vec3 truth = calibration.centres[3].centre;
  EXPECT_LE((calibration.centres.front().centre - truth).norm(), 1e-3);
  EXPECT_LE((calibration.model.joint_centre_pelvis - truth).norm(), 1e-3);
  // a centre that is asked for wins
  options.centre = CentreSource::bell;
  EXPECT_NE(calibrate(hip.markers, options).model.source.find("bell"), std::string::npos);
}
TEST(Calibration, IntervalOfARegisteredCentreHoldsItsError) {
  const std::map<std::string, Vec3> markers = {{"asis_left", Vec3(0, 0, -115)},
                                               {"asis_right", Vec3(0, 0, 115)},
                                               {"psis_left", Vec3(-150, 0, -45)},
                                               {"psis_right", Vec3(-150, 0, 45)}};
  const Vec3 centre(-45, -85, 88);
  Rng rng(11);
  double inside = 0.0;
  constexpr int kDraws = 400;
  for (int k = 0; k < kDraws; ++k) {
    ImagedPelvis image{.landmarks = markers, .joint_centre = centre, .joint_centre_sd = 0.5};
    for (auto& [name, p] : image.landmarks) p += 3.6 * rng.normal3();  // bone 2, skin 3 mm
    const JointCentre found = registered_centre(image, markers, 3.0);
    inside += ((found.centre - centre).cwiseAbs().array() <= found.interval).cast<double>().mean();
  }
  // made for the axis that is off most
  EXPECT_GE(inside / kDraws, 0.95);
  EXPECT_LE(inside / kDraws, 0.995);
  EXPECT_THROW(registered_centre({.landmarks = {{"asis_left", centre}}}, markers, 3.0), Error);
}
TEST(Calibration, NamesTheRoleThatNoLabelFills) {
  auto hip = standing_hip(Side::right);
  hip.markers.labels[static_cast<std::size_t>(*find_marker(hip.markers, "RASI"))] = "something";
  try {
    calibrate(hip.markers, {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("no marker for the role 'asis_right'"),
              std::string::npos);
    EXPECT_NE(std::string(error.what()).find("something"), std::string::npos);
  }
}
TEST(Calibration, WarnsWhereTheMedialKneeMarkerIsMissing) {
  auto hip = standing_hip(Side::right);
  hip.markers.labels.back() = "other";
  CalibrationOptions options{.map = default_marker_map(Side::right)};
  options.map[MarkerRole::thigh] = {"T#"};
  const auto calibration = calibrate(hip.markers, options);
  ASSERT_FALSE(calibration.warnings.empty());
  EXPECT_NE(calibration.warnings.back().find("no medial knee marker"), std::string::npos);
}
TEST(MarkerMap, KnowsDigitsAndIgnoresCase) {
  EXPECT_TRUE(label_matches("rth12", "RTH#"));
  EXPECT_FALSE(label_matches("RTHI", "RTH#"));
  EXPECT_FALSE(label_matches("RTH12x", "RTH#"));
  MarkerData markers;
  markers.labels = {"LASI", "rasi", "SACR", "RTHI", "RKNE", "RTH1", "RTH2", "LKNE"};
  const auto roles = find_roles(markers, default_marker_map(Side::right));
  EXPECT_EQ(roles.at(MarkerRole::asis_right).front(), "rasi");
  EXPECT_EQ(roles.at(MarkerRole::knee_lateral).front(), "RKNE");
  EXPECT_EQ(roles.at(MarkerRole::thigh), (std::vector<std::string>{"RTHI", "RTH1", "RTH2"}));
  EXPECT_FALSE(roles.contains(MarkerRole::psis_left));
}
TEST(EstimatedCentre, FollowsTheRegressions) {
  const auto harrington = harrington_centre(250, 150, Side::right);
  EXPECT_LE((harrington.centre - Vec3(-45.9, -85.9, 89.8)).norm(), 1e-9);
  EXPECT_LE((harrington_centre(250, 150, Side::left).centre - Vec3(-45.9, -85.9, -89.8)).norm(),
            1e-9);
  EXPECT_LE((bell_centre(250, Side::right).centre - Vec3(-55, -75, 90)).norm(), 1e-9);
}
TEST(EstimatedCentre, OfSpheresIsLessBiasedThanTheClosedForm) {
  Rng rng(11);
  const Vec3 centre(-30, -80, 90);
  std::vector<Points> trajectories(6, Points(400, 3));
  for (std::size_t m = 0; m < trajectories.size(); ++m) {
    const Vec3 site(60 * std::cos(1.0 * m), -150.0 - 30.0 * m, 60 * std::sin(1.0 * m));
    for (Index f = 0; f < 400; ++f) {
      const HipAngles angles{0.5 * std::sin(0.05 * f), 0.4 * std::cos(0.07 * f),
                             0.2 * std::sin(0.11 * f)};
      trajectories[m].row(f) =
          centre + rotation_from_angles(angles, Side::right) * site + 5.0 * rng.normal3();
    }
  }
  const double biased = (gamage_lasenby_centre(trajectories) - centre).norm();
  const JointCentre corrected = sphere_centre(trajectories);
  EXPECT_LT((corrected.centre - centre).norm(), 0.5 * biased);
  EXPECT_LT((corrected.centre - centre).norm(), 1.5);
  EXPECT_NEAR(corrected.rms, 5.0, 0.5);
}
TEST(EstimatedCentre, RefusesAMovementAboutOneAxis) {
  std::vector<RigidTransform> X_LP(50), X_LF(50);
  for (std::size_t k = 0; k < 50; ++k)
    X_LF[k].R = rotation_from_vector(Vec3(0, 0, 0.02 * static_cast<double>(k)));
  EXPECT_THROW(score_centre(X_LP, X_LF), Error);
}
TEST(Registration, FindsThePoseOfTheImage) {
  const RigidTransform X{rotation_from_vector(Vec3(0.3, 1.0, -0.5)), Vec3(10, 20, 30)};
  std::map<std::string, Vec3> in_pelvis = {{"asis_left", Vec3(0, 0, -110)},
                                           {"asis_right", Vec3(0, 0, 110)},
                                           {"psis_left", Vec3(-150, 5, -45)}},
                              in_image;
  for (const auto& [name, p] : in_pelvis) in_image[name] = X.inverse() * p;
  const auto registration = register_image(in_image, in_pelvis);
  EXPECT_LE(registration.rms, 1e-9);
  EXPECT_LE((registration.X_PI.R - X.R).norm(), 1e-9);
  in_image.erase("psis_left");
  EXPECT_THROW(register_image(in_image, in_pelvis), Error);
}

}  // namespace coxa::motion
