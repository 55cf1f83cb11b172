// The subcommands of palpate-precompute, each in its own command_*.cc.
#pragma once

#include <string_view>

#include "formats/base/command_line.h"
#include "formats/mesh/surface_mesh.h"

namespace palpate {

void add_body_command(Command app);
void add_build_command(Command app);
void add_check_command(Command app);
void add_indent_command(Command app);
void add_pairs_command(Command app);
void add_plan_command(Command app);
void add_remesh_command(Command app);
void add_serve_command(Command app);
void add_spheres_command(Command app);
void add_submit_command(Command app);
void add_sweep_command(Command app);
void add_trade_command(Command app);

/// A line to stderr before work on a surface that may take a minute.
void tell_if_large(const SurfaceMesh& mesh, std::string_view file);

}  // namespace palpate
