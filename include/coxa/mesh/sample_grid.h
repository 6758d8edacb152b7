#pragma once

#include <coxa/core/parallel.h>
#include <coxa/core/types.h>

#include <array>

namespace coxa {

/// A regular grid of samples parallel to the axes; x fastest.
struct SampleGrid {
  std::array<Index, 3> size{};
  Vec3 origin = Vec3::Zero();  ///< mm, of the first sample
  double spacing = 1.0;        ///< mm

  std::size_t offset(Index i, Index j, Index k) const {
    return static_cast<std::size_t>(i) +
           static_cast<std::size_t>(size[0]) *
               (static_cast<std::size_t>(j) +
                static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(k));
  }
  std::size_t n() const { return offset(0, 0, size[2]); }
  Vec3 position(const Vec3& index) const { return origin + spacing * index; }
  Vec3 index(const Vec3& position) const { return (position - origin) / spacing; }
  /// Calls body(offset, position) for every sample, in parallel.
  template <class Body>
  void for_samples(const Body& body) const {
    parallel_for(size[2], [&](Index k) {
      for (Index j = 0; j < size[1]; ++j)
        for (Index i = 0; i < size[0]; ++i) body(offset(i, j, k), position(Vec3(i, j, k)));
    });
  }
};

}  // namespace coxa
