#include <coxa/pipeline/segment_stage.h>

#include <coxa/core/error.h>
#include <coxa/geom/median.h>
#include <coxa/io/atlas_file.h>
#include <coxa/io/dicom.h>
#include <coxa/io/files.h>
#include <coxa/io/labels.h>
#include <coxa/io/landmarks.h>
#include <coxa/io/surfaces.h>
#include <coxa/io/volumes.h>
#include <coxa/measure/thickness.h>
#include <coxa/pipeline/label_map.h>
#include <coxa/pipeline/structures.h>
#include <coxa/segment/pins.h>
#include <coxa/shape/hip_structures.h>

#include <algorithm>

#include "generic_structures.h"
#include "label_edits.h"
#include "segment_calibration.h"

namespace coxa::pipeline {
namespace fs = std::filesystem;
namespace {

// what lies on what
const std::map<std::string, std::string> kHosts{{"femoral_cartilage", "femur"},
                                                {"acetabular_cartilage", "hip_bone"}};
constexpr double kPinKept = 0.3;  // mm, beyond which a pin counts as missed
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

/// The record of the same with corrections by hand.
Record with_corrections(Record record, const SegmentRequest& request) {
  if (!request.labels.empty()) record.inputs["labels"] = io::sha256_of_path(request.labels);
  if (request.pins.empty()) return record;
  record.inputs["pins"] = io::sha256_of_path(request.pins);
  record.options["pin_weight"] = request.pin_weight;
  return record;
}

/// What the image is searched for: generic structures are made afterwards, on bones and cartilages.
segment::SegmentOptions options_of_search(segment::SegmentOptions options) {
  options.calibrations = segment_calibrations();
  auto& names = options.structures;
  if (generic_among(names).empty()) return options;
  std::erase_if(names, is_generic);
  for (const char* needed : shape::kHipStructures) {
    if (std::find(names.begin(), names.end(), needed) == names.end()) names.emplace_back(needed);
  }
  return options;
}

/// Of the vertices that the image shows; of all where it shows none.
double median_in_view(const Surface& surface, const std::string& field) {
  const VecX &values = surface.fields.at(field), &completed = surface.fields.at("completed");
  std::vector<double> seen;
  for (Eigen::Index v = 0; v < values.size(); ++v) {
    if (completed[v] == 0.0) seen.push_back(values[v]);
  }
  if (seen.empty()) return median(values);
  return median(seen);
}

void add_figures(const segment::SegmentResult& result, Record& record) {
  record.figures["quality"] = result.quality;
  for (const auto& [name, q] : result.structures) {
    record.figures[name + "_correlation"] = q.correlation;
    record.figures[name + "_residual_mm"] = q.residual;
    record.figures[name + "_in_view_share"] = q.in_view;
    record.figures[name + "_confidence"] = q.confidence;
  }
  for (const auto& [name, surface] : result.surfaces) {
    if (surface.fields.contains("uncertainty_mm"))
      record.figures[name + "_uncertainty_mm"] = median_in_view(surface, "uncertainty_mm");
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

shape::Landmarks landmarks_of(const SegmentRequest& request) {
  return request.landmarks.empty() ? shape::Landmarks{} : io::read_landmarks(request.landmarks);
}

std::vector<Volume> read_images(const SegmentRequest& request, const Monitor& monitor) {
  const shape::Landmarks landmarks = landmarks_of(request);
  std::vector<Volume> images;
  for (const ImageEntry& entry : request.images)
    images.push_back(read_image(entry, landmarks, monitor));
  return images;
}

/// Searches the images; figures and warnings go into the record.
SurfaceSet found_in_image(const SegmentRequest& request, const std::vector<Volume>& images,
                          Record& record, const Monitor& monitor) {
  for (const Volume& image : images) warn_of_thick_slices(image, record, monitor);
  segment::SegmentResult result =
      segment::segment(images, io::read_atlas(request.atlas), request.side, landmarks_of(request),
                       options_of_search(request.options), monitor);
  add_figures(result, record);
  record.warnings.insert(record.warnings.end(), result.warnings.begin(), result.warnings.end());
  return std::move(result.surfaces);
}

/// Where an earlier result holds the surfaces without corrections, of the same images, landmarks,
/// atlas and options; empty: nowhere.
fs::path kept_as_found(const fs::path& earlier, const Record& wanted, Reuse reuse) {
  for (const fs::path& place : {earlier, earlier / "found"}) {
    if (reuse == Reuse::if_unchanged && holds_result(place, wanted)) return place;
  }
  return {};
}

void write_found(const fs::path& found, const SurfaceSet& surfaces, const Record& record) {
  for (const auto& [name, surface] : surfaces) io::write_surface(found / (name + ".vtp"), surface);
  write_record(found / "segment.json", record);
}

/// Every surface that was found in the image.
SurfaceSet read_found(const fs::path& folder) {
  SurfaceSet surfaces;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().stem().string();
    if (entry.path().extension() != ".vtp" || is_generic(name)) continue;
    surfaces[name] = io::read_surface_with_fields(entry.path());
  }
  if (surfaces.empty()) fail(ErrorCode::bad_file, folder.string(), " holds no surface");
  return surfaces;
}

/// Labrum and ligaments, where they are asked for.
void make_generic(const SegmentRequest& request, SurfaceSet& surfaces, Record& record,
                  const Monitor& monitor) {
  const auto& wanted = request.options.structures;
  if (generic_among(wanted).empty()) return;
  const shape::Atlas atlas = io::read_atlas(request.atlas);
  add_generic(surfaces, wanted, request.side, &atlas, record, monitor);
}

std::vector<segment::Pin> read_pins(const SegmentRequest& request) {
  std::vector<segment::Pin> pins;
  if (request.pins.empty()) return pins;
  for (const auto& [name, place] : io::read_landmarks(request.pins)) {
    const std::size_t dash = name.rfind('-');
    require(dash != std::string::npos && dash > 0, request.pins.string(), ": a pin is named ",
            "<structure>-<number>, as femur-1; got ", name);
    pins.push_back({name, name.substr(0, dash), place, request.pin_weight});
  }
  return pins;
}

void set_pins(const std::vector<segment::Pin>& pins, double gap, SurfaceSet& surfaces,
              Record& record, const Monitor& monitor) {
  const auto left = segment::update_pinned(surfaces, pins, kHosts, gap);
  for (const auto& [name, distance] : left) {
    record.figures["pin_" + name + "_distance_mm"] = distance;
    if (distance <= kPinKept) continue;
    record.warnings.push_back(join_text("the surface passes pin ", name, " at ", distance,
                                        " mm: others nearby ask for something else"));
    monitor.warn(record.warnings.back());
  }
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
  const Record as_found = wanted_record(request);
  const auto body = [&](const fs::path& partial, Record& record) {
    const std::vector<segment::Pin> pins = read_pins(request);
    const std::vector<Volume> images = read_images(request, monitor);
    const fs::path kept = kept_as_found(folder, as_found, reuse);
    Record found = kept.empty() ? as_found : read_record(kept / "segment.json");
    SurfaceSet surfaces = kept.empty() ? found_in_image(request, images, found,
                                                        part_of(monitor, "segment", 0.0, 0.95))
                                       : read_found(kept);
    record.figures = found.figures;
    record.warnings = found.warnings;
    if (!pins.empty() || !request.labels.empty()) write_found(partial / "found", surfaces, found);
    if (!request.labels.empty())
      follow_labels(request.labels, images.front(), surfaces, record, monitor);
    if (!pins.empty()) set_pins(pins, request.options.minimum_gap, surfaces, record, monitor);
    make_generic(request, surfaces, record, monitor);
    add_thickness(surfaces);
    for (const auto& [name, surface] : surfaces) {
      io::write_surface(partial / (name + ".vtp"), surface);
      io::write_surface(partial / (name + ".ply"), surface);
    }
    io::write_labels(partial / "labels.nii.gz", make_label_map(images.front(), surfaces));
  };
  return run_stage(folder, with_corrections(as_found, request), reuse, monitor, body);
}

void add_thickness(SurfaceSet& surfaces) {
  for (const auto& [cartilage, bone] : kHosts) {
    if (!surfaces.count(cartilage) || !surfaces.count(bone)) continue;
    surfaces[bone].fields["cartilage_thickness_mm"] =
        measure::closed_cartilage_thickness(surfaces[bone].mesh, surfaces[cartilage].mesh);
  }
}

SurfaceSet read_surfaces(const fs::path& folder) {
  SurfaceSet surfaces;
  for (const char* name : shape::kHipStructures) {
    const fs::path path = folder / (std::string(name) + ".vtp");
    if (fs::exists(path)) surfaces[name] = io::read_surface_with_fields(path);
  }
  if (surfaces.empty())
    fail(ErrorCode::bad_file, folder.string(), " holds no surface of a hip (femur.vtp, …)");
  return surfaces;
}

}  // namespace coxa::pipeline
