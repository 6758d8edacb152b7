#pragma once

#include "sheet_grid.h"

#include <coxa/medial/face_pair.h>

namespace coxa::medial {

/// Radial forces: every node to the middle between the faces, border nodes to the rim.
void update_centred(SheetGrid& grid, const FacePair& faces);

/// The sheet the faces start from, in the middle between them.
SheetGrid starting_grid(const FacePair& faces);

}  // namespace coxa::medial
