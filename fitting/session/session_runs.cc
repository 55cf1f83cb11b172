#include "fitting/session/session_runs.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <glob.h>

#include "formats/base/units.h"
#include "formats/measurement/afm_file.h"
#include "formats/measurement/column_name.h"
#include "formats/measurement/delimited_text.h"
#include "formats/measurement/mach1_map.h"

namespace palpate::session_parts {
namespace {

namespace fs = std::filesystem;

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

// The curves of a file; one without a list where it cannot be read: the batch lists it
// with its reason.
std::vector<SessionRun> curves_of(const Session& session, const SessionRun& like) {
  std::vector<SessionRun> runs;
  try {
    if (session.layout == SessionLayout::kAfmHdf5) {
      for (const int number : afm_curves(like.file)) {
        runs.push_back(like);
        runs.back().curve = number;
      }
    } else if (session.layout == SessionLayout::kAuto) {
      for (const InstrumentCurve& curve : layout_of(like.file).list(like.file).curve) {
        SessionRun run = like;
        run.curve = curve.number;
        run.instrument = curve;
        run.placed_by_file = !like.position_m && curve.position_m.has_value();
        run.position_m = like.position_m ? like.position_m : curve.position_m;
        run.normal = like.normal ? like.normal : curve.normal;
        runs.push_back(run);
      }
    }
  } catch (const Error&) {
    runs.clear();
  }
  return runs.empty() ? std::vector<SessionRun>{like} : runs;
}

void append_file(const SceneSection& section, const SessionRun& like,
                 const std::string& name, Session& session) {
  SessionRun of_file = like;
  of_file.file = beside(session, name);
  const std::vector<SessionRun> runs = curves_of(session, of_file);
  const bool numbered = session.layout == SessionLayout::kAfmHdf5 || runs.size() > 1;
  for (SessionRun run : runs) {
    run.name = numbered ? fmt::format("{}#{}", name, run.curve) : name;
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
  run.placed_by_file = false;
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

// A Mach-1 map: its points in turn are the presses of the session's one file.
void place_by_map(const std::string& map, std::span<const TextLine> lines,
                  Session& session) {
  for (const SessionRun& run : session.run) {
    if (run.file != session.run.front().file) {
      throw InputError(fmt::format(
          "{}: a map names no files: it goes with a session of one file, and this one "
          "has {} and {}; write a table with a column file",
          map, session.run.front().file.string(), run.file.string()));
    }
  }
  const std::vector<MapPoint> points = read_mach1_map(map, lines);
  for (SessionRun& run : session.run) {
    const int number = run.instrument ? run.instrument->number : 1;
    const auto point = std::find_if(points.begin(), points.end(), [&](const auto& p) {
      return p.id == number;
    });
    if (point == points.end() || points.size() != session.run.size()) {
      throw InputError(fmt::format(
          "{}: has {} points that were pressed, the file {} {} presses; they must be "
          "as "
          "many, numbered alike from 1",
          map, points.size(), session.run.front().file.string(), session.run.size()));
    }
    run.position_m = Eigen::Vector3d(point->position_m.x(), point->position_m.y(), 0.0);
    run.placed_by_file = false;
  }
}

// "a.txt: Mach-1 text, 3 presses; positions and normals of the file".
std::string note_of(const SessionRun& first, std::size_t presses) {
  const InstrumentLayout& layout = layout_of(first.file);
  std::string note =
      fmt::format("{}: {}, {} press{}", first.name.substr(0, first.name.find('#')),
                  layout.name, presses, presses == 1 ? "" : "es");
  if (first.placed_by_file) {
    note += first.instrument->normal ? "; positions and normals are the file's"
                                     : "; positions are the file's";
  }
  if (first.instrument->tip_radius_m) {
    note += fmt::format("; states a tip of radius {:.4g} m",
                        *first.instrument->tip_radius_m);
  }
  return note;
}

// The one radius that all files state [m].
double radius_of_files(const Session& session) {
  std::optional<double> radius_m;
  for (const SessionRun& run : session.run) {
    const auto stated =
        run.instrument ? run.instrument->tip_radius_m : std::optional<double>();
    if (!run.instrument) {
      continue;  // cannot be read: the batch says why
    }
    if (!stated || (radius_m && *stated != *radius_m)) {
      throw InputError(fmt::format(
          "{}: [indenter] has no radius_m, and the run {:?} states {}; tell radius_m",
          session.file.string(), run.name,
          stated
              ? fmt::format("{:.4g} m where others state {:.4g} m", *stated, *radius_m)
              : std::string("none")));
    }
    radius_m = stated;
  }
  if (!radius_m) {
    throw InputError(
        fmt::format("{}: [indenter] has no radius_m, and no file states one",
                    session.file.string()));
  }
  return *radius_m;
}

}  // namespace

fs::path beside(const Session& session, const std::string& name) {
  const fs::path path(name);
  return path.is_absolute() ? path : session.file.parent_path() / path;
}

void take_from_files(Session& session) {
  if (session.layout != SessionLayout::kAuto) {
    return;
  }
  if (session.indenter.shape == "sphere" && session.indenter.radius_m == 0.0) {
    session.indenter.radius_m = radius_of_files(session);
    session.tool->radius_m = session.indenter.radius_m;
    session.notes.push_back(fmt::format("the indenter's radius is the files': {:.4g} m",
                                        session.indenter.radius_m));
  }
  for (std::size_t i = 0, next = 0; i < session.run.size(); i = next) {
    while (next < session.run.size() && session.run[next].file == session.run[i].file) {
      ++next;
    }
    if (session.run[i].instrument) {
      session.notes.push_back(note_of(session.run[i], next - i));
    }
  }
}

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
  const auto lines = read_text_lines(path);
  if (lines.empty()) {
    throw InputError(
        fmt::format("{}: is empty, must be a table of points", path.string()));
  }
  if (is_mach1_map(lines)) {
    place_by_map(path.string(), lines, session);
    return;
  }
  session.points_unit = section.text("length_unit");
  const double metres = metres_per(session.points_unit);
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
