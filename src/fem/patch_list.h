#pragma once

#include <coxa/mesh/tet_mesh.h>

#include <cstdint>
#include <vector>

namespace coxa::fem {

/// Elements listed patch by patch.
struct PatchList {
  std::vector<std::int64_t> start{0};
  std::vector<Index> elements;
};

/// @param patch_of  patch of each element, 0 to n-1 without gaps   @throws Error bad_input
/// otherwise
PatchList list_patches(const std::vector<Index>& patch_of, Index n_elements);

/// The mesh with its elements in the order of the list, so that what is worked on together lies
/// together; without its facets.
TetMesh in_order_of(const PatchList& patches, const TetMesh& mesh);

}  // namespace coxa::fem
