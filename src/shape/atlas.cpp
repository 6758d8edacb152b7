#include <coxa/shape/atlas.h>

#include <coxa/core/error.h>

namespace coxa::shape {

const StructureModel& structure(const Atlas& atlas, const std::string& name) {
  std::string known;
  for (const StructureModel& model : atlas.structures) {
    if (model.name == name) return model;
    known += (known.empty() ? "" : ", ") + model.name;
  }
  fail(ErrorCode::bad_input, "the atlas has no structure \"", name, "\"; it has ",
       known.empty() ? "none" : known);
}

}  // namespace coxa::shape
