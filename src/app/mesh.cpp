#include <coxa/pipeline/mesh_stage.h>

#include "commands.h"

namespace coxa::app {
namespace {

struct MeshArguments {
  std::string surface, bone, method = "automatic", out;
  int layers = 0, order = 1;
  meshing::MeshingOptions options;
};

void run_mesh(const MeshArguments& arguments, Context& context) {
  pipeline::MeshRequest request{arguments.surface, arguments.bone, arguments.options};
  if (arguments.method == "medial") request.options.method = meshing::Method::medial;
  if (arguments.method == "lattice") request.options.method = meshing::Method::lattice;
  if (arguments.order == 2) request.options.order = meshing::ElementOrder::ten_node;
  if (arguments.layers > 0) request.options.layers = arguments.layers;
  const auto record = pipeline::run_mesh_file(request, arguments.out, context.monitor());
  context.print_result(arguments.out, record);
}

}  // namespace

void add_mesh(CLI::App& app, Context& context) {
  auto* verb = app.add_subcommand("mesh", "tetrahedra from a closed surface");
  auto arguments = std::make_shared<MeshArguments>();
  verb->add_option("--surface", arguments->surface, "closed surface: PLY, STL, OBJ or VTP, mm")
      ->required()
      ->check(CLI::ExistingFile);
  verb->add_option("--bone", arguments->bone,
                   "surface of the bone it lies on, to tag the bone side")
      ->check(CLI::ExistingFile);
  verb->add_option("--method", arguments->method,
                   "how: by the medial sheet of a thin body, or from a lattice for any body")
      ->check(CLI::IsMember({"automatic", "medial", "lattice"}));
  verb->add_option(
          "--tets", arguments->options.max_tets,
          "largest number of tetrahedra; by default 20000 for a sheet, 45000 for each of several "
          "layers, 200000 from a lattice")
      ->check(CLI::PositiveNumber);
  verb->add_option("--layers", arguments->layers, "layers through the thickness, 1 to 8")
      ->check(CLI::Range(1, 8));
  verb->add_option("--order", arguments->order,
                   "1: four-node elements, 2: ten-node ones with a curved boundary")
      ->check(CLI::Range(1, 2));
  verb->add_option("--out", arguments->out, "VTU, Gmsh .msh, CalculiX .inp or FEBio .feb")
      ->required();
  verb->callback([arguments, &context] { run_mesh(*arguments, context); });
}

}  // namespace coxa::app
