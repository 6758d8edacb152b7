#include <coxa/io/dicom.h>

#include <coxa/core/error.h>

#include "dicom_slice.h"
#include "volume_formats.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace coxa::io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFewestSlices = 4;
constexpr double kSameAxis = 1e-3;     ///< largest difference of unit axes within a stack
constexpr double kSameStep = 0.02;     ///< largest deviation of a step from the usual one, relative
constexpr double kSamePlace = 0.1;     ///< steps below this share of the usual one are one place
constexpr double kLocalizerGap = 2.5;  ///< steps above this multiple of the thickness: a localizer

std::vector<DicomSlice> read_headers(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry :
       fs::recursive_directory_iterator(folder, fs::directory_options::skip_permission_denied)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<DicomSlice> slices;
  for (const fs::path& file : files) {
    if (std::optional<DicomSlice> slice = read_dicom_header(file))
      slices.push_back(std::move(*slice));
  }
  return slices;
}

std::string file_name(const DicomSlice& slice) { return slice.file.filename().string(); }

/// What all slices must share before their order means anything; empty if they do.
std::string difference_between(const std::vector<DicomSlice>& slices) {
  const DicomSlice& first = slices.front();
  for (const DicomSlice& slice : slices) {
    if (!slice.fault.empty()) return file_name(slice) + " " + slice.fault;
    if (slice.frames > 1) {
      return join_text("multi-frame DICOM (", slice.frames, " frames in ", file_name(slice),
                       ") is not read; convert it to NIfTI");
    }
    const double turn = std::max((slice.row_axis - first.row_axis).norm(),
                                 (slice.column_axis - first.column_axis).norm());
    if (turn > kSameAxis) {
      return join_text("mixed orientations (", file_name(first), " and ", file_name(slice),
                       "): a localizer, not a stack");
    }
    if (slice.rows != first.rows || slice.columns != first.columns ||
        std::abs(slice.row_spacing - first.row_spacing) > 1e-4 ||
        std::abs(slice.column_spacing - first.column_spacing) > 1e-4) {
      return join_text("slices of different size (", file_name(first), " and ", file_name(slice),
                       ")");
    }
  }
  if (slices.size() < kFewestSlices) {
    return join_text("only ", slices.size(), " slices; a stack needs at least ", kFewestSlices);
  }
  return "";
}

/// What is wrong with the steps between neighbours of the sorted slices; empty if nothing.
std::string problem_of_steps(const std::vector<DicomSlice>& slices, double usual) {
  const Vec3 normal = slices.front().normal();
  for (std::size_t s = 1; s < slices.size(); ++s) {
    const Vec3 step = slices[s].position - slices[s - 1].position;
    const double along = normal.dot(step);
    const auto between = [&] {
      return join_text(file_name(slices[s - 1]), " and ", file_name(slices[s]));
    };
    if (along < kSamePlace * usual)
      return "a slice is there twice: " + between() + " lie at one place";
    if (along > (2.0 - kSamePlace) * usual) {
      return join_text("slices are missing between ", between(), ": a gap of ", along, " mm where ",
                       usual, " mm is usual");
    }
    if (std::abs(along - usual) > kSameStep * usual) {
      return join_text("uneven steps: ", along, " mm between ", between(), ", usual ", usual,
                       " mm");
    }
    if ((step - along * normal).norm() > kSameStep * usual) {
      return "a sheared stack: " + between() + " are shifted against each other";
    }
  }
  const double thickness = slices.front().thickness;
  if (thickness > 0.0 && usual > kLocalizerGap * thickness) {
    return join_text("slices of ", thickness, " mm lie ", usual,
                     " mm apart: a localizer, not a stack");
  }
  return "";
}

/// The most frequent kind of step: the median over neighbours at different places.
double usual_step(const std::vector<DicomSlice>& slices) {
  std::vector<double> steps;
  const Vec3 normal = slices.front().normal();
  for (std::size_t s = 1; s < slices.size(); ++s) {
    const double step = normal.dot(slices[s].position - slices[s - 1].position);
    if (step > 1e-3) steps.push_back(step);
  }
  if (steps.empty()) return 0.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

Volume grid_of(const std::vector<DicomSlice>& slices) {
  const DicomSlice& first = slices.front();
  const auto n = static_cast<Index>(slices.size());
  Volume grid;
  grid.size = {first.columns, first.rows, n};
  grid.origin = first.position;
  grid.direction.col(0) = first.row_axis;
  grid.direction.col(1) = first.column_axis;
  grid.direction.col(2) = first.normal();
  const double length = first.normal().dot(slices.back().position - first.position);
  const double step = n > 1 && length > 0.0 ? length / (n - 1) : first.thickness;
  grid.spacing = Vec3(first.column_spacing, first.row_spacing, step > 0.0 ? step : 1.0);
  return grid;
}

DicomSeries make_series(std::vector<DicomSlice> slices) {
  DicomSeries series;
  series.problem = difference_between(slices);
  const Vec3 normal = slices.front().normal();
  std::stable_sort(slices.begin(), slices.end(), [&](const DicomSlice& a, const DicomSlice& b) {
    return normal.dot(a.position) < normal.dot(b.position);
  });
  if (series.usable()) series.problem = problem_of_steps(slices, usual_step(slices));
  const DicomSlice& first = slices.front();
  series.uid = first.series_uid;
  series.description = first.description;
  series.modality = first.modality;
  series.slice_thickness = first.thickness;
  series.grid = grid_of(slices);
  for (const DicomSlice& slice : slices) series.files.push_back(slice.file);
  return series;
}

/// Series numbers make short names; where two series share one, the UID names them.
void set_ids(std::vector<DicomSeries>& series, const std::vector<std::string>& numbers) {
  for (std::size_t s = 0; s < series.size(); ++s) {
    const auto same = std::count(numbers.begin(), numbers.end(), numbers[s]);
    series[s].id = same == 1 && !numbers[s].empty() ? numbers[s] : series[s].uid;
  }
}

std::string listing(const std::vector<DicomSeries>& series) {
  std::string text;
  for (const DicomSeries& one : series) text += "\n  " + describe(one);
  return text;
}

}  // namespace

