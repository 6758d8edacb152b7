#pragma once

#include <coxa/core/monitor.h>
#include <coxa/pipeline/joint_stage.h>
#include <coxa/pipeline/motion_stage.h>
#include <coxa/pipeline/subject.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "body_surface.h"

namespace coxa::serve {

inline constexpr const char* kLabrum = "acetabular_labrum";
inline constexpr const char* kStructures[] = {"hip_bone", "femur", "acetabular_cartilage",
                                              "femoral_cartilage", kLabrum};

/// Whether a name is one of an image in one file.
bool is_image(const std::filesystem::path& path);

/// What a segmentation needs of the subject, from its file or, without one, from the one image that
/// lies in the folder.
struct CaseInput {
  std::optional<pipeline::Subject> subject;
  std::vector<pipeline::ImageEntry> images;
  std::optional<Side> side;
  std::string fault;  ///< why there is no image; empty when there is one
};

/// A subject's folder, as far as it has got: what is there is read when asked for.
class CaseFolder {
 public:
  /// @throws Error bad_file if there is no such folder
  explicit CaseFolder(const std::filesystem::path& folder);

  const std::filesystem::path& folder() const { return folder_; }
  /// What the folder holds, for the browser's first look.
  nlohmann::json overview() const;
  CaseInput input() const;
  /// Where landmarks are read from: the folder's own, else the subject file's; empty: nowhere.
  std::filesystem::path landmarks_file() const;

  /// Likewise the points that surfaces must pass through.
  std::filesystem::path pins_file() const;

  // bundles, as bytes; @throws Error bad_file or bad_input where there is no such thing
  std::string surface(const std::string& structure) const;
  std::string body(const std::string& name) const;
  std::string frame(Index index) const;
  std::string image() const;

  bool has_meshes() const;
  /// Kept until its file changes.
  std::shared_ptr<const Body> read_body(const std::string& name) const;
  /// The hip as it would be simulated, for the live examination.
  struct Hip {
    joint::JointModel model;
    joint::LoadCase load;
  };
  Hip read_hip() const;

 private:
  pipeline::JointRequest joint_request() const;
  /// Where a structure's surface lies: among the segmented ones, the labrum else where the joint
  /// file names it; empty: nowhere.
  std::filesystem::path surface_file(const std::string& structure) const;
  Side side() const;
  /// The socket's clock face, and the angles at which the hip was imaged.
  nlohmann::json joint_frames() const;
  RigidTransform unsolved_pose(Index index) const;

  struct KeptBody {
    std::filesystem::file_time_type written;
    std::shared_ptr<const Body> body;
  };
  std::filesystem::path folder_;
  mutable std::map<std::string, KeptBody> bodies_;  ///< requests are answered one by one
};

}  // namespace coxa::serve
