#include <coxa/core/error.h>
#include <coxa/io/labels.h>
#include <coxa/mesh/mirrored.h>
#include <coxa/mesh/simplex_mesh.h>
#include <coxa/mesh/surface_distance.h>
#include <coxa/mesh/validate.h>
#include <coxa/mesh/voxelize.h>
#include <coxa/pipeline/atlas_examples.h>
#include <coxa/shape/build_atlas.h>
#include <gtest/gtest.h>

#include "small_run.h"

namespace coxa::pipeline {
namespace {

namespace fs = std::filesystem;

/// A folder of this test's own, gone with it.
class OwnFolder {
 public:
  explicit OwnFolder(const std::string& name)
      : path_(fs::temp_directory_path() / ("coxa_" + name + "_" + std::to_string(getpid()))) {
    fs::remove_all(path_);
    fs::create_directories(path_);
  }
  ~OwnFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  OwnFolder(const OwnFolder&) = delete;
  OwnFolder& operator=(const OwnFolder&) = delete;
  fs::path operator/(const std::string& name) const { return path_ / name; }

 private:
  fs::path path_;
};

std::map<std::string, TriMesh> small_hip() {
  return {{"femur", test::small_femur()},
          {"hip_bone", test::small_hip_bone()},
          {"femoral_cartilage", test::surface_of(test::small_head_cartilage())},
          {"acetabular_cartilage", test::surface_of(test::small_socket_cartilage())}};
}

/// The small hip as somebody would have drawn it on voxels of 0.9 mm, as a left one, with a label
/// that an atlas does not know.
io::LabelMap drawn(const Vec3& place) {
  io::LabelMap map;
  Volume& grid = map.volume;
  grid.size = {110, 84, 100};
  grid.spacing = Vec3::Constant(0.9);
  grid.origin = place - Vec3(40.0, 37.0, 45.0);
  grid.values.assign(static_cast<std::size_t>(grid.n_voxels()), 0.0F);
  int value = 0;
  for (auto [name, mesh] : small_hip()) {
    mesh = mirrored(std::move(mesh));
    mesh.points.rowwise() += place.transpose();
    map.labels.push_back({++value, name});
    const auto inside =
        inside_samples(mesh, grid.size, [&](const Vec3& p) { return grid.index(p); });
    for (std::size_t v = 0; v < inside.size(); ++v)
      if (inside[v] != 0) grid.values[v] = static_cast<float>(value);
  }
  map.labels.push_back({9, "bursa"});
  grid.values.front() = 9.0F;
  return map;
}

TEST(OwnLabels, GiveTheExampleThatWasDrawn) {
  const OwnFolder folder("own_labels");
  const fs::path path = folder / "hers_left.nii.gz";
  io::write_labels(path, drawn(Vec3(-90.0, 12.0, 300.0)));
  const auto examples = load_atlas_examples(folder / "nothing", {{}, {}, {path}});
  ASSERT_EQ(examples.size(), 1u);
  EXPECT_NE(examples.front().name.find("left"), std::string::npos);
  const auto truth = small_hip();
  EXPECT_EQ(examples.front().surfaces.size(), truth.size());
  for (const auto& [name, mesh] : truth) {
    const shape::TrustedSurface& found = examples.front().surfaces.at(name);
    EXPECT_TRUE(validate(found.mesh).valid()) << name << validate(found.mesh).text();
    EXPECT_LT(surface_distance(found.mesh, mesh).assd, 0.35) << name;
  }
}

TEST(OwnLabels, GiveModelsOfBonesAndOfCartilagesWhoseSidesAreTold) {
  const OwnFolder folder("own_models");
  const fs::path path = folder / "hers_left.nii.gz";
  io::write_labels(path, drawn(Vec3(-90.0, 12.0, 300.0)));
  const shape::Atlas atlas =
      shape::build_atlas(load_atlas_examples(folder / "nothing", {{}, {}, {path}}));
  ASSERT_EQ(atlas.structures.size(), 4u);
  const auto truth = small_hip();
  // models are 2 to 3 mm coarse, the small hip bone 8 mm thick
  for (const shape::StructureModel& model : atlas.structures) {
    const TriMesh mean = dual_surface(model.hierarchy.levels.back());
    EXPECT_LT(surface_distance(mean, truth.at(model.name)).assd, 2.0) << model.name;
    EXPECT_EQ(model.n_bone_side > 0, model.name.find("_cartilage") != std::string::npos);
  }
}

TEST(OwnLabels, SayWhatIsMissing) {
  const OwnFolder folder("own_labels_bad");
  io::LabelMap map = drawn(Vec3::Zero());
  const auto error_of = [&](const fs::path& path) -> std::string {
    try {
      load_atlas_examples(folder / "nothing", {{}, {}, {path}});
    } catch (const Error& error) {
      return error.what();
    }
    return "none";
  };
  io::write_labels(folder / "map.nii.gz", map);
  EXPECT_NE(error_of(folder / "map.nii.gz").find("must have \"left\" or \"right\" in it"),
            std::string::npos);
  for (io::Label& label : map.labels) label.name += "_x";
  io::write_labels(folder / "right.nii.gz", map);
  EXPECT_NE(error_of(folder / "right.nii.gz").find("no label has the name of a structure"),
            std::string::npos);
}

}  // namespace
}  // namespace coxa::pipeline
