#include "fitting/session/session_runs.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <glob.h>

#include "formats/base/units.h"
#include "formats/measurement/afm_file.h"
#include "formats/measurement/column_name.h"
#include "formats/measurement/delimited_text.h"

namespace palpate::session_parts {
namespace {

namespace fs = std::filesystem;

fs::path beside(const Session& session, const std::string& name) {
  const fs::path path(name);
  return path.is_absolute() ? path : session.file.parent_path() / path;
}

bool is_pattern(const std::string& name) {
  return name.find_first_of("*?[") != std::string::npos;
}

// As the session would write a file that a pattern found.
std::string written(const Session& session, const fs::path& found,
                    const std::string& pattern) {
  return fs::path(pattern).is_absolute()
             ? found.string()
             : found.lexically_relative(session.file.parent_path()).string();
}

std::vector<std::string> expanded(const SceneSection& section, std::string_view key,
                                  const std::string& name, const Session& session) {
  if (!is_pattern(name)) {
    return {name};
  }
  glob_t found{};
  const int failed = ::glob(beside(session, name).c_str(), GLOB_ERR, nullptr, &found);
  std::vector<std::string> names;
  for (std::size_t i = 0; failed == 0 && i < found.gl_pathc; ++i) {
    names.push_back(written(session, found.gl_pathv[i], name));
  }
  globfree(&found);
  if (names.empty()) {
    section.fail(section.need(key), "{} {:?} in {} matches no file", key, name,
                 section.title());
  }
  return names;
}

std::vector<std::string> names_in(const SceneSection& section) {
  constexpr std::string_view kOne[] = {"file", "files"};
  const std::string_view key = section.only_one_of(kOne);
  const toml::node& node = section.need(key);
  if (key == "file" || node.is_string()) {
    return {section.text(key)};
  }
  std::vector<std::string> names;
  if (const toml::array* array = node.as_array()) {
    for (const toml::node& element : *array) {
      const auto text = element.value_exact<std::string>();
      if (!text || text->empty()) {
        names.clear();
        break;
      }
      names.push_back(*text);
    }
  }
  if (names.empty()) {
    section.fail(node, "files in {} must be a text or a list of texts",
                 section.title());
  }
  return names;
}

void append_file(const SceneSection& section, const SessionRun& like,
                 const std::string& name, Session& session) {
  std::vector<int> curves{0};
  const bool several = session.layout == SessionLayout::kAfmHdf5;
  const fs::path file = beside(session, name);
  if (several) {
    try {
      curves = afm_curves(file);
    } catch (const Error&) {
      curves = {0};  // the batch lists it with its reason
    }
  }
  for (const int curve : curves) {
    SessionRun run = like;
    run.file = file;
    run.curve = curve;
    run.name = several ? fmt::format("{}#{}", name, curve) : name;
    if (run.point.empty()) {
      run.point = run.name;
    }
    for (const SessionRun& other : session.run) {
      if (other.name == run.name) {
        section.fail("{} names the run {:?} a second time", section.title(), run.name);
      }
    }
    session.run.push_back(run);
  }
}

// The table of points: where each of its columns is.
struct PointTable {
  std::string file;
  char delimiter = ',';
  std::map<std::string, std::size_t> column;
};

PointTable find_columns(const std::string& file, const TextLine& header) {
  for (const char delimiter : {'\t', ';', ','}) {
    PointTable table{file, delimiter, {}};
    const auto cells = split_cells(header.text, delimiter);
    for (const char* name :
         {"file", "x", "y", "z", "nx", "ny", "nz", "point", "specimen"}) {
      const auto matches = matching_columns(cells, name);
      if (matches.size() == 1) {
        table.column[name] = matches[0];
      }
    }
    if (table.column.contains("file") && table.column.contains("x") &&
        table.column.contains("y") && table.column.contains("z")) {
      return table;
    }
  }
  throw InputError(
      fmt::format("{}: line {} must name the columns file, x, y, z (and may name nx, "
                  "ny, nz, point, specimen)",
                  file, header.number));
}

std::string cell(const PointTable& table, const TextLine& line,
                 const std::string& name) {
  const auto cells = split_cells(line.text, table.delimiter);
  const std::size_t column = table.column.at(name);
  if (column >= cells.size()) {
    throw FormatError(fmt::format("{}: line {} has {} cells, column \"{}\" is missing",
                                  table.file, line.number, cells.size(), name));
  }
  return cells[column];
}

Eigen::Vector3d vector(const PointTable& table, const TextLine& line,
                       const std::array<const char*, 3>& names) {
  Eigen::Vector3d v;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const char* name = names[static_cast<std::size_t>(axis)];
    const std::string text = cell(table, line, name);
    const auto value = parse_number(text, table.delimiter != ',');
    if (!value || !std::isfinite(*value)) {
      throw FormatError(
          fmt::format("{}: line {}, column \"{}\": \"{}\" is not a finite number",
                      table.file, line.number, name, text));
    }
    v[axis] = *value;
  }
  return v;
}

bool fits(const SessionRun& run, const std::string& file) {
  const std::string of_file = run.name.substr(0, run.name.find('#'));
  return run.name == file || of_file == file ||
         fs::path(of_file).filename() == fs::path(file);
}

void place(const PointTable& table, const TextLine& line, double metres,
           SessionRun& run) {
  run.position_m = metres * vector(table, line, {"x", "y", "z"});
  if (table.column.contains("nx") && table.column.contains("ny") &&
      table.column.contains("nz")) {
    const Eigen::Vector3d normal = vector(table, line, {"nx", "ny", "nz"});
    if (!(normal.norm() > 0.0)) {
      throw FormatError(
          fmt::format("{}: line {}: the normal is [0, 0, 0], must have a direction",
                      table.file, line.number));
    }
    run.normal = normal.normalized();
  }
  if (table.column.contains("point")) {
    run.point = cell(table, line, "point");
  }
  if (table.column.contains("specimen")) {
    run.specimen = cell(table, line, "specimen");
  }
}

}  // namespace

