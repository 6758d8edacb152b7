// Tetrahedra of CGAL's Mesh_3 with all of its optimisers, for tools/compare_meshers.py: a program
// of its own, never linked with coxa.
//
// usage: cgal_mesher SURFACE.off EDGE_MM DISTANCE_MM RIDGE_DEGREES OUT.mesh
//
// Edges where the surface bends by more than RIDGE_DEGREES are kept as edges of the mesh; 180:
// none.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Polyhedral_mesh_domain_with_features_3.h>
#include <CGAL/make_mesh_3.h>

#include <cstdlib>
#include <fstream>
#include <iostream>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Polyhedron = CGAL::Mesh_polyhedron_3<Kernel>::type;
using Domain = CGAL::Polyhedral_mesh_domain_with_features_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation, Domain::Corner_index,
                                                        Domain::Curve_index>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

int main(int argc, char** argv) {
  if (argc != 6) {
    std::cerr << "usage: cgal_mesher SURFACE.off EDGE_MM DISTANCE_MM RIDGE_DEGREES OUT.mesh\n";
    return 2;
  }
  Polyhedron surface;
  std::ifstream(argv[1]) >> surface;
  if (surface.empty()) {
    std::cerr << argv[1] << ": no closed surface\n";
    return 3;
  }
  const double edge = std::atof(argv[2]), distance = std::atof(argv[3]);
  Domain domain(surface);
  if (const double ridge = std::atof(argv[4]); ridge < 180.0) domain.detect_features(ridge);
  namespace p = CGAL::parameters;
  const Criteria criteria(p::edge_size = edge, p::facet_angle = 25, p::facet_size = edge,
                          p::facet_distance = distance, p::cell_radius_edge_ratio = 2,
                          p::cell_size = edge);
  // odt, perturb and exude: the best settings tried on cartilage
  Complex mesh =
      CGAL::make_mesh_3<Complex>(domain, criteria, p::no_lloyd(), p::odt(p::time_limit = 60),
                                 p::perturb(p::time_limit = 60), p::exude(p::time_limit = 60));
  std::ofstream out(argv[5]);
  mesh.output_to_medit(out);
  return 0;
}
