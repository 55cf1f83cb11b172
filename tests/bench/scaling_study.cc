// Fits and draws what scaling.sh measured.
//
// scaling_study TABLE.csv PICTURE.svg
//
// TABLE has a header, then lines of nodes, tets, seconds, bytes; fitted are powers,
// y = c x^p, by least squares of the logarithms.
#include <cmath>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "formats/report/log_plot.h"

namespace palpate {
namespace {

struct Run {
  double nodes = 0.0;
  double tets = 0.0;
  double seconds = 0.0;
  double bytes = 0.0;
};

std::vector<Run> read_runs(const std::string& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  std::vector<Run> runs;
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    Run run;
    char comma = 0;
    if (!(fields >> run.nodes >> comma >> run.tets >> comma >> run.seconds >> comma >>
          run.bytes) ||
        !(run.nodes > 0 && run.tets > 0 && run.seconds > 0 && run.bytes > 0)) {
      throw std::runtime_error(fmt::format(
          "{}: \"{}\": four positive numbers are wanted: nodes, tets, seconds, bytes",
          file, line));
    }
    runs.push_back(run);
  }
  if (runs.size() < 2) {
    throw std::runtime_error(
        fmt::format("{}: {} runs, at least 2 are needed", file, runs.size()));
  }
  return runs;
}

// The power p that y grows with x as.
double exponent(const std::vector<Run>& runs, double Run::*x, double Run::*y) {
  double x_mean = 0.0;
  double y_mean = 0.0;
  for (const Run& run : runs) {
    x_mean += std::log(run.*x) / static_cast<double>(runs.size());
    y_mean += std::log(run.*y) / static_cast<double>(runs.size());
  }
  double xx = 0.0;
  double xy = 0.0;
  for (const Run& run : runs) {
    xx += (std::log(run.*x) - x_mean) * (std::log(run.*x) - x_mean);
    xy += (std::log(run.*x) - x_mean) * (std::log(run.*y) - y_mean);
  }
  return xy / xx;
}

void study(const std::string& table, const std::string& file) {
  const std::vector<Run> runs = read_runs(table);
  const double time_nodes = exponent(runs, &Run::nodes, &Run::seconds);
  const double time_tets = exponent(runs, &Run::tets, &Run::seconds);
  const double memory_nodes = exponent(runs, &Run::nodes, &Run::bytes);
  const double memory_tets = exponent(runs, &Run::tets, &Run::bytes);
  fmt::print("time   grows as nodes^{:.2f}, tets^{:.2f}\n", time_nodes, time_tets);
  fmt::print("memory grows as nodes^{:.2f}, tets^{:.2f}\n", memory_nodes, memory_tets);
  LogPicture picture{
      .title = "Linear build at all nodes of an organ",
      .subtitle = "one mesh for all nodes; the same body and tool, finer and finer",
      .x_name = "number",
      .y_name = "CPU seconds, megabytes",
      .series = {{fmt::format("time, nodes^{:.2f}", time_nodes), {}, true},
                 {fmt::format("time, tets^{:.2f}", time_tets), {}, true},
                 {fmt::format("memory, nodes^{:.2f}", memory_nodes), {}, true},
                 {fmt::format("memory, tets^{:.2f}", memory_tets), {}, true}},
      .level = 0.0,
      .level_name = ""};
  for (const Run& run : runs) {
    picture.series[0].point.push_back({.x = run.nodes, .y = run.seconds});
    picture.series[1].point.push_back({.x = run.tets, .y = run.seconds});
    picture.series[2].point.push_back({.x = run.nodes, .y = 1e-6 * run.bytes});
    picture.series[3].point.push_back({.x = run.tets, .y = 1e-6 * run.bytes});
  }
  std::ofstream out(file);
  out << log_picture(picture);
  if (!out.flush()) {
    throw std::runtime_error(fmt::format("{}: cannot be written", file));
  }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  if (argc != 3) {
    fmt::print(stderr, "usage: scaling_study TABLE.csv PICTURE.svg\n");
    return EXIT_FAILURE;
  }
  try {
    palpate::study(argv[1], argv[2]);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    fmt::print(stderr, "scaling_study: {}\n", error.what());
    return EXIT_FAILURE;
  }
}