void append_runs(const SceneSection& section, Session& session) {
  SessionRun like;
  if (section.find("point") != nullptr) {
    like.point = section.text("point");
  }
  if (section.find("specimen") != nullptr) {
    like.specimen = section.text("specimen");
  }
  if (section.find("position_m") != nullptr) {
    like.position_m = section.vector("position_m");
  }
  if (section.find("normal") != nullptr) {
    like.normal = section.direction("normal");
  }
  const std::string_view key = section.find("file") != nullptr ? "file" : "files";
  std::vector<std::string> files;
  for (const std::string& name : names_in(section)) {
    for (const std::string& file : expanded(section, key, name, session)) {
      files.push_back(file);
    }
  }
  if (like.position_m && like.point.empty() && files.size() > 1) {
    like.point = files.front();  // several files at one place are repeats
  }
  for (const std::string& file : files) {
    append_file(section, like, file, session);
  }
}

void read_points(const SceneSection& section, Session& session) {
  const fs::path path = beside(session, section.text("table"));
  const double metres = metres_per(section.text("length_unit"));
  const auto lines = read_text_lines(path);
  if (lines.empty()) {
    throw InputError(
        fmt::format("{}: is empty, must be a table of points", path.string()));
  }
  const PointTable table = find_columns(path.string(), lines.front());
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::string file = cell(table, lines[i], "file");
    bool used = false;
    for (SessionRun& run : session.run) {
      if (fits(run, file)) {
        place(table, lines[i], metres, run);
        used = true;
      }
    }
    if (!used) {
      throw InputError(fmt::format("{}: line {}: the session has no run of {:?}",
                                   table.file, lines[i].number, file));
    }
  }
  for (const SessionRun& run : session.run) {
    if (!run.position_m) {
      throw InputError(
          fmt::format("{}: no row for the run {:?}", table.file, run.name));
    }
  }
}

}  // namespace palpate::session_parts