std::vector<DicomSeries> list_dicom_series(const fs::path& folder) {
  if (!fs::is_directory(folder)) fail(ErrorCode::bad_file, folder.string(), " is not a folder");
  // a series with several echoes is several stacks; sorted by number, then identifier, then echo
  std::map<std::tuple<double, std::string, std::string>, std::vector<DicomSlice>> groups;
  for (DicomSlice& slice : read_headers(folder)) {
    const double number = std::atof(slice.series_number.c_str());
    groups[{number, slice.series_uid, slice.echo}].push_back(std::move(slice));
  }
  std::vector<DicomSeries> series;
  std::vector<std::string> numbers;
  for (auto& [key, slices] : groups) {
    const auto& [number, uid, echo] = key;
    const auto same_series = [&, n = number, u = uid](const auto& other) {
      return std::get<0>(other.first) == n && std::get<1>(other.first) == u;
    };
    const bool several_echoes = std::count_if(groups.begin(), groups.end(), same_series) > 1;
    const std::string suffix = several_echoes ? "-echo" + echo : "";
    numbers.push_back(slices.front().series_number + suffix);
    series.push_back(make_series(std::move(slices)));
    series.back().uid += suffix;
  }
  set_ids(series, numbers);
  return series;
}

std::vector<DicomSeries> series_holding(const std::vector<DicomSeries>& series,
                                        const Points& points) {
  std::vector<DicomSeries> holding;
  for (const DicomSeries& one : series) {
    bool all = one.usable();
    for (Eigen::Index i = 0; i < points.rows() && all; ++i) all = in_view(one.grid, points.row(i));
    if (all) holding.push_back(one);
  }
  return holding;
}

std::string describe(const DicomSeries& series) {
  const Volume& grid = series.grid;
  std::string text = join_text(
      "series ", series.id, series.description.empty() ? "" : " '" + series.description + "'", ": ",
      series.modality, ", ", series.files.size(), " slices of ", grid.size[0], "x", grid.size[1],
      ", voxel ", grid.spacing[0], "x", grid.spacing[1], "x", grid.spacing[2], " mm, centre LPS ",
      grid.position(0.5 * Vec3(grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1)).transpose());
  if (!series.usable()) text += "; not usable: " + series.problem;
  return text;
}

Volume read_series(const DicomSeries& series) {
  require(series.usable(), "DICOM series ", series.id, " cannot be read: ", series.problem,
          "; export that series again, whole and each slice once");
  Volume volume = series.grid;
  volume.direction = orthonormal_axes(volume.direction, "DICOM series " + series.id);
  volume.values.reserve(static_cast<std::size_t>(volume.n_voxels()));
  for (const fs::path& file : series.files) {
    const std::vector<float> pixels = read_dicom_pixels(file, volume.size[0], volume.size[1]);
    volume.values.insert(volume.values.end(), pixels.begin(), pixels.end());
  }
  check_volume(volume, "DICOM series " + series.id);
  return volume;
}

Volume read_dicom(const fs::path& folder, const std::optional<std::string>& selected) {
  const std::vector<DicomSeries> all = list_dicom_series(folder);
  if (all.empty()) fail(ErrorCode::bad_file, folder.string(), " holds no DICOM image");
  std::vector<DicomSeries> matching;
  for (const DicomSeries& one : all) {
    if (!selected || one.id == *selected || one.uid == *selected) matching.push_back(one);
  }
  require(!matching.empty(), folder.string(), " has no series ", selected.value_or(""), "; it has",
          listing(all));
  require(
      matching.size() == 1, folder.string(), " holds ", matching.size(),
      " series; select one of them by its id (--series, or series = \"…\" in the subject file):",
      listing(matching));
  return read_series(matching.front());
}

}  // namespace coxa::io
