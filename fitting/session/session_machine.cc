#include "fitting/session/session_machine.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "fitting/session/session_runs.h"
#include "formats/base/named_message.h"
#include "formats/base/units.h"
#include "formats/measurement/column_name.h"
#include "formats/measurement/delimited_text.h"
#include "formats/scene/toml_section.h"

namespace palpate {
namespace session_parts {
namespace {

constexpr std::string_view kPairColumns[] = {
    "name", "machine_x", "machine_y", "machine_z", "mesh_x", "mesh_y", "mesh_z"};

// Where the pairs' columns are, in the order of kPairColumns.
struct PairTable {
  std::string file;
  char delimiter = ',';
  std::vector<std::size_t> column;
};

PairTable find_pair_columns(const std::string& file, const TextLine& header) {
  for (const char delimiter : {'\t', ';', ','}) {
    PairTable table{file, delimiter, {}};
    const auto cells = split_cells(header.text, delimiter);
    for (const std::string_view name : kPairColumns) {
      const auto matches = matching_columns(cells, name);
      if (matches.size() == 1) {
        table.column.push_back(matches[0]);
      }
    }
    if (table.column.size() == std::size(kPairColumns)) {
      return table;
    }
  }
  throw InputError(fmt::format("{}: line {} must name the columns {}", file,
                               header.number, fmt::join(kPairColumns, ", ")));
}

RegistrationPair read_pair(const PairTable& table, const TextLine& line,
                           double metres) {
  const auto cells = split_cells(line.text, table.delimiter);
  double value[6];
  for (std::size_t k = 1; k < table.column.size(); ++k) {
    const std::string text =
        table.column[k] < cells.size() ? cells[table.column[k]] : "";
    const auto number = parse_number(text, table.delimiter != ',');
    if (!number || !std::isfinite(*number)) {
      throw FormatError(
          fmt::format("{}: line {}, column \"{}\": \"{}\" is not a finite number",
                      table.file, line.number, kPairColumns[k], text));
    }
    value[k - 1] = metres * *number;
  }
  const std::string name = table.column[0] < cells.size() ? cells[table.column[0]] : "";
  return {name, Eigen::Vector3d(value), Eigen::Vector3d(value + 3)};
}

}  // namespace

void read_machine(const SceneSection& section, Session& session) {
  SessionMachine& machine = session.machine;
  constexpr std::string_view kOne[] = {"frame_stiffness_n_per_m", "frame_run"};
  if (section.only_one_of(kOne) == "frame_run") {
    machine.frame_run = beside(session, section.text("frame_run"));
    if (section.find("frame_stiffness_sd_n_per_m") != nullptr) {
      section.fail(section.need("frame_stiffness_sd_n_per_m"),
                   "frame_stiffness_sd_n_per_m in {} goes with "
                   "frame_stiffness_n_per_m; that of a run follows from the run",
                   section.title());
    }
    return;
  }
  machine.frame_stiffness_n_per_m =
      section.number("frame_stiffness_n_per_m", kPositive);
  if (section.find("frame_stiffness_sd_n_per_m") != nullptr) {
    machine.frame_stiffness_sd_n_per_m =
        section.number("frame_stiffness_sd_n_per_m", kNotNegative);
  }
}

void read_registration(const SceneSection& section, Session& session) {
  const std::string file = beside(session, section.text("pairs")).string();
  const double metres = metres_per(section.text("length_unit"));
  const auto lines = read_text_lines(file);
  if (lines.empty()) {
    throw InputError(fmt::format("{}: is empty, must be a table of pairs", file));
  }
  const PairTable table = find_pair_columns(file, lines.front());
  std::vector<RegistrationPair> pairs;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    pairs.push_back(read_pair(table, lines[i], metres));
  }
  try {
    session.registration = register_rigidly(std::move(pairs));
  } catch (const InputError& error) {
    throw InputError(with_name(file, error.what()));
  }
  for (SessionRun& run : session.run) {
    if (run.position_m) {
      run.position_m = session.registration->to_mesh_m(*run.position_m);
    }
    if (run.normal) {
      run.normal = session.registration->rotation * *run.normal;
    }
  }
}

CycleChoice read_cycle(const SceneSection& section) {
  const toml::node& node = section.need("cycle");
  const auto number = node.value_exact<std::int64_t>();
  try {
    return parse_cycle(number ? std::to_string(*number) : section.text("cycle"));
  } catch (const InputError& error) {
    section.fail(node, "{} ({})", error.what(), section.title());
  }
}

}  // namespace session_parts

std::optional<FrameRun> session_frame(const Session& session) {
  const SessionMachine& machine = session.machine;
  if (!machine.frame_run.empty()) {
    SessionRun run;
    run.file = machine.frame_run;
    run.name = machine.frame_run.string();
    const MeasurementFile file = read_run(session, run);
    try {
      return frame_of_run(file.samples);
    } catch (const InputError& error) {
      throw InputError(with_name(run.name, error.what()));
    }
  }
  if (machine.frame_stiffness_n_per_m > 0.0) {
    FrameRun stated;
    stated.frame = linear_frame(machine.frame_stiffness_n_per_m,
                                machine.frame_stiffness_sd_n_per_m);
    return stated;
  }
  return std::nullopt;
}

std::string describe_frame(const std::optional<FrameRun>& run) {
  if (!run) {
    return "";
  }
  const FrameCompliance& frame = run->frame;
  const std::string sd = std::isfinite(frame.stiffness_sd_n_per_m)
                             ? fmt::format(" +- {:.2g}", frame.stiffness_sd_n_per_m)
                             : "";
  if (run->samples == 0) {
    return fmt::format("{:.5g}{} N/m, as stated", frame.stiffness_n_per_m, sd);
  }
  return fmt::format(
      "{:.5g}{} N/m{}, from {} samples in contact up to {:.4g} N, residual {:.3g} N "
      "rms",
      frame.stiffness_n_per_m, sd,
      frame.linear ? ""
                   : fmt::format(" at the largest force, a curve of {} points below",
                                 frame.force_n.size()),
      run->samples, run->force_max_n, run->rms_n);
}

std::string describe_registration(const Session& session) {
  if (!session.registration) {
    return "";
  }
  const Registration& r = *session.registration;
  std::string text =
      fmt::format("{} pairs, residual {:.3g} mm rms\n", r.pairs.size(), 1e3 * r.rms_m);
  for (std::size_t i = 0; i < r.pairs.size(); ++i) {
    text +=
        fmt::format("pair {}: {:.3g} mm off\n", r.pairs[i].name, 1e3 * r.residual_m[i]);
  }
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (const SessionRun& run : session.run) {
    if (run.position_m) {
      const double error = registration_error_m(r, *run.position_m);
      least = std::min(least, error);
      most = std::max(most, error);
    }
  }
  if (most > 0.0 || std::isfinite(least)) {
    text += fmt::format("expected error at the probes: {:.3g} to {:.3g} mm rms\n",
                        1e3 * least, 1e3 * most);
  }
  return text;
}

}  // namespace palpate
