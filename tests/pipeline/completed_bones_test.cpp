#include <coxa/pipeline/completed_bones.h>

#include <coxa/core/error.h>
#include <coxa/geom/fits.h>
#include <coxa/io/atlas_file.h>
#include <coxa/mesh/topology.h>
#include <coxa/shape/shape_modes.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

namespace coxa::pipeline {
namespace {

const shape::Atlas& shipped_atlas() {
  static const shape::Atlas atlas =
      io::read_atlas(std::filesystem::path(COXA_SOURCE_DIR) / "data/atlas/hip.coxa-atlas");
  return atlas;
}

struct PosedBone {
  TriMesh mesh;
  Points vertices;  // of the model
};

// a hip bone drawn from the model, turned, enlarged and moved; LPS mm
PosedBone posed_bone(const RigidTransform& X, Side side) {
  const shape::StructureModel& model = shape::structure(shipped_atlas(), "hip_bone");
  VecX coefficients = VecX::Zero(model.shape.deviations.size());
  coefficients[0] = 0.8;
  coefficients[1] = -0.6;
  SimplexMesh simplex = model.hierarchy.levels.back();
  simplex.points = shape::shape_from(simplex.points, model.shape, coefficients);
  simplex.points = transformed(1.04 * simplex.points, X);
  PosedBone bone{dual_surface(simplex), simplex.points};
  if (side == Side::left) {
    bone.mesh.points.col(0) *= -1.0;
    bone.mesh.triangles.col(1).swap(bone.mesh.triangles.col(2));
    bone.vertices.col(0) *= -1.0;
  }
  return bone;
}

TriMesh below(const TriMesh& mesh, double z) {
  std::vector<Index> kept;
  for (Index t = 0; t < mesh.n_triangles(); ++t) {
    if (mesh.points(mesh.triangles.row(t), 2).maxCoeff() < z) kept.push_back(t);
  }
  return sub_mesh(mesh, kept).mesh;
}

const RigidTransform kPose{rotation_from_vector(Vec3(0.1, -0.06, 0.08)), Vec3(-80, 20, -700)};

}  // namespace

TEST(CompletedBones, FindLandmarksThatAreOutOfView) {
  for (const Side side : {Side::left, Side::right}) {
    const PosedBone bone = posed_bone(kPose, side);
    const Vec3 head = side == Side::right ? kPose.p : Vec3(-kPose.p.x(), kPose.p.y(), kPose.p.z());
    const shape::StructureModel& model = shape::structure(shipped_atlas(), "hip_bone");
    // the wing of the ilium is cut off 60 mm above the joint
    const CompletedBone completed =
        complete_bone(below(bone.mesh, head.z() + 60), model, head + Vec3(3, -2, 4), side);
    EXPECT_LT(completed.in_view, 0.85);
    EXPECT_LT(completed.residual, 0.6);
    for (const char* name : {"asis", "psis"}) {
      const Vec3 truth = bone.vertices.row(model.landmark_vertices.at(name));
      EXPECT_LT((completed.landmarks.at(name) - truth).norm(), 3.0) << name;
    }
  }
}
TEST(CompletedBones, GiveThePelvisItsFrameByIsb) {
  const PosedBone bone = posed_bone(kPose, Side::right);
  const auto landmarks = completed_pelvis_landmarks(
      complete_bone(bone.mesh, shape::structure(shipped_atlas(), "hip_bone"), kPose.p, Side::right),
      Side::right);
  const auto frames = motion::make_bone_frames({}, landmarks, kPose.p, Side::right);
  EXPECT_EQ(frames.pelvis.source, "shape model completion");
  EXPECT_GT(frames.pelvis.interval, 0.0);
  // left-right is the model's own, turned with it
  const Vec3 right = kPose.R * -Vec3::UnitX();
  EXPECT_LT(degrees(std::acos(frames.pelvis.X_IB.R.col(2).dot(right))), 1.0);
  // the plane of ASIS and PSIS holds x
  const Vec3 plane = landmarks.points.at("asis_right") - landmarks.points.at("psis_right");
  EXPECT_NEAR(frames.pelvis.X_IB.R.col(1).dot(plane), 0.0, 1e-6);
}
TEST(CompletedBones, LeaveLandmarksOfTheUserAlone) {
  motion::FrameLandmarks own;
  own.points = {{"asis_right", Vec3(-120, -60, 80)},
                {"asis_left", Vec3(120, -60, 80)},
                {"psis_right", Vec3(-45, 90, 90)}};
  SurfaceSet surfaces;
  surfaces["hip_bone"].mesh = posed_bone({Mat3::Identity(), Vec3::Zero()}, Side::right).mesh;
  const auto frames =
      make_completed_frames(surfaces, own, shipped_atlas(), Vec3::Zero(), Side::right);
  EXPECT_EQ(frames.pelvis.source, "landmarks");
}
TEST(CompletedBones, RefuseWhatIsNoBone) {
  TriMesh triangle;
  triangle.points = Points::Identity(3, 3);
  triangle.triangles = Triangles(1, 3);
  triangle.triangles << 0, 1, 2;
  EXPECT_THROW(complete_bone(triangle, shape::structure(shipped_atlas(), "hip_bone"), Vec3::Zero(),
                             Side::right),
               Error);
}

}  // namespace coxa::pipeline
