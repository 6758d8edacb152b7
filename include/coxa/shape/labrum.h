#pragma once

#include <coxa/mesh/tri_mesh.h>
#include <coxa/shape/socket_rim.h>

#include <vector>

namespace coxa::shape {

struct LabrumOptions {
  double spacing = 1.2;  ///< mm, > 0, of the sections along the rim
  double seat = 0.05;    ///< mm, > 0, between labrum and bone or cartilage of the socket
  double gap = 0.1;      ///< mm, > 0, kept from the femoral head
};

/// A generic acetabular labrum: a ring of triangular section on the socket's edge, from one end of
/// the horseshoe of cartilage to the other, where the transverse ligament takes over.
///
/// Its base lies on the bone across the edge, its articular side follows the head, its free tip is
/// as far beyond the edge as published for the hour. Nothing of it is seen in any image.
/// @param hip_bone, cartilage  of a right hip, closed, LPS mm; cartilage is the acetabulum's
/// @param head  femur and femoral cartilage, or fewer: kept out of
/// @returns closed, outward surface
/// @throws Error bad_input if there is no socket, bad_mesh if the ring cannot be made valid
/// Source: Won et al. 2003 (heights at eight places), Tan et al. 2001; docs/shape.md
TriMesh make_labrum(const SocketRim& rim, const TriMesh& hip_bone, const TriMesh& cartilage,
                    const std::vector<TriMesh>& head, const LabrumOptions& options = {});

/// A generic transverse acetabular ligament: goes on across the notch from one end of the labrum to
/// the other, its section changing evenly between theirs. Arguments as of make_labrum.
TriMesh make_transverse_ligament(const SocketRim& rim, const TriMesh& hip_bone,
                                 const TriMesh& cartilage, const std::vector<TriMesh>& head,
                                 const LabrumOptions& options = {});

/// How far the free tip stands beyond the edge, mm.
double labrum_height(double hour);

}  // namespace coxa::shape
