#include "formats/response_database.h"

#include "formats/error.h"
#include "tests/support/small_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void expect_equal(const ResponseTable& a, const ResponseTable& b) {
  EXPECT_EQ(a.tool.name, b.tool.name);
  EXPECT_EQ(a.tool.kind, b.tool.kind);
  EXPECT_EQ(a.tool.radius_m, b.tool.radius_m);
  EXPECT_EQ(a.tool.friction, b.tool.friction);
  EXPECT_EQ(a.tool.presliding_m, b.tool.presliding_m);
  EXPECT_EQ(a.direction, b.direction);
  EXPECT_EQ(a.direction_spread_rad, b.direction_spread_rad);
  EXPECT_EQ(a.touch_offset_m, b.touch_offset_m);
  EXPECT_EQ(a.error_relative, b.error_relative);
  EXPECT_EQ(a.friction, b.friction);
  EXPECT_EQ(a.presliding_m, b.presliding_m);
  EXPECT_EQ(a.stiffness_max_n_per_m, b.stiffness_max_n_per_m);
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.flags, b.flags);
  EXPECT_EQ(a.sample_begin, b.sample_begin);
  EXPECT_EQ(a.depth_m, b.depth_m);
  EXPECT_EQ(a.force_n, b.force_n);
  EXPECT_EQ(a.stiffness_n_per_m, b.stiffness_n_per_m);
  EXPECT_EQ(a.energy_j, b.energy_j);
}

TEST(ResponseDatabase, ReadsWhatWasWritten) {
  const ScratchFolder folder;
  ResponseDatabase written = small_database();
  written.measurement = {{0.0, 0.001, 0.0005}, {0.0, 0.2, -0.01}};
  write_database(folder / "a.h5", written);
  const ResponseDatabase read = read_database(folder / "a.h5");
  EXPECT_EQ(read.body.position_m, written.body.position_m);
  EXPECT_EQ(read.body.triangle, written.body.triangle);
  EXPECT_EQ(read.normal, written.normal);
  ASSERT_EQ(read.tools.size(), written.tools.size());
  for (std::size_t i = 0; i < read.tools.size(); ++i) {
    expect_equal(read.tools[i], written.tools[i]);
  }
  EXPECT_EQ(read.measurement.depth_m, written.measurement.depth_m);
  EXPECT_EQ(read.measurement.force_n, written.measurement.force_n);
  EXPECT_EQ(read.provenance.writer, written.provenance.writer);
  EXPECT_EQ(read.provenance.scene_toml, written.provenance.scene_toml);
  EXPECT_EQ(read.provenance.source_file, written.provenance.source_file);
  EXPECT_EQ(read.provenance.source_sha256, written.provenance.source_sha256);
  EXPECT_EQ(read.provenance.left_out, written.provenance.left_out);
}

TEST(ResponseDatabase, EmptyTextsAndNoMeasurementComeBackEmpty) {
  const ScratchFolder folder;
  ResponseDatabase written = small_database();
  written.provenance = {};
  write_database(folder / "a.h5", written);
  const ResponseDatabase read = read_database(folder / "a.h5");
  EXPECT_EQ(read.provenance.scene_toml, "");
  EXPECT_EQ(read.provenance.writer, "");
  EXPECT_TRUE(read.measurement.depth_m.empty());
}

TEST(ResponseDatabase, EqualContentGivesEqualBytes) {
  const ScratchFolder folder;
  write_database(folder / "a.h5", small_database());
  write_database(folder / "b.h5", read_database(folder / "a.h5"));
  EXPECT_EQ(bytes_of(folder / "a.h5"), bytes_of(folder / "b.h5"));
}

TEST(ResponseDatabase, AnInvalidDatabaseIsNotWritten) {
  const ScratchFolder folder;
  ResponseDatabase database = small_database();
  database.tools[0].force_n[2] = std::nan("");
  EXPECT_THROW(write_database(folder / "a.h5", database), FormatError);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(ResponseDatabase, FindsAToolByNameOrTheOnlyOne) {
  ResponseDatabase database = small_database();
  EXPECT_EQ(find_tool(database, "ball").tool.radius_m, 0.005);
  EXPECT_THROW((void)find_tool(database, ""), InputError);
  try {
    (void)find_tool(database, "bal");
    FAIL() << "found a tool that is not there";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "unknown tool \"bal\"; there are: tip, ball");
  }
  database.tools.pop_back();
  EXPECT_EQ(find_tool(database, "").tool.name, "tip");
}

}  // namespace
}  // namespace palpate
