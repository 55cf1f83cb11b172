#include <memory>
#include <string>

#include <fmt/format.h>

#include "formats/mesh/obj_writer.h"
#include "precompute/command/commands.h"
#include "precompute/surface/primitive_bodies.h"

namespace palpate {
namespace {

struct BodyFlags {
  std::string name;
  std::string output;
  int levels = 3;
};

void run_body(const BodyFlags& flags) {
  const SurfaceMesh mesh = organ(flags.levels);
  write_obj(mesh, flags.output,
            fmt::format("made by palpate-precompute body {} --levels {}", flags.name,
                        flags.levels));
  fmt::print("{}: {} vertices, {} triangles\n", flags.output, mesh.position_m.rows(),
             mesh.triangle.rows());
}

}  // namespace

void add_body_command(Command app) {
  const auto flags = std::make_shared<BodyFlags>();
  Command command =
      app.add_subcommand("body", "Writes a generated body's surface (OBJ, metres)");
  command.add_option("name", flags->name, "which body: organ")
      .required()
      .one_of({"organ"});
  command.add_option("-o,--output", flags->output, "OBJ file to write").required();
  command
      .add_option("--levels", flags->levels,
                  "fineness: 3 gives 642 vertices, each level more four times as many")
      .show_default();
  command.callback([flags] {
    run_body(*flags);
  });
}

}  // namespace palpate
