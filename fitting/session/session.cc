#include "fitting/session/session.h"

#include <algorithm>
#include <numbers>

#include <fmt/ranges.h>

#include "fitting/session/session_machine.h"
#include "fitting/session/session_runs.h"
#include "formats/base/input_file.h"
#include "formats/base/toml_text.h"
#include "formats/base/units.h"
#include "formats/measurement/afm_file.h"

namespace palpate {
namespace {

constexpr std::string_view kTables[] = {"session", "read",    "indenter",
                                        "body",    "fit",     "run",
                                        "points",  "machine", "registration"};
constexpr std::string_view kSessionKeys[] = {"name"};
constexpr std::string_view kReadKeys[] = {
    "layout",     "depth_column", "depth_unit", "force_column",
    "force_unit", "time_column",  "time_unit",  "ignore_header_units"};
constexpr std::string_view kTextKeys[] = {
    "depth_column", "depth_unit", "force_column",       "force_unit",
    "time_column",  "time_unit",  "ignore_header_units"};
constexpr std::string_view kLayoutKey[] = {"layout"};
constexpr std::string_view kLayouts[] = {"text", "afm-hdf5", "auto"};
constexpr std::string_view kIndenterKeys[] = {
    "shape",          "radius_m",          "radius_sd_m",
    "half_angle_deg", "half_angle_sd_deg", "height_m",
    "height_sd_m",    "thickness_m",       "thickness_sd_m",
    "poissons_ratio", "poissons_ratio_sd", "friction",
    "presliding_m"};
constexpr std::string_view kSharedKeys[] = {
    "shape", "poissons_ratio", "poissons_ratio_sd", "friction", "presliding_m"};
constexpr std::string_view kRoundKeys[] = {"radius_m", "radius_sd_m", "thickness_m",
                                           "thickness_sd_m"};
constexpr std::string_view kConeKeys[] = {"half_angle_deg", "half_angle_sd_deg"};
constexpr std::string_view kPlateKeys[] = {"radius_m", "radius_sd_m", "height_m",
                                           "height_sd_m"};
constexpr std::string_view kBodyKeys[] = {"mesh", "length_unit"};
constexpr std::string_view kFitKeys[] = {
    "from_m", "to_m", "baseline_m", "families", "criterion", "noise_relative", "cycle"};

constexpr NumberRule kAny{[](double) {
                            return true;
                          },
                          "finite"};
constexpr NumberRule kShare{[](double v) {
                              return v >= 0.0 && v < 1.0;
                            },
                            "in [0, 1)"};
constexpr NumberRule kPoisson{[](double v) {
                                return v > -1.0 && v <= 0.5;
                              },
                              "above -1 and at most 0.5"};
constexpr NumberRule kFriction{[](double v) {
                                 return v >= 0.0 && v <= 10.0;
                               },
                               "in [0, 10]"};
constexpr NumberRule kHalfAngle{[](double v) {
                                  return v > 0.0 && v < 90.0;
                                },
                                "above 0 and below 90"};

// The session's tables by name.
class Tables {
 public:
  Tables(const std::string& file, const toml::table& root)
      : file_(file), root_(file, "the session", root) {
    root_.require_known(kTables);
  }

  [[nodiscard]] bool has(std::string_view name) const {
    return root_.find(name) != nullptr;
  }

  [[nodiscard]] SceneSection one(std::string_view name, Names known) const {
    const toml::node& node = root_.need(name);
    if (!node.is_table()) {
      root_.fail(node, "[{}] must be one table", name);
    }
    return section(fmt::format("[{}]", name), *node.as_table(), known);
  }

  [[nodiscard]] std::vector<SceneSection> all(std::string_view name,
                                              Names known) const {
    const toml::node& node = root_.need(name);
    const toml::array* array = node.as_array();
    if (array == nullptr || array->empty()) {
      root_.fail(node, "[[{}]] must be a list of tables, at least one", name);
    }
    std::vector<SceneSection> sections;
    for (const toml::node& element : *array) {
      if (!element.is_table()) {
        root_.fail(element, "[[{}]] must be a list of tables", name);
      }
      sections.push_back(
          section(fmt::format("[[{}]]", name), *element.as_table(), known));
    }
    return sections;
  }

 private:
  [[nodiscard]] SceneSection section(std::string title, const toml::table& table,
                                     Names known) const {
    SceneSection result(file_, std::move(title), table);
    result.require_known(known);
    return result;
  }

