#pragma once

#include <coxa/collide/surface_contact.h>

#include <vector>

namespace coxa::collide {

/// Samples of the part of the slave surface that the other surface covers, seen along the slave's
/// facet normals: each facet is cut along the edges of the other surface's triangles, so that
/// polynomials on either surface are smooth over a piece, and every piece has three points.
///
/// Only triangles that look the other way within `search_distance` along the normal count; a part
/// that the other surface covers twice would be sampled twice.
/// @param normals  of the slave's facets, unit
/// @returns ascending by triangle; `triangle`, `barycentric` and `area` are set
std::vector<ContactSample> cut_samples(const TriMesh& slave, const Points& normals,
                                       const TriangleTree& other, double search_distance);

}  // namespace coxa::collide
