#include "patch_list.h"

#include <coxa/core/error.h>

#include <algorithm>

namespace coxa::fem {

using Size = std::size_t;

PatchList list_patches(const std::vector<Index>& patch_of, Index n_elements) {
  require(static_cast<Index>(patch_of.size()) == n_elements, "patches are given for ",
          patch_of.size(), " of ", n_elements, " elements");
  const Index n = patch_of.empty() ? 0 : *std::max_element(patch_of.begin(), patch_of.end()) + 1;
  std::vector<std::int64_t> count(static_cast<Size>(n), 0);
  for (const Index patch : patch_of) {
    require(patch >= 0, "an element belongs to patch ", patch);
    ++count[static_cast<Size>(patch)];
  }
  PatchList list;
  for (Index patch = 0; patch < n; ++patch) {
    require(count[static_cast<Size>(patch)] > 0, "patch ", patch, " has no element");
    list.start.push_back(list.start.back() + count[static_cast<Size>(patch)]);
  }
  list.elements.resize(patch_of.size());
  std::vector<std::int64_t> next(list.start.begin(), list.start.end() - 1);
  for (Size e = 0; e < patch_of.size(); ++e)
    list.elements[static_cast<Size>(next[static_cast<Size>(patch_of[e])]++)] =
        static_cast<Index>(e);
  return list;
}

TetMesh in_order_of(const PatchList& patches, const TetMesh& mesh) {
  TetMesh ordered;
  ordered.points = mesh.points;
  ordered.tets = mesh.tets(patches.elements, Eigen::all);
  if (mesh.mid_nodes.rows() > 0) ordered.mid_nodes = mesh.mid_nodes(patches.elements, Eigen::all);
  return ordered;
}

}  // namespace coxa::fem
