#pragma once

#include <coxa/core/types.h>
#include <coxa/io/config.h>
#include <coxa/joint/joint_model.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace coxa::pipeline {

/// One MRI of the subject.
struct ImageEntry {
  std::filesystem::path path;         ///< NIfTI, NRRD, MetaImage or a DICOM folder
  std::optional<std::string> series;  ///< of a DICOM folder with several
};

/// The movement: either a pattern or recorded markers.
struct MotionEntry {
  std::string
      pattern;  ///< name of a movement in data/movements, or a movement file; empty: markers
  std::filesystem::path markers;  ///< C3D, TRC or CSV
  std::filesystem::path config;   ///< how the markers are to be read (docs/motion.md)
  std::filesystem::path
      landmarks;  ///< of the bones' frames, corrected by hand; they win over [landmarks]; or empty
  /// The part of a recording that is simulated, s; the whole trial is tracked all the same.
  std::optional<double> from, to;
  Index frames = 14;  ///< frames that are simulated, spread evenly over the movement, >= 2
};

enum class Loading { joint_force, body_weight, prescribed_pose };

/// A ligament of the joint; see `joint::Ligament`.
struct LigamentEntry {
  std::string name;
  Vec3 origin = Vec3::Zero(), insertion = Vec3::Zero();  ///< mm, image frame
  double stiffness = 0.0;                                ///< N/mm
  std::optional<double> slack_length;  ///< mm; nullopt: as long as in the image pose
  double wrap_radius = 0.0;            ///< mm; 0: straight
};

struct JointEntry {
  Loading loading = Loading::joint_force;
  double force = 500.0;  ///< N, of the joint force
  double percent = 0.0;  ///< of body weight, with Loading::body_weight; > 0
  /// Of the joint force, femur onto socket, pelvis axes (anterior, superior, right); nullopt: into
  /// the socket along its axis.
  std::optional<Vec3> direction;
  double youngs_modulus = 12.0;  ///< MPa
  double poisson_ratio = 0.42;
  std::string law = "corotational";       ///< or st_venant_kirchhoff, neo_hookean
  std::string volume_change = "patches";  ///< or elements: what resists it
  double friction = 0.0;                  ///< coefficient of cartilage on cartilage
  std::string bare_bone = "hip_bone";     ///< or both
  std::string labrum = "rigid";           ///< or soft: what a run makes of a segmented labrum
  double labrum_modulus = joint::kLabrumMaterial.youngs_modulus;  ///< MPa
  double labrum_poisson_ratio = joint::kLabrumMaterial.poissons_ratio;
  std::vector<LigamentEntry> ligaments = {};
};

struct MeshEntry {
  Index layers = 1;        ///< through the cartilage, 1 to 8
  Index max_tets = 20000;  ///< per cartilage
};

/// A subject file (`SUBJECT.toml`), its paths resolved against the file's folder.
struct Subject {
  std::filesystem::path file;
  std::string name;
  Side side = Side::right;
  std::optional<double> body_mass;  ///< kg
  std::vector<ImageEntry> images;   ///< none where surfaces are given
  std::map<std::string, std::filesystem::path>
      surfaces;                     ///< by structure, in place of images: a hip segmented elsewhere
  std::filesystem::path landmarks;  ///< `.mrk.json` or CSV
  std::filesystem::path pins;       ///< likewise; points named `<structure>-<n>`
  std::filesystem::path labels;     ///< label map of an earlier result, corrected by hand
  /// What is segmented or made; empty: bones and cartilages. These are always among it.
  std::vector<std::string> structures;
  std::filesystem::path atlas;  ///< the shipped one where the file names none
  MotionEntry motion;
  MeshEntry mesh;
  JointEntry joint;
};

/// @throws Error bad_input for a missing or unknown key (the nearest known one is named), a value
/// out of range,
///         or an input file that does not exist
Subject read_subject(const std::filesystem::path& path);

/// The key `side` of a table. @throws Error bad_input unless it is left or right
Side read_side(const io::Table& table);
/// The table [joint] of a subject or joint file, defaults where it is missing.
/// @throws Error bad_input for an unknown key or a value out of range
JointEntry read_joint_entry(const io::Table& root);

/// The atlas that ships with coxa; the environment variable COXA_DATA overrides its folder.
std::filesystem::path shipped_data(const std::string& relative);

}  // namespace coxa::pipeline
