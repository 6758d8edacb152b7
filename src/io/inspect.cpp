#include <coxa/io/inspect.h>

#include <coxa/core/error.h>
#include <coxa/io/config.h>
#include <coxa/io/dicom.h>
#include <coxa/io/files.h>
#include <coxa/io/landmarks.h>
#include <coxa/io/markers.h>
#include <coxa/io/motion_files.h>
#include <coxa/io/surfaces.h>
#include <coxa/io/tets.h>
#include <coxa/io/volumes.h>
#include <coxa/mesh/tet_quality.h>
#include <coxa/mesh/validate.h>

#include <algorithm>
#include <map>

namespace coxa::io {
namespace {

namespace fs = std::filesystem;

constexpr double kThickSlice = 4.0;    ///< mm; the joint space is not resolved beyond
constexpr double kManyGaps = 0.1;      ///< share of a marker's frames
constexpr double kSlowRecording = 50;  ///< Hz

template <class... Parts>
void add(std::vector<std::string>& lines, const Parts&... parts) {
  lines.push_back(join_text(parts...));
}

void inspect_volume(const Volume& volume, Inspection& result) {
  const Vec3 last(volume.size[0] - 1, volume.size[1] - 1, volume.size[2] - 1);
  const auto [low, high] = std::minmax_element(volume.values.begin(), volume.values.end());
  add(result.facts, volume.size[0], "x", volume.size[1], "x", volume.size[2], " voxels of ",
      volume.spacing[0], "x", volume.spacing[1], "x", volume.spacing[2], " mm");
  add(result.facts, "centre at LPS (", volume.position(0.5 * last).transpose(), ") mm");
  add(result.facts, "values from ", *low, " to ", *high);
  if (*low == *high) add(result.problems, "all voxels are ", *low);
  if (volume.spacing.maxCoeff() > kThickSlice) {
    add(result.warnings, "slices of ", volume.spacing.maxCoeff(),
        " mm: cartilage thickness cannot be measured (limit ", kThickSlice, " mm)");
  }
}

void inspect_image(const fs::path& path, Inspection& result) {
  result.kind = "image";
  inspect_volume(read_volume(path), result);
}

void inspect_dicom(const std::vector<DicomSeries>& series, Inspection& result) {
  result.kind = "DICOM folder";
  std::vector<DicomSeries> usable;
  for (const DicomSeries& one : series) {
    add(result.facts, describe(one));
    if (one.usable()) usable.push_back(one);
  }
  if (usable.empty()) add(result.problems, "no series is one whole stack");
  if (series.size() > 1) add(result.warnings, series.size(), " series: select one by its id");
  if (usable.size() == 1) inspect_volume(read_series(usable[0]), result);
}

void inspect_surface(const fs::path& path, Inspection& result) {
  result.kind = "surface";
  const Surface surface = read_surface_with_fields(path);
  const TriMesh& mesh = surface.mesh;
  add(result.facts, mesh.n_vertices(), " vertices, ", mesh.n_triangles(), " triangles");
  add(result.facts, "from LPS (", mesh.points.colwise().minCoeff(), ") to (",
      mesh.points.colwise().maxCoeff(), ") mm");
  for (const auto& [name, values] : surface.fields) {
    add(result.facts, "field ", name, " from ", values.minCoeff(), " to ", values.maxCoeff());
  }
  const ValidityReport report = validate(mesh);
  for (const Fault& fault : report.faults) {
    add(fault.kind == FaultKind::sliver ? result.warnings : result.problems, describe(fault));
  }
}

void inspect_tets(const fs::path& path, Inspection& result) {
  result.kind = "tetrahedra";
  const TetFile file = read_tets_with_fields(path);
  const TetQuality quality = tet_quality(file.mesh.points, file.mesh.tets);
  add(result.facts, file.mesh.n_vertices(), " nodes, ", file.mesh.n_tets(),
      file.mesh.mid_nodes.rows() > 0 ? " ten-node" : " four-node", " tetrahedra, ",
      file.mesh.facets.rows(), " tagged facets");
  add(result.facts, "volume ", quality.volume, " mm3, dihedral angles ",
      degrees(quality.dihedral_min), " to ", degrees(quality.dihedral_max),
      " degrees, aspect at least ", quality.aspect_min);
  for (const auto& [name, values] : file.fields.at_points) add(result.facts, "point field ", name);
  for (const auto& [name, values] : file.fields.at_tets) add(result.facts, "cell field ", name);
  if (quality.n_inverted > 0)
    add(result.problems, quality.n_inverted, " tetrahedra have no volume");
  if (file.mesh.facets.rows() == 0)
    add(result.warnings, "the boundary is not tagged (bone side, articular side)");
}

void inspect_markers(const fs::path& path, Inspection& result) {
  result.kind = "markers";
  const motion::MarkerData data = read_markers(path);
  add(result.facts, data.n_markers(), " markers, ", data.n_frames(), " frames at ", data.rate,
      " Hz");
  std::string labels;
  for (const std::string& label : data.labels) labels += ' ' + label;
  add(result.facts, "labels:", labels);
  for (std::size_t m = 0; m < data.labels.size(); ++m) {
    Index unseen = 0;
    for (Index f = 0; f < data.n_frames(); ++f)
      unseen += motion::seen(data.trajectories[m], f) ? 0 : 1;
    if (unseen > kManyGaps * data.n_frames()) {
      add(result.warnings, data.labels[m], " is not seen in ", unseen, " of ", data.n_frames(),
          " frames");
    }
  }
  if (data.n_markers() == 0 || data.n_frames() == 0) add(result.problems, "no marker was recorded");
  if (data.rate > 0.0 && data.rate < kSlowRecording)
    add(result.warnings, "only ", data.rate, " frames per second");
  result.warnings.insert(result.warnings.end(), data.warnings.begin(), data.warnings.end());
}

void inspect_landmarks(const fs::path& path, Inspection& result) {
  result.kind = "landmarks";
  const auto landmarks = read_landmarks(path);
  for (const auto& [name, p] : landmarks)
    add(result.facts, name, " at LPS (", p.transpose(), ") mm");
  if (landmarks.size() < 6)
    add(result.warnings, landmarks.size(), " landmarks; six that span both bones are needed");
}

/// A CSV is landmarks, a movement or markers, by its columns.
void inspect_csv(const fs::path& path, Inspection& result) {
  const std::string bytes = read_bytes(path);
  if (bytes.find("flexion_deg") != std::string::npos) {
    result.kind = "movement";
    const motion::HipMotion motion = read_motion(path, Side::right);
    add(result.facts, motion.n_frames(), " frames");
    double flexion = 0.0;
    for (const motion::HipAngles& angles : motion.angles)
      flexion = std::max(flexion, angles.flexion);
    add(result.facts, "flexion up to ", degrees(flexion), " degrees");
  } else if (bytes.find("time_s") != std::string::npos) {
    inspect_markers(path, result);
  } else {
    inspect_landmarks(path, result);
  }
}

void inspect_folder(const fs::path& path, Inspection& result) {
  if (fs::exists(path / "subject.toml") || fs::exists(path / "manifest.json")) {
    result.kind = "subject folder";
    for (const char* stage : {"segment", "mesh", "motion", "joint", "measure", "report"}) {
      if (fs::is_directory(path / stage)) add(result.facts, "stage ", stage, " is there");
    }
    return;
  }
  const std::vector<DicomSeries> series = list_dicom_series(path);
  if (!series.empty()) return inspect_dicom(series, result);
  result.kind = "unknown";
  add(result.problems, "the folder holds neither DICOM images nor a subject");
}

void inspect_configuration(const fs::path& path, Inspection& result) {
  result.kind = "configuration";
  for (const std::string& key : Table::read(path).keys()) add(result.facts, "key ", key);
}

using Inspector = void (*)(const fs::path&, Inspection&);

const std::map<std::string, Inspector>& inspectors() {
  static const std::map<std::string, Inspector> kInspectors = {
      {".nii", inspect_image},          {".nii.gz", inspect_image},
      {".nrrd", inspect_image},         {".mha", inspect_image},
      {".seg.nrrd", inspect_image},     {".ply", inspect_surface},
      {".stl", inspect_surface},        {".obj", inspect_surface},
      {".vtp", inspect_surface},        {".vtu", inspect_tets},
      {".msh", inspect_tets},           {".node", inspect_tets},
      {".ele", inspect_tets},           {".c3d", inspect_markers},
      {".trc", inspect_markers},        {".csv", inspect_csv},
      {".mrk.json", inspect_landmarks}, {".toml", inspect_configuration}};
  return kInspectors;
}

}  // namespace

Inspection inspect(const fs::path& path) {
  if (!fs::exists(path)) fail(ErrorCode::bad_file, path.string(), " does not exist");
  Inspection result;
  try {
    const auto found = inspectors().find(extension_of(path));
    if (fs::is_directory(path)) {
      inspect_folder(path, result);
    } else if (found != inspectors().end()) {
      found->second(path, result);
    } else {
      result.kind = "unknown";
      add(result.problems, "a name that ends in '", extension_of(path),
          "' is of no kind that is read");
    }
  } catch (const Error& error) {
    result.problems.push_back(error.what());
  }
  return result;
}

}  // namespace coxa::io
