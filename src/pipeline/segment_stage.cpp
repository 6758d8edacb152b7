#include <coxa/pipeline/segment_stage.h>

#include <coxa/core/error.h>
#include <coxa/io/atlas_file.h>
#include <coxa/io/dicom.h>
#include <coxa/io/files.h>
#include <coxa/io/labels.h>
#include <coxa/io/landmarks.h>
#include <coxa/io/surfaces.h>
#include <coxa/io/volumes.h>
#include <coxa/measure/thickness.h>
#include <coxa/pipeline/label_map.h>

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {

constexpr const char* kStructures[] = {"femur", "hip_bone", "femoral_cartilage",
                                       "acetabular_cartilage"};
// slices thicker than this leave a layer of cartilage unresolved; an adult protocol has 3 mm or
// less
constexpr double kThickSlice = 4.0;

Points rows_of(const shape::Landmarks& landmarks) {
  Points points(static_cast<Index>(landmarks.size()), 3);
  Index row = 0;
  for (const auto& [name, p] : landmarks) points.row(row++) = p;
  return points;
}

std::string list_of(const std::vector<io::DicomSeries>& series) {
  std::string text;
  for (const io::DicomSeries& s : series) text += "\n  " + io::describe(s);
  return text;
}

Volume read_dicom_entry(const ImageEntry& entry, const shape::Landmarks& landmarks,
                        const Monitor& monitor) {
  const auto all = io::list_dicom_series(entry.path);
  if (entry.series || landmarks.empty() || all.size() < 2)
    return io::read_dicom(entry.path, entry.series);
  const auto holding = io::series_holding(all, rows_of(landmarks));
  require(!holding.empty(), entry.path.string(), " holds ", all.size(),
          " series, and no whole one has all landmarks in view; choose with series = \"…\":",
          list_of(all));
  require(holding.size() == 1, entry.path.string(), " holds ", holding.size(),
          " series with the landmarks in view; choose with series = \"…\":", list_of(holding));
  monitor.warn("of " + std::to_string(all.size()) + " series in " + entry.path.string() +
               " the one with the landmarks is used: " + io::describe(holding.front()));
  return io::read_series(holding.front());
}

Record wanted_record(const SegmentRequest& request) {
  Record record;
  record.verb = "segment";
  const segment::SegmentOptions& o = request.options;
  std::string structures;
  for (const std::string& name : o.structures) structures += (structures.empty() ? "" : ",") + name;
  record.options = {{"side", std::string(request.side == Side::left ? "left" : "right")},
                    {"structures", structures},
                    {"landmark_error_mm", o.landmark_error},
                    {"search_range_mm", o.search_range},
                    {"minimum_gap_mm", o.minimum_gap},
                    {"correct_bias", o.correct_bias},
                    {"contrast", o.contrast.value_or("automatic")},
                    {"minimum_quality", o.minimum_quality}};
  for (std::size_t i = 0; i < request.images.size(); ++i) {
    const ImageEntry& image = request.images[i];
    record.inputs["image_" + std::to_string(i + 1)] = io::sha256_of_path(image.path);
    if (image.series) record.options["series_" + std::to_string(i + 1)] = *image.series;
  }
  if (!request.landmarks.empty())
    record.inputs["landmarks"] = io::sha256_of_path(request.landmarks);
  record.inputs["atlas"] = io::sha256_of_path(request.atlas);
  return record;
}

void add_figures(const segment::SegmentResult& result, Record& record) {
  record.figures["quality"] = result.quality;
  for (const auto& [name, q] : result.structures) {
    record.figures[name + "_correlation"] = q.correlation;
    record.figures[name + "_residual_mm"] = q.residual;
    record.figures[name + "_in_view_share"] = q.in_view;
    record.figures[name + "_confidence"] = q.confidence;
  }
  for (const auto& [name, distance] : result.landmark_distances) {
    record.figures["landmark_" + name + "_distance_mm"] = distance;
  }
  for (std::size_t i = 0; i < result.contrasts.size(); ++i) {
    record.figures["contrast_" + std::to_string(i + 1)] = result.contrasts[i];
  }
}

void warn_of_thick_slices(const Volume& image, Record& record, const Monitor& monitor) {
  const double thickest = image.spacing.maxCoeff();
  if (thickest <= kThickSlice) return;
  record.warnings.push_back(join_text("slices of ", thickest,
                                      " mm: cartilage is not resolved, the shape model ",
                                      "completes it; low confidence"));
  monitor.warn(record.warnings.back());
}

}  // namespace

Volume read_image(const ImageEntry& entry, const shape::Landmarks& landmarks,
                  const Monitor& monitor) {
  if (fs::is_directory(entry.path)) return read_dicom_entry(entry, landmarks, monitor);
  require(!entry.series, entry.path.string(), " is a file; series is for DICOM folders");
  return io::read_volume(entry.path);
}

Record run_segment_stage(const SegmentRequest& request, const fs::path& folder, Reuse reuse,
                         const Monitor& monitor) {
  const auto body = [&](const fs::path& partial, Record& record) {
    const shape::Landmarks landmarks =
        request.landmarks.empty() ? shape::Landmarks{} : io::read_landmarks(request.landmarks);
    std::vector<Volume> images;
    for (const ImageEntry& entry : request.images) {
      images.push_back(read_image(entry, landmarks, monitor));
      warn_of_thick_slices(images.back(), record, monitor);
    }
    segment::SegmentResult result =
        segment::segment(images, io::read_atlas(request.atlas), request.side, landmarks,
                         request.options, part_of(monitor, "segment", 0.0, 0.95));
    add_thickness(result.surfaces);
    for (const auto& [name, surface] : result.surfaces) {
      io::write_surface(partial / (name + ".vtp"), surface);
      io::write_surface(partial / (name + ".ply"), surface);
    }
    io::write_labels(partial / "labels.nii.gz", make_label_map(images.front(), result.surfaces));
    add_figures(result, record);
    record.warnings.insert(record.warnings.end(), result.warnings.begin(), result.warnings.end());
  };
  return run_stage(folder, wanted_record(request), reuse, monitor, body);
}

void add_thickness(SurfaceSet& surfaces) {
  for (const auto& [cartilage, bone] :
       {std::pair{"femoral_cartilage", "femur"}, {"acetabular_cartilage", "hip_bone"}}) {
    if (!surfaces.count(cartilage) || !surfaces.count(bone)) continue;
    surfaces[bone].fields["cartilage_thickness_mm"] =
        measure::closed_cartilage_thickness(surfaces[bone].mesh, surfaces[cartilage].mesh);
  }
}

SurfaceSet read_surfaces(const fs::path& folder) {
  SurfaceSet surfaces;
  for (const char* name : kStructures) {
    const fs::path path = folder / (std::string(name) + ".vtp");
    if (fs::exists(path)) surfaces[name] = io::read_surface_with_fields(path);
  }
  if (surfaces.empty())
    fail(ErrorCode::bad_file, folder.string(), " holds no surface of a hip (femur.vtp, …)");
  return surfaces;
}

}  // namespace coxa::pipeline
