// palpate-db slice: a part of a database, by region, tool, depth and precision.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/command/commands.h"
#include "formats/database/database_slice.h"

namespace palpate {
namespace {

struct SliceFlags {
  std::string file;
  std::string output;
  std::vector<std::string> tools;
  std::vector<double> box_m;
  double depth_max_m = 0.0;
  std::string precision;
  std::string compress;
  std::int64_t chunk_nodes = 0;
  bool json = false;
};

SliceOptions options_of(const SliceFlags& flags) {
  SliceOptions options;
  options.tools = flags.tools;
  if (flags.box_m.size() == 6) {
    const auto& b = flags.box_m;
    options.box_m.emplace(Eigen::Vector3d(b[0], b[1], b[2]),
                          Eigen::Vector3d(b[3], b[4], b[5]));
  }
  if (flags.depth_max_m != 0.0) {
    options.depth_max_m = flags.depth_max_m;
  }
  return options;
}

void set_storage(const SliceFlags& flags, StorageOptions& storage) {
  if (!flags.precision.empty()) {
    storage.precision = precision_of(flags.precision);
  }
  if (!flags.compress.empty()) {
    storage.compress = flags.compress == "deflate";
  }
  if (flags.chunk_nodes != 0) {
    storage.chunk_nodes = flags.chunk_nodes;
  }
}

void run_slice(const SliceFlags& flags) {
  ResponseDatabase part = slice(read_database(flags.file), options_of(flags));
  set_storage(flags, part.storage);
  write_database(flags.output, part);
  const std::uintmax_t bytes = std::filesystem::file_size(flags.output);
  if (flags.json) {
    const nlohmann::ordered_json report = {{"output", flags.output},
                                           {"nodes", part.body.position_m.rows()},
                                           {"triangles", part.body.triangle.rows()},
                                           {"tools", part.tools.size()},
                                           {"bytes", bytes}};
    fmt::print("{}\n", json_text(report));
  } else {
    fmt::print("wrote {}: {} nodes, {} tools, {} bytes\n", flags.output,
               part.body.position_m.rows(), part.tools.size(), bytes);
  }
}

}  // namespace

void add_slice_command(Command app) {
  Command command =
      app.add_subcommand("slice", "Write a part of a database, or store it otherwise");
  auto flags = std::make_shared<SliceFlags>();
  command.add_option("file", flags->file, "Response database (HDF5 or flat)")
      .required();
  command.add_option("-o,--output", flags->output, "Database to write").required();
  command.add_option("--tool", flags->tools, "Tool to keep; may be repeated");
  command.add_option("--box-m", flags->box_m, "Region: x y z of both corners [m]")
      .values(6);
  command.add_option("--depth-max-m", flags->depth_max_m, "Cut curves at this depth")
      .positive();
  command.add_option("--precision", flags->precision, "float64, float32 or int16");
  command.add_option("--compression", flags->compress, "none or deflate")
      .one_of({"none", "deflate"});
  command.add_option("--chunk-nodes", flags->chunk_nodes, "Nodes per chunk")
      .in_range(std::int64_t{1}, kLargestChunkNodes);
  command.add_flag("--json", flags->json, "Print the report as one JSON object");
  command.callback([flags] {
    run_slice(*flags);
  });
}

}  // namespace palpate
