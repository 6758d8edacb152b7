#pragma once

#include <coxa/fem/mean_dilatation.h>

#include <memory>
#include <vector>

#include "element_assembly.h"
#include "patch_list.h"

namespace coxa::fem {

/// A measure of volume change, averaged over patches of elements, with its derivatives by the
/// particles of each patch (its slots).
class PatchMeasure {
 public:
  /// The elements' own law, worked out in the same pass as the measure.
  struct Beside {
    const Material* law;
    Vec3* force;  ///< of the patch's slots, added to, N
    double energy = 0.0;
  };

  PatchMeasure(const TetMesh& mesh, const std::vector<Index>& patch_of, ParticleMap map,
               Dilatation dilatation);

  Index n_patches() const { return static_cast<Index>(patches_.start.size()) - 1; }
  /// Calls body(place in the list) for the elements of a patch.
  template <class Body>
  void each_element(Index patch, const Body& body) const {
    for (auto k = patches_.start[static_cast<std::size_t>(patch)];
         k < patches_.start[static_cast<std::size_t>(patch) + 1]; ++k)
      body(static_cast<Index>(k));
  }
  /// Number in the mesh of the element at a place in the list.
  Index element(Index place) const { return patches_.elements[static_cast<std::size_t>(place)]; }
  double rest_volume(Index patch) const {
    return rest_volume_[static_cast<std::size_t>(patch)];
  }  ///< mm³
  const Material& measure() const { return *measure_; }
  const ElementAssembly& assembly() const { return assembly_; }  ///< in the order of the list
  void set_offsets(const Points& offset) { assembly_.set_offsets(offset); }
  const Scatter& scatter() const { return scatter_; }

  /// Mean of the measure over the patch.
  double mean(const VecX& x, Index patch) const;
  /// The same; sets the gradient of mean times rest volume by the patch's slots.
  /// @param beside  null: none
  double mean_with_gradient(const VecX& x, Index patch, Vec3* gradient,
                            Beside* beside = nullptr) const;
  /// Adds factor times the second derivative of mean times rest volume.
  void add_curvature(const VecX& x, Index patch, double factor, Mat3* blocks) const;

 private:
  void find_slots();
  int slot(Index e, int a) const {
    return slot_of_corner_[static_cast<std::size_t>(e) *
                               static_cast<std::size_t>(assembly_.n_nodes()) +
                           static_cast<std::size_t>(a)];
  }
  double mean_in_lanes(const VecX& x, Index patch, Vec3* gradient, Beside* beside) const;

  PatchList patches_;
  ElementAssembly assembly_;
  bool measures_stretch_;  // whose slope is the rotation
  std::unique_ptr<const Material> measure_;
  std::vector<double> rest_volume_;  // of each patch, mm³
  std::vector<int> slot_of_corner_;  // per listed element and node
  Scatter scatter_;
};

}  // namespace coxa::fem
