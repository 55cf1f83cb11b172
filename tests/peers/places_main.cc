// peers_places: how far off the field of a database is between its nodes.
#include <filesystem>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "formats/base/command_line.h"
#include "formats/hdf5/hdf5_lock.h"
#include "tests/peers/field_places.h"

namespace palpate::peers {
namespace {

void add_measure(Command app) {
  struct Flags : PlacesOptions {
    std::filesystem::path scene;
    std::vector<std::string> database;
  };
  Command command = app.add_subcommand(
      "measure", "Presses random places of a scene, and compares the stored field");
  auto flags = std::make_shared<Flags>();
  command.add_option("scene", flags->scene, "Scene (TOML)").required();
  command.add_option("database", flags->database, "Built from it (HDF5), one or more")
      .required();
  command.add_option("--places", flags->places, "of the surface")
      .show_default()
      .in_range(1, 100000);
  command.add_option("--finer", flags->times_finer, "than the budget asks for")
      .show_default()
      .in_range(0.5, 16.0);
  command.add_option("--seed", flags->seed, "of the places").show_default();
  command.add_option("--rows", flags->rows, "file for one line a place");
  command.callback([flags] {
    const Scene scene = read_scene(flags->scene);
    std::vector<ResponseDatabase> databases;
    for (const auto& file : flags->database) {
      databases.push_back(read_database(file));
    }
    const auto reports = measure_places(scene, databases, *flags);
    for (std::size_t i = 0; i < reports.size(); ++i) {
      fmt::print("{}\n{}", flags->database[i], table_text(reports[i]));
    }
  });
}

}  // namespace
}  // namespace palpate::peers

int main(int argc, char** argv) {
  using namespace palpate;
  return run_tool("peers_places", "Measures the field between nodes.",
                  {&peers::add_measure}, argc, argv);
}