  const std::string& file_;
  SceneSection root_;
};

// A column's name, or its number counted from 1.
MeasurementColumn read_column(const SceneSection& section, const std::string& quantity,
                              double (*size)(std::string_view),
                              bool unit_needed = true) {
  MeasurementColumn column;
  const std::string name = quantity + "_column", unit = quantity + "_unit";
  if (const auto number = section.need(name).value_exact<std::int64_t>()) {
    if (*number < 1) {
      section.fail(section.need(name), "{} in {} is {}, columns are counted from 1",
                   name, section.title(), *number);
    }
    column.column = std::to_string(*number);
  } else {
    column.column = section.text(name);
  }
  if (!unit_needed && section.find(unit) == nullptr) {
    return column;
  }
  column.unit = section.text(unit);
  if (column.unit != kUnitFromHeader) {
    try {
      (void)size(column.unit);
    } catch (const InputError& error) {
      section.fail(section.need(unit), "{} in {}: {}, header", unit, section.title(),
                   error.what());
    }
  }
  return column;
}

// Layout "auto": files tell their columns; what the session tells goes before.
void read_told(const SceneSection& section, Session& session) {
  session.layout = SessionLayout::kAuto;
  if (section.find("depth_column") != nullptr) {
    session.columns.depth = read_column(section, "depth", &metres_per, false);
  }
  if (section.find("force_column") != nullptr) {
    session.columns.force = read_column(section, "force", &newtons_per, false);
  }
  if (section.find("time_column") != nullptr) {
    session.columns.time = read_column(section, "time", &seconds_per);
  }
  for (const char* quantity : {"depth", "force", "time"}) {
    const std::string unit = fmt::format("{}_unit", quantity);
    if (section.find(unit) != nullptr &&
        section.find(fmt::format("{}_column", quantity)) == nullptr) {
      section.fail(section.need(unit), "{} in {} needs {}_column", unit,
                   section.title(), quantity);
    }
  }
}

void read_reading(const SceneSection& section, Session& session) {
  const std::string layout = section.choice_or("text", "layout", kLayouts);
  if (layout == "afm-hdf5") {
    section.require_own("layout \"afm-hdf5\"", {}, kLayoutKey);
    session.layout = SessionLayout::kAfmHdf5;
    return;
  }
  if (section.boolean_or(false, "ignore_header_units")) {
    session.header_units = HeaderUnits::kIgnored;
  }
  if (layout == "auto") {
    read_told(section, session);
    return;
  }
  section.require_own("layout \"text\"", kTextKeys, kLayoutKey);
  session.columns.depth = read_column(section, "depth", &metres_per);
  session.columns.force = read_column(section, "force", &newtons_per);
  if (section.find("time_column") != nullptr || section.find("time_unit") != nullptr) {
    session.columns.time = read_column(section, "time", &seconds_per);
  }
}

Names keys_of(const std::string& shape) {
  if (shape == "unknown") {
    return {};
  }
  if (shape == "cone") {
    return kConeKeys;
  }
  return shape == "plate" ? Names(kPlateKeys) : Names(kRoundKeys);
}

void read_indenter(const SceneSection& section, Session& session) {
  Indenter& indenter = session.indenter;
  indenter.shape = section.choice("shape", kIndenterShapes);
  section.require_own(fmt::format("shape {:?}", indenter.shape),
                      keys_of(indenter.shape), kSharedKeys);
  indenter.poissons_ratio = section.number_or(0.5, "poissons_ratio", kPoisson);
  indenter.poissons_ratio_sd =
      section.number_or(0.0, "poissons_ratio_sd", kNotNegative);
  if (indenter.shape == "cone") {
    indenter.half_angle_rad =
        section.number("half_angle_deg", kHalfAngle) * std::numbers::pi / 180.0;
    indenter.half_angle_sd_rad =
        section.number_or(0.0, "half_angle_sd_deg", kNotNegative) * std::numbers::pi /
        180.0;
  } else if (indenter.shape != "unknown") {
    const bool by_file = session.layout == SessionLayout::kAuto &&
                         indenter.shape == "sphere" &&
                         section.find("radius_m") == nullptr;
    indenter.radius_m = by_file ? 0.0 : section.number("radius_m", kPositive);
    indenter.radius_sd_m = section.number_or(0.0, "radius_sd_m", kNotNegative);
    indenter.thickness_m = section.number_or(0.0, "thickness_m", kPositive);
    indenter.thickness_sd_m = section.number_or(0.0, "thickness_sd_m", kNotNegative);
  }
  if (indenter.shape == "plate") {
    indenter.height_m = section.number("height_m", kPositive);
    indenter.height_sd_m = section.number_or(0.0, "height_sd_m", kNotNegative);
  }
  const double friction = section.number_or(0.0, "friction", kFriction);
  const double presliding_m = section.number_or(0.0, "presliding_m", kNotNegative);
  session.tool = rendered_tool(indenter);
  if (session.tool) {
    session.tool->friction = friction;
    session.tool->presliding_m = presliding_m;
  }
}

FitRange read_range(const SceneSection& section, std::string_view key) {
  const auto ends = section.numbers(key, kAny, 2);
  if (ends.size() != 2 || !(ends[0] < ends[1])) {
    section.fail(section.need(key), "{} in {} must be two rising displacements", key,
                 section.title());
  }
  return {ends[0], ends[1]};
}

std::vector<std::string> read_families(const SceneSection& section) {
  const toml::node& node = section.need("families");
  std::vector<std::string> families;
  const toml::array* array = node.as_array();
  for (std::size_t i = 0; array != nullptr && i < array->size(); ++i) {
    families.push_back(array->get(i)->value_exact<std::string>().value_or(""));
    if (std::find(kFamilyNames.begin(), kFamilyNames.end(), families.back()) ==
        kFamilyNames.end()) {
      section.fail(node,
                   "families in {} holds {:?}, which is not available; "
                   "available: {}",
                   section.title(), families.back(), fmt::join(kFamilyNames, ", "));
    }
  }
  if (families.empty()) {
    section.fail(node, "families in {} must be a list of texts", section.title());
  }
  return families;
}

void read_fit(const SceneSection& section, Session& session) {
  SessionFit& fit = session.fit;
  fit.range.from_m = section.number_or(fit.range.from_m, "from_m", kAny);
  fit.range.to_m = section.number_or(fit.range.to_m, "to_m", kAny);
  if (!(fit.range.from_m < fit.range.to_m)) {
    section.fail("from_m {} in {} must be less than to_m {}", fit.range.from_m,
                 section.title(), fit.range.to_m);
  }
  if (section.find("baseline_m") != nullptr) {
    fit.baseline = read_range(section, "baseline_m");
  }
  if (section.find("families") != nullptr) {
    fit.families = read_families(section);
  }
  fit.noise_relative = section.number_or(0.0, "noise_relative", kShare);
  fit.criterion = section.choice_or(fit.criterion, "criterion", kCriteria);
  if (section.find("cycle") != nullptr) {
    fit.cycle = session_parts::read_cycle(section);
  }
}

void read_tables(const Tables& tables, Session& session) {
  session.name = tables.has("session")
                     ? tables.one("session", kSessionKeys).text("name")
                     : session.file.stem().string();
  read_reading(tables.one("read", kReadKeys), session);
  if (tables.has("indenter")) {
    read_indenter(tables.one("indenter", kIndenterKeys), session);
  }
  if (tables.has("body")) {
    const SceneSection body = tables.one("body", kBodyKeys);
    const std::filesystem::path mesh = body.text("mesh");
    session.mesh = mesh.is_absolute() ? mesh : session.file.parent_path() / mesh;
    session.length_unit = body.text("length_unit");
    (void)metres_per(session.length_unit);
  }
  session.fit.families.assign(kFamilyNames.begin(), kFamilyNames.end());
  if (tables.has("fit")) {
    read_fit(tables.one("fit", kFitKeys), session);
  }
  for (const SceneSection& run : tables.all("run", session_parts::kRunKeys)) {
    session_parts::append_runs(run, session);
  }
  if (tables.has("points")) {
    session_parts::read_points(tables.one("points", session_parts::kPointKeys),
                               session);
  }
  session_parts::take_from_files(session);
  if (tables.has("machine")) {
    session_parts::read_machine(tables.one("machine", session_parts::kMachineKeys),
                                session);
  }
  if (tables.has("registration")) {
    session_parts::read_registration(
        tables.one("registration", session_parts::kRegistrationKeys), session);
  }
}

}  // namespace

Session read_session(const std::filesystem::path& file) {
  Session session;
  session.file = file;
  constexpr std::size_t kLargest = 16 << 20;  // bytes: a hundred thousand runs
  session.text = read_file(file, kLargest, "a session file");
  const std::string name = file.string();
  try {
    const toml::table root = parse_toml(session.text, name);
    read_tables(Tables(name, root), session);
  } catch (const InputError& error) {
    if (file.extension() == ".toml") {
      throw;
    }
    throw InputError(fmt::format(
        "{}; a session is a TOML file that names its measurements (SESSION.md): one "
        "measurement alone is fitted by palpate-fit curve",
        error.what()));
  }
  return session;
}

std::string describe_notes(const Session& session) {
  constexpr std::size_t kMost = 20;
  std::string text;
  for (std::size_t i = 0; i < std::min(session.notes.size(), kMost); ++i) {
    text += fmt::format("read   {}\n", session.notes[i]);
  }
  if (session.notes.size() > kMost) {
    text += fmt::format("read   and {} more files\n", session.notes.size() - kMost);
  }
  return text;
}

MeasurementFile read_run(const Session& session, const SessionRun& run) {
  if (session.layout == SessionLayout::kAuto) {
    const InstrumentLayout& layout = layout_of(run.file);
    return layout.read(
        run.file,
        run.instrument ? *run.instrument : layout.list(run.file).curve.front(),
        {session.columns, session.header_units, true});
  }
  return session.layout == SessionLayout::kAfmHdf5
             ? read_afm_curve(run.file, run.curve)
             : read_measurement(run.file, session.columns, session.header_units);
}

}  // namespace palpate
