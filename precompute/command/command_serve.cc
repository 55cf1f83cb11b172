// palpate-precompute serve: responses while they are computed, nearest to the hand
// first.
#include <cstdlib>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

#include "formats/base/command_line.h"
#include "formats/base/error.h"
#include "formats/service/service_socket.h"
#include "precompute/command/commands.h"
#include "precompute/process/end_with.h"
#include "precompute/process/interrupt.h"
#include "precompute/process/supervised_build.h"
#include "precompute/serve/serve.h"

namespace palpate {
namespace {

constexpr int kNicer = 10;  // a hand's forces come first

struct ServeFlags {
  std::string scene;
  std::string output;
  std::string socket;
  std::string repair = "off";
  std::string precision;
  int workers = 0;
  double patience_s = ServeOptions{}.patience_s;
  int with = 0;
  bool anew = false;
};

// @returns an exit code.
int run_serve(const ServeFlags& flags, bool after_crash) {
  note_interrupts();
  if (flags.with > 0) {
    end_with(flags.with);
  }
  const Scene scene = read_scene(flags.scene);
  ServeOptions options{.output = flags.output,
                       .socket = flags.socket,
                       .repair = repair_mode(flags.repair),
                       .workers = flags.workers,
                       .anew = flags.anew && !after_crash,
                       .patience_s = flags.patience_s};
  if (options.output.empty()) {
    options.output = std::filesystem::path(flags.scene).stem().string() + ".h5";
  }
  if (options.socket.empty()) {
    options.socket = service_socket(options.output);
  }
  if (!flags.precision.empty()) {
    options.precision = precision_of(flags.precision);
  }
  fmt::print(stderr, "answers at {}\n", options.socket.string());
  Progress progress(stderr);
  try {
    serve(scene, options, progress);
  } catch (const Interrupted& ended) {  // as services usually end: no error
    fmt::print(stderr, "ended; what is done so far is kept in {}.partial\n",
               options.output.string());
    return ended.exit_code();
  }
  fmt::print("wrote {}\n", options.output.string());
  return 0;
}

}  // namespace

void add_serve_command(Command app) {
  Command command = app.add_subcommand(
      "serve",
      "Compute a scene's responses where a hand needs them first, and hand them out "
      "meanwhile: palpate-run view SCENE.toml");
  auto flags = std::make_shared<ServeFlags>();
  command.add_option("scene", flags->scene, "Scene file (TOML)").required();
  command.add_option("-o,--output", flags->output,
                     "Response database to write (HDF5); by default the scene's name "
                     "with .h5, in this folder. What is done so far is in "
                     "OUTPUT.partial, from where it goes on");
  command.add_option("--socket", flags->socket,
                     "Where others join; by default OUTPUT.socket");
  command
      .add_option("--threads", flags->workers,
                  "Threads; 0: one for each core. The result does not depend on it")
      .in_range(0, 1024);
  command
      .add_option(
          "--patience-s", flags->patience_s,
          "Seconds to wait for memory, processes or room on the disk; then exit "
          "code 75")
      .not_negative();
  command.add_option("--repair", flags->repair,
                     "off, safe or wrap: mend the body's surface first");
  command.add_option("--precision", flags->precision,
                     "float64, float32 or int16, as of build");
  command.add_option("--with", flags->with,
                     "End, keeping what is done, when the process of that id does");
  command.add_flag("--anew", flags->anew,
                   "Drop what was computed for another scene in OUTPUT.partial");
  command.callback([flags] {
    (void)nice(kNicer);
    const auto work = [&](bool after_crash) {
      return run_reporting("palpate-precompute", [&] {
        return run_serve(*flags, after_crash);
      });
    };
    const int code = run_supervised(work, "the same command");
    if (code != 0) {  // said by the child
      std::_Exit(code);
    }
  });
}

}  // namespace palpate
