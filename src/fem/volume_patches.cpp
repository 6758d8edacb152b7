#include <coxa/fem/mean_dilatation.h>

#include <algorithm>
#include <numeric>

#include "element_shape.h"

namespace coxa::fem {
namespace {

using Size = std::size_t;

constexpr Index kNone = -1;
constexpr int kSmallestStar = 6;  // fewer free elements than this around a node do not make a patch

std::vector<std::vector<Index>> elements_of_nodes(const TetMesh& mesh) {
  std::vector<std::vector<Index>> elements(static_cast<Size>(mesh.n_vertices()));
  for (Index e = 0; e < mesh.n_tets(); ++e)
    for (int a = 0; a < 4; ++a) elements[static_cast<Size>(mesh.tets(e, a))].push_back(e);
  return elements;
}

/// The patch that most elements around element e belong to, by shared nodes; the lowest number
/// where equal.
Index commonest_neighbour(const TetMesh& mesh, const std::vector<std::vector<Index>>& around,
                          const std::vector<Index>& patch_of, Index e) {
  std::vector<Index> near;
  for (int a = 0; a < 4; ++a)
    for (const Index other : around[static_cast<Size>(mesh.tets(e, a))])
      if (patch_of[static_cast<Size>(other)] != kNone)
        near.push_back(patch_of[static_cast<Size>(other)]);
  std::sort(near.begin(), near.end());
  Index best = kNone;
  std::ptrdiff_t most = 0;
  for (auto from = near.begin(); from != near.end();) {
    const auto to = std::upper_bound(from, near.end(), *from);
    if (to - from > most) {
      most = to - from;
      best = *from;
    }
    from = to;
  }
  return best;
}

}  // namespace

std::vector<Index> volume_patches(const TetMesh& mesh) {
  check_connectivity(mesh);
  std::vector<Index> patch_of(static_cast<Size>(mesh.n_tets()), kNone);
  if (nodes_per_element(mesh) == 10) {
    std::iota(patch_of.begin(), patch_of.end(), Index{0});
    return patch_of;
  }
  const auto around = elements_of_nodes(mesh);
  Index n_patches = 0;

  // whole stars first, then stars that others have bitten into, down to the smallest
  const auto free_count = [&](Size node) {
    return std::count_if(around[node].begin(), around[node].end(),
                         [&](Index e) { return patch_of[static_cast<Size>(e)] == kNone; });
  };
  for (const int share : {100, 75, 50}) {
    for (Size node = 0; node < around.size(); ++node) {
      const auto free = free_count(node);
      if (free < kSmallestStar ||
          100 * free < share * static_cast<std::ptrdiff_t>(around[node].size()))
        continue;
      for (const Index e : around[node])
        if (patch_of[static_cast<Size>(e)] == kNone) patch_of[static_cast<Size>(e)] = n_patches;
      ++n_patches;
    }
  }
  for (Index e = 0; e < mesh.n_tets(); ++e) {
    if (patch_of[static_cast<Size>(e)] != kNone) continue;
    const Index neighbour = commonest_neighbour(mesh, around, patch_of, e);
    patch_of[static_cast<Size>(e)] = neighbour == kNone ? n_patches++ : neighbour;
  }
  return patch_of;
}

}  // namespace coxa::fem
