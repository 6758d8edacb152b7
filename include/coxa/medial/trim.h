#pragma once

#include <coxa/core/types.h>
#include <coxa/mesh/tri_mesh.h>

#include <optional>
#include <vector>

namespace coxa::medial {

class FacePair;

/// What of a sheet's border is too thin or too narrow to be filled with good elements.
struct TrimOptions {
  double thickness = 0.3;    ///< mm, > 0: a thinner zone goes …
  double width = 0.4;        ///< mm, >= 0: … and a tongue narrower than twice this …
  double margin = 0.8;       ///< mm, > 0: … but for a seam of this width, which knife edges keep
  double least_depth = 1.5;  ///< mm, >= 0: zones that reach less far beyond that seam stay
};

/// A sheet with its thin border zones cut away.
struct TrimmedSheet {
  TriMesh sheet;          ///< in the middle between the faces, seen from the second face, mm
  std::vector<char> cut;  ///< per node: 1 on the border where something was cut away
  double area = 0.0;      ///< mm², cut away
  double depth = 0.0;     ///< mm: how far the border moved inwards, at most
};

/// Cuts zones thinner and tongues narrower than the options say off the border of the sheet
/// between two faces; thin places further inside stay. nullopt where nothing is to be cut, or
/// nothing would be left.
/// @note deterministic; serial
std::optional<TrimmedSheet> trimmed_sheet(const FacePair& faces, const TrimOptions& options = {});

}  // namespace coxa::medial
