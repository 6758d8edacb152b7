#pragma once

#include <coxa/segment/evolve.h>
#include <coxa/segment/segment.h>

#include <optional>
#include <string>
#include <vector>

namespace coxa::segment {

/// Where bones start.
struct BoneStart {
  std::vector<Points> placed;  ///< per bone, finest mean points in the image
  shape::Landmarks landmarks;  ///< by which, given or found; none where the atlas knows too few
};

/// Everything about one hip while it is segmented, as a right hip.
class Hip {
 public:
  /// @param atlas, options must outlive the hip
  Hip(std::vector<PreparedImage> images, const shape::Atlas& atlas, const SegmentOptions& options);

  void segment_bones(const shape::Landmarks& given, const Monitor& monitor);
  void segment_layers(const Monitor& monitor);
  /// Muscles from where the bones carry them; nothing where none is asked for.
  void segment_muscles(const Monitor& monitor);

  const std::vector<Body>& bodies() const { return bodies_; }
  const std::vector<PreparedImage>& images() const { return images_; }
  bool is_bone(std::size_t s) const { return !hosts_[s].has_value() && !is_muscle(s); }
  bool has_muscles() const { return !models_.empty() && models_.back()->muscle; }
  bool is_muscle(std::size_t s) const { return models_[s]->muscle; }

  /// The surfaces of all bodies: layers with the extent that the images show, on their bones.
  std::vector<Surface> surfaces(std::vector<std::string>& warnings) const;

  /// Whether the caller asked for it, or only something that lies on it needs it.
  bool is_asked_for(std::size_t s) const;

 private:
  /// The structures asked for and the ones they lie on.
  void choose_models();
  std::vector<const shape::StructureModel*> models_of(
      const std::vector<std::size_t>& numbers) const;
  /// Where the bones of these numbers may start: by the landmarks given, else found.
  std::vector<BoneStart> bone_starts(const std::vector<std::size_t>& numbers,
                                     const shape::Landmarks& given, const Monitor& monitor);
  std::vector<Body> bones_at(const std::vector<std::size_t>& numbers, const BoneStart& start);
  /// The bones that the images show, by as many searches as they need.
  std::vector<Body> searched_bones(std::vector<Body> bones, const Monitor& monitor);
  void choose_contrasts(const std::vector<Body>& bodies, Resolution resolution);
  std::vector<Body> found_by(const std::vector<Resolution>& resolutions, std::vector<Body> bones,
                             const Monitor& monitor) const;
  /// Takes the bones' surfaces to the borders that the images show where they are bare.
  /// @returns by image: standard deviation of its blur in half voxels
  std::vector<double> update_bones(std::vector<Surface>& surfaces) const;
  /// Field uncertainty_mm of every structure with a calibration.
  void add_uncertainties(std::vector<Surface>& surfaces) const;
  /// Layers with sides known start with the modes that fit the images best.
  void place_layers(std::vector<Body>& layers, const std::vector<TriMesh>& means,
                    const std::vector<TriMesh>& seats, Resolution resolution);

  std::vector<PreparedImage> images_;
  const shape::Atlas& atlas_;
  const SegmentOptions& options_;
  std::vector<const shape::StructureModel*> models_;
  std::vector<std::optional<std::size_t>> hosts_;
  std::vector<Preparation> preparations_;
  std::vector<Body> bodies_;
};

}  // namespace coxa::segment
