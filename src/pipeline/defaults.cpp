#include <coxa/pipeline/defaults.h>

#include <coxa/core/error.h>
#include <coxa/measure/range_of_motion.h>
#include <coxa/measure/thickness.h>
#include <coxa/meshing/mesh_surface.h>
#include <coxa/motion/track_setup.h>
#include <coxa/pipeline/atlas_stage.h>
#include <coxa/pipeline/subject.h>
#include <coxa/pipeline/virtual_patient.h>
#include <coxa/segment/segment.h>

#include <nlohmann/json.hpp>

namespace coxa::pipeline {
namespace {

Fields joint_defaults() {
  const JointEntry joint;
  return {{"loading",
           std::string(joint.loading == Loading::joint_force ? "joint_force" : "prescribed_pose")},
          {"force_N", joint.force},
          {"young_mpa", joint.youngs_modulus},
          {"poisson", joint.poisson_ratio},
          {"law", joint.law},
          {"volume_change", joint.volume_change},
          {"friction", joint.friction},
          {"bare_bone", joint.bare_bone},
          {"labrum", joint.labrum},
          {"labrum_young_mpa", joint.labrum_modulus},
          {"labrum_poisson", joint.labrum_poisson_ratio}};
}

Fields segment_defaults() {
  const segment::SegmentOptions options;
  std::string structures;
  for (const std::string& name : options.structures)
    structures += (structures.empty() ? "" : ",") + name;
  return {{"structures", structures},
          {"landmark_error_mm", options.landmark_error},
          {"search_range_mm", options.search_range},
          {"weight_image", options.weights.image},
          {"weight_shape", options.weights.shape},
          {"weight_smoothing", options.weights.smoothing},
          {"weight_memory", options.weights.memory},
          {"weight_contact", options.weights.contact},
          {"gradient_weight", options.gradient_weight},
          {"minimum_gap_mm", options.minimum_gap},
          {"iterations", std::int64_t{options.iterations}},
          {"tolerance_mm", options.tolerance},
          {"correct_bias", options.correct_bias},
          {"minimum_quality", options.minimum_quality}};
}

Fields track_defaults() {
  const motion::TrackOptions track;
  const motion::CleaningOptions cleaning;
  return {{"method", std::string(motion::name(track.method))},
          {"measurement_sd_mm", track.measurement_sd},
          {"joint_translation_sd_mm", track.joint_translation_sd},
          {"common_rotation_share", track.common_rotation_share},
          {"longest_gap_s", cleaning.longest_gap},
          {"longest_curve_s", cleaning.longest_curve},
          {"jump_mm", cleaning.jump},
          {"cutoff_hz", cleaning.cutoff_hz}};
}

Fields phantom_defaults() {
  const VirtualPatientRequest request;
  return {{"side", std::string(request.side == Side::left ? "left" : "right")},
          {"spread", request.shape.spread},
          {"off_model_mm", request.shape.off_model_rms},
          {"landmark_error_mm", request.landmark_error},
          {"snr", request.image.snr},
          {"bias", request.image.bias},
          {"texture", request.image.texture},
          {"fat_shift_mm", request.image.fat_shift}};
}

}  // namespace

std::map<std::string, Fields> default_options() {
  const MeshEntry mesh;
  const meshing::MeshingOptions meshing;
  const measure::ThicknessOptions thickness;
  const measure::RomOptions rom;
  const AtlasProfileOptions profiles;
  return {
      {"motion", {{"frames", std::int64_t{MotionEntry{}.frames}}}},
      {"mesh", {{"layers", std::int64_t{mesh.layers}}, {"max_tets", std::int64_t{mesh.max_tets}}}},
      {"joint", joint_defaults()},
      {"segment", segment_defaults()},
      {"meshing",
       {{"cell_per_thickness", meshing.cell_per_thickness},
        {"rim_rounding_mm", meshing.rim_rounding},
        {"improvement_rounds", std::int64_t{meshing.improvement_rounds}}}},
      {"track", track_defaults()},
      {"measure",
       {{"max_thickness_mm", thickness.max_thickness}, {"ray_offset_mm", thickness.ray_offset}}},
      {"rom", {{"threshold_mm", rom.threshold}, {"step_deg", degrees(rom.step)}}},
      {"phantom", phantom_defaults()},
      {"atlas", {{"profile_hips", std::int64_t{profiles.n_hips}}}}};
}

std::string to_toml(const std::map<std::string, Fields>& sections) {
  std::string text;
  for (const auto& [section, fields] : sections) {
    text += join_text(text.empty() ? "" : "\n", '[', section, "]\n");
    for (const auto& [key, value] : fields) {
      // JSON and TOML write numbers, truth values and plain text alike
      const auto json = std::visit([](const auto& v) { return nlohmann::json(v); }, value);
      text += key + " = " + json.dump() + "\n";
    }
  }
  return text;
}

}  // namespace coxa::pipeline
