#include <coxa/segment/share_tissue.h>

#include <coxa/core/error.h>
#include <coxa/mesh/measures.h>
#include <coxa/segment/label_parts.h>
#include <coxa/segment/muscle_labels.h>

#include <algorithm>
#include <cmath>

namespace coxa::segment {
namespace {

/// mm, of the samples that a surface goes through: a share of the cube root of the body's volume,
/// within bounds.
constexpr double kGridShare = 0.04, kFinestGrid = 0.7, kCoarsestGrid = 1.2;
/// Share of a body in view below which what the image shows of it is no muscle's worth: the model's
/// surface stays.
constexpr double kLeastShown = 0.2;
/// Overlap of a body's place with its label below which it is doubtful.
constexpr double kDoubtful = 0.6;

}  // namespace

std::vector<std::string> update_to_tissue(std::vector<Separable> muscles,
                                          const std::vector<const TriMesh*>& firm,
                                          const std::vector<TriMesh>& bones,
                                          const PreparedImage& image, const Monitor& monitor) {
  std::vector<TriMesh> bodies;
  for (const Separable& muscle : muscles) bodies.push_back(muscle.surface->mesh);
  const BodyLabels labels = muscle_labels(bodies, bones, image, {}, monitor);
  std::vector<std::string> doubtful;
  std::vector<Surface> before(muscles.size());
  for (std::size_t m = 0; m < muscles.size() && !labels.bodies.empty(); ++m) {
    monitor.check_cancelled();
    const LabelledBody& found = labels.bodies[m];
    if (found.in_view == 0) continue;
    const double spacing =
        std::clamp(kGridShare * std::cbrt(std::abs(volume(bodies[m]))), kFinestGrid, kCoarsestGrid);
    TriMesh mesh;
    if (found.shown() >= kLeastShown)
      mesh = label_surface(labels, static_cast<int>(m), bodies[m], spacing);
    if (mesh.n_vertices() == 0) {
      // all that the image shows goes to others first
      muscles[m].confirmed = -1.0;
      doubtful.push_back("low confidence: the image shows no " + muscles[m].name +
                         " where the model has it");
      continue;
    }
    if (found.overlap() < kDoubtful)
      doubtful.push_back(join_text("low confidence: the image shows ", muscles[m].name,
                                   " elsewhere than the model has it (overlap ",
                                   std::lround(100.0 * found.overlap()), " %)"));
    before[m] = std::move(*muscles[m].surface);
    muscles[m].surface->mesh = std::move(mesh);
    muscles[m].uneven = true;
    muscles[m].fields_of = &before[m];
  }
  for (std::string& text : update_separated(std::move(muscles), firm, monitor))
    doubtful.push_back(std::move(text));
  return doubtful;
}

}  // namespace coxa::segment
