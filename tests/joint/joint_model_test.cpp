#include <coxa/joint/joint_model.h>

#include <coxa/core/error.h>
#include <coxa/joint/load_case.h>
#include <gtest/gtest.h>

#include <string>

#include "joint/layers.h"

namespace coxa::joint {

const JointModel model = test::make_ball_in_cup({.cup_rings = 4, .head_rings = 5, .layers = 1});

std::string fault(const JointModel& bad) {
  try {
    check_model(bad);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(CheckModel, AcceptsABallInACup) { EXPECT_EQ(fault(model), ""); }
TEST(CheckModel, NamesWhatCannotBeUsed) {
  JointModel bad = model;
  bad.acetabular_cartilage.tets.resize(0, 4);
  EXPECT_NE(fault(bad).find("acetabular cartilage has no tetrahedra"), std::string::npos);
  bad = model;
  for (FacetTag& tag : bad.femoral_cartilage.facet_tags) tag = FacetTag::rim;
  EXPECT_NE(fault(bad).find("femoral cartilage has no boundary facet tagged"), std::string::npos);
  bad = model;
  bad.femoral_cartilage.facet_tags.pop_back();
  EXPECT_NE(fault(bad).find("tags"), std::string::npos);
  bad = model;
  bad.material.poissons_ratio = 0.5;
  EXPECT_NE(fault(bad).find("0.5"), std::string::npos);
  bad.material.poissons_ratio = 0.0;  // leaves patches nothing to resist with
  EXPECT_NE(fault(bad).find("(0, 0.5)"), std::string::npos);
  bad.material.volume_change = VolumeChange::by_elements;
  check_model(bad);
  bad = model;
  bad.material.youngs_modulus = -3.0;
  EXPECT_NE(fault(bad).find("-3"), std::string::npos);
  bad = model;
  bad.X_IF.p.x() += 2.0;
  EXPECT_NE(fault(bad).find("2 mm apart"), std::string::npos);
  bad = model;
  bad.femur = test::cap_directions(1.0, 2);
  EXPECT_NE(fault(bad).find("both bone surfaces"), std::string::npos);
}
TEST(CheckModel, RecognisesExchangedFacetTags) {
  for (TetMesh JointModel::*mesh :
       {&JointModel::acetabular_cartilage, &JointModel::femoral_cartilage}) {
    JointModel bad = model;
    for (FacetTag& tag : (bad.*mesh).facet_tags) {
      if (tag == FacetTag::bone_side) {
        tag = FacetTag::articular_side;
      } else if (tag == FacetTag::articular_side) {
        tag = FacetTag::bone_side;
      }
    }
    EXPECT_NE(fault(bad).find("look exchanged"), std::string::npos);
  }
}
TEST(FacetsWith, SplitTheBoundaryByTag) {
  const TetMesh& mesh = model.acetabular_cartilage;
  EXPECT_EQ(facets_with(mesh, FacetTag::articular_side).rows(), 96);
  EXPECT_EQ(facets_with(mesh, FacetTag::bone_side).rows(), 96);
  EXPECT_EQ(facets_with(mesh, FacetTag::rim).rows(), 48);
  EXPECT_EQ(facets_with(mesh, FacetTag::untagged).rows(), 0);
}
TEST(SocketAxis, PointsOutOfTheCup) {
  EXPECT_LT((socket_axis(model) + Vec3::UnitZ()).norm(), 1e-12);
}

TEST(SocketClock, HasTwelveSuperiorAndThreeAnteriorOnBothSides) {
  // a socket that opens to the side: right hip to the right (-x in LPS), left hip to the left
  for (const double lateral : {-1.0, 1.0}) {
    const ClockFace clock =
        make_clock_face(Vec3::Zero(), Vec3(lateral, 0, 0), Vec3::UnitZ(), -Vec3::UnitY());
    EXPECT_NEAR(clock.hour(Vec3(0, -1e-9, 1)), 0.0, 1e-6);
    EXPECT_NEAR(clock.hour(Vec3(5, -1, 0)), 3.0, 1e-9);  // anterior is -y in LPS
    EXPECT_NEAR(clock.hour(Vec3(0, 1, 1)), 10.5, 1e-9);  // posterosuperior
    EXPECT_EQ(clock.sector(Vec3(0, 0.1, 1)), 0);
    EXPECT_EQ(clock.sector(Vec3(0, 0, -1)), 6);
  }
}

TEST(LoadCase, PassiveExaminationPushesIntoTheCup) {
  const LoadCase load = passive_examination(model, 400.0);
  EXPECT_EQ(load.mode, LoadMode::force);
  // the cup's pole is superior: y in pelvis axes
  EXPECT_LT((load.force_P.row(0).transpose() - Vec3(0, 400, 0)).norm(), 1e-9);
  EXPECT_NE(load.description.find("400 N"), std::string::npos);
  EXPECT_THROW(passive_examination(model, 0.0), Error);
}
TEST(LoadCase, BodyWeightLoadScalesWithMassAndPercent) {
  const LoadCase load = body_weight_load(200.0, 0.08, Vec3(0, 2, 0));
  EXPECT_NEAR(load.force_P(0, 1), 2.0 * 80.0 * 9.80665, 1e-9);
  EXPECT_THROW(body_weight_load(0.0, 0.08, Vec3::UnitY()), Error);
  EXPECT_THROW(body_weight_load(200.0, -1.0, Vec3::UnitY()), Error);
  EXPECT_THROW(body_weight_load(200.0, 0.08, Vec3::Zero()), Error);
}
TEST(LoadCase, PrescribedPoseHasNoForce) {
  EXPECT_EQ(prescribed_pose().mode, LoadMode::prescribed_pose);
}

}  // namespace coxa::joint
