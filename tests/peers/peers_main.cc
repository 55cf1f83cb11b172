// The benchmark: renderers on scenes, one table. README.md is its page.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "formats/base/command_line.h"
#include "formats/base/error.h"
#include "tests/peers/peer_table.h"

namespace palpate::peers {
namespace {

namespace fs = std::filesystem;

struct Flags {
  std::vector<std::string> scene;
  std::vector<std::string> renderer;
  std::string output = "peers";
  std::vector<std::string> stability;
  bool forces_only = false;
};

void write(const fs::path& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  if (!out.flush()) {
    throw InputError(fmt::format("{}: cannot be written", file.string()));
  }
}

void run(const Flags& flags) {
  std::vector<Renderer> renderers;
  for (const std::string& library : flags.renderer) {
    renderers.push_back(load_renderer(library));
  }
  std::vector<PeerRow> rows;
  for (const std::string& folder : flags.scene) {
    const PeerScene scene = read_peer_scene(folder);
    const auto& leant_on = flags.stability;
    const MeasureOptions options{
        .stability = !flags.forces_only &&
                     (leant_on.empty() || std::find(leant_on.begin(), leant_on.end(),
                                                    scene.name) != leant_on.end()),
        .times = !flags.forces_only};
    if (const auto truth = true_raster(scene)) {
      rows.push_back(*truth);
    }
    for (const Renderer& renderer : renderers) {
      fmt::print(stderr, "{}: {}\n", scene.name, renderer.name);
      const auto more = measure(renderer, scene, options);
      rows.insert(rows.end(), more.begin(), more.end());
    }
  }
  const fs::path out = flags.output;
  fs::create_directories(out);
  const std::string table = table_markdown(rows) + nodule_markdown(rows);
  write(out / "table.md", table);
  write(out / "table.csv", table_csv(rows));
  write(out / "picture.svg", table_picture(rows));
  for (const std::string& scene : scenes_of(rows)) {
    if (const std::string svg = spectrum_picture(rows, scene); !svg.empty()) {
      write(out / fmt::format("spectrum-{}.svg", scene), svg);
    }
  }
  fmt::print("{}", table);
}

void add_measure_command(Command app) {
  Command command = app.add_subcommand("measure", "Measures renderers on scenes");
  auto flags = std::make_shared<Flags>();
  command.add_option("scene", flags->scene, "Folders of scenes").required();
  command.add_option("--renderer", flags->renderer, "Shared library (again for more)")
      .required()
      .one_value_each();
  command.add_option("-o,--output", flags->output,
                     "Folder for table.md, table.csv and pictures");
  command
      .add_option("--stability", flags->stability,
                  "Name of a scene on which devices lean (again for more); default: "
                  "all")
      .one_value_each();
  command.add_flag("--forces-only", flags->forces_only,
                   "No stability and no times: quick, and the same bits every time");
  command.callback([flags] {
    run(*flags);
  });
}

}  // namespace
}  // namespace palpate::peers

int main(int argc, char** argv) {
  return palpate::run_tool("peers_bench", "Compares renderers of contact forces.",
                           {palpate::peers::add_measure_command}, argc, argv);
}
