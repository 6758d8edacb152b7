#pragma once

#include <coxa/segment/profile_search.h>
#include <coxa/segment/separate_bodies.h>

namespace coxa::segment {

/// Gives muscles the surfaces of the tissue that the image shows them to have (`muscle_labels`),
/// and takes their overlaps away (`update_separated`). A muscle of which the image shows too little
/// stays as it is and gives way to all others.
/// @param firm nothing enters these   @param bones those of them beside which muscle lies
/// @returns a text for each that lay elsewhere for the most part or is not shown
std::vector<std::string> update_to_tissue(std::vector<Separable> muscles,
                                          const std::vector<const TriMesh*>& firm,
                                          const std::vector<TriMesh>& bones,
                                          const PreparedImage& image, const Monitor& monitor = {});

}  // namespace coxa::segment
