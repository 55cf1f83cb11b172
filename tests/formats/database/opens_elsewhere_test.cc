// What is not ours opens a database: h5py by the lines of FORMAT.md, VTK by its own
// reader. Debian's python3-h5py and python3-vtk9; skipped where they are absent.
#include <array>
#include <cstdio>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/database/response_database.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/small_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

constexpr const char* kPython = "/usr/bin/python3";  // Debian's, with its modules

bool has_module(const std::string& name) {
  return std::system(
             fmt::format("{} -c 'import {}' 2>/dev/null", kPython, name).c_str()) == 0;
}

// What a script prints when it runs in a folder; nothing if it fails.
std::string output_of(const std::filesystem::path& script,
                      const std::filesystem::path& folder,
                      const std::string& argument) {
  FILE* pipe = ::popen(fmt::format("cd '{}' && {} '{}' {}", folder.string(), kPython,
                                   script.string(), argument)
                           .c_str(),
                       "r");
  std::string text;
  std::array<char, 4096> piece{};
  for (std::size_t n = 0; (n = std::fread(piece.data(), 1, piece.size(), pipe)) > 0;) {
    text.append(piece.data(), n);
  }
  return ::pclose(pipe) == 0 ? text : "";
}

// The lines between "```<kind>" and "```".
std::string block_of(const std::string& document, const std::string& kind) {
  const std::string begin = "```" + kind + "\n";
  const std::size_t at = document.find(begin);
  return at == std::string::npos
             ? ""
             : document.substr(
                   at + begin.size(),
                   document.find("```", at + begin.size()) - at - begin.size());
}

TEST(OpensElsewhere, TheLinesOfTheDocumentEvaluateAResponse) {
  if (!has_module("h5py")) {
    GTEST_SKIP() << "python3-h5py is not installed";
  }
  const ScratchFolder folder;
  write_database(folder / "example.h5", small_database());
  const std::string lines = block_of(bytes_of("formats/database/FORMAT.md"), "python");
  ASSERT_FALSE(lines.empty());
  EXPECT_LE(std::count(lines.begin(), lines.end(), '\n'), 12);
  std::ofstream(folder / "evaluate.py") << lines;
  const std::string printed = output_of(folder / "evaluate.py", folder.path(), "");
  // The document's example: the node at (0, 0.05, 0) m pressed 2 mm deep.
  const ResponseDatabase database = small_database();
  const double force_n = find_tool(database, "ball").curve(2).at(0.002).force_n;
  ASSERT_FALSE(printed.empty());
  EXPECT_NEAR(std::stod(printed), force_n, 1e-12 * force_n);
  EXPECT_NE(
      bytes_of("formats/database/FORMAT.md").find(fmt::format("{:.6f} N", force_n)),
      std::string::npos)
      << fmt::format("{:.6f} N", force_n);
}

TEST(OpensElsewhere, VtkShowsTheBodyAndItsResponses) {
  if (!has_module("vtkmodules.vtkIOHDF")) {
    GTEST_SKIP() << "python3-vtk9 is not installed";
  }
  const ScratchFolder folder;
  write_database(folder / "a.h5", small_database());
  const ResponseDatabase database = read_database(folder / "a.h5");
  const std::string printed =
      output_of(std::filesystem::absolute("tests/formats/database/open_with_vtk.py"),
                folder.path(), "a.h5");
  ASSERT_FALSE(printed.empty());
  const nlohmann::json report = parse_json(printed);
  EXPECT_EQ(report.at("class"), "vtkUnstructuredGrid");
  ASSERT_EQ(report.at("points").size(), 6u);
  ASSERT_EQ(report.at("triangles").size(), 8u);
  const ResponseTable& first = database.tools.front();
  const nlohmann::json& data = report.at("data");
  const ResponseTable& ball = find_tool(database, "ball");
  // Every point is a node of the body, with the depth of its own curve.
  for (std::size_t i = 0; i < 6; ++i) {
    const auto x = report.at("points")[i].get<std::array<double, 3>>();
    const Eigen::Vector3d point(x[0], x[1], x[2]);
    Eigen::Index node = 0;
    (database.body.position_m.rowwise() - point.transpose())
        .rowwise()
        .squaredNorm()
        .minCoeff(&node);
    EXPECT_EQ(database.body.position_m.row(node).transpose(), point);
    const auto at = static_cast<std::size_t>(node);
    EXPECT_EQ(data.at("depth_max")[i], first.curve(node).depth_max_m());
    EXPECT_EQ(data.at("stiffness")[i], first.stiffness_max_n_per_m[at]);
    EXPECT_EQ(data.at("stiffness_ball")[i], ball.stiffness_max_n_per_m[at]);
    EXPECT_EQ(data.at("error")[i], first.error_relative[at]);
    EXPECT_EQ(data.at("origin")[i], first.origin[at]);
  }
}

}  // namespace
}  // namespace palpate
