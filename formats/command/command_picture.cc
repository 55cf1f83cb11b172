#include <algorithm>
#include <memory>
#include <span>
#include <string>

#include <fmt/format.h>

#include "formats/base/atomic_file.h"
#include "formats/command/commands.h"
#include "formats/database/response_database.h"
#include "formats/report/surface_picture.h"

namespace palpate {
namespace {

struct PictureFlags {
  std::string file;
  std::string output;
  std::string tool;
  std::string shown{kShownNames.front()};
};

Shown shown_by(const std::string& name) {
  const auto at = std::find(kShownNames.begin(), kShownNames.end(), name);
  return static_cast<Shown>(at - kShownNames.begin());
}

void run_picture(const PictureFlags& flags) {
  const ResponseDatabase database = read_database(flags.file);
  const std::string svg =
      surface_picture(database, find_tool(database, flags.tool), shown_by(flags.shown));
  AtomicFile atomic(flags.output);
  atomic.write(std::as_bytes(std::span(svg)));
  atomic.commit();
  fmt::print("wrote {} ({} bytes)\n", flags.output, svg.size());
}

}  // namespace

void add_picture_command(Command app) {
  Command command = app.add_subcommand(
      "picture", "Draw the body in colours and a few curves as an SVG picture");
  auto flags = std::make_shared<PictureFlags>();
  command.add_option("file", flags->file, "Response database (HDF5 or flat)")
      .required();
  command.add_option("-o,--output", flags->output, "Picture to write (SVG)").required();
  command.add_option("--tool", flags->tool, "Tool, if the database holds several");
  command
      .add_option(
          "--show", flags->shown,
          "Colours: stiffness, share of a held force that relaxes, mean time in which "
          "it does, share of a press that stays as a dent, or by how much it softens")
      .one_of({kShownNames.begin(), kShownNames.end()})
      .show_default();
  command.callback([flags] {
    run_picture(*flags);
  });
}

}  // namespace palpate
