// The report page in a browser: Debian's headless Chromium, skipped where it is absent.
#include "formats/report/database_page.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/report/display_mesh.h"
#include "tests/support/page_visit.h"
#include "tests/support/punctured_sphere.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/run_tool.h"
#include "tests/support/small_database.h"
#include "tests/support/sphere_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

// What a user does, and what there is to be seen then.
constexpr const char* kVisit = R"js(
  const canvas = document.getElementById('body'), box = canvas.getBoundingClientRect();
  const pixels = () => canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
  const drawn = p => { let count = 0; for (let i = 3; i < p.length; i += 4) count += p[i] > 0; return count / (p.length / 4); };
  const sum = p => p.reduce((s, v, i) => (s + v * (i % 8191)) % 1e9, 0);
  const said = () => document.getElementById('said').textContent;
  const key = k => canvas.dispatchEvent(new KeyboardEvent('keydown', {key: k, bubbles: true}));
  const first = pixels();
  seen.covered = drawn(first);
  seen.colours = new Set(Array.from({length: first.length / 4}, (_, i) => first[4 * i])).size;
  seen.before = document.querySelectorAll('#curve path').length;
  const at = {clientX: box.left + box.width / 2, clientY: box.top + box.height / 2, bubbles: true};
  canvas.dispatchEvent(new PointerEvent('pointerdown', at));
  canvas.dispatchEvent(new PointerEvent('pointerup', at));
  seen.path = document.querySelector('#curve path.curve')?.getAttribute('d').length ?? 0;
  seen.clicked = said();
  key('n');
  seen.next = said();
  key('p');
  seen.back = said();
  const before = sum(pixels());
  key('ArrowLeft');
  seen.turned = sum(pixels()) !== before;
  const pictures = new Set();
  const colour = document.getElementById('colour');
  for (const option of colour.options) {
    if (option.disabled) continue;
    colour.value = option.value;
    colour.dispatchEvent(new Event('change'));
    pictures.add(document.getElementById('legend').innerHTML);
  }
  seen.legends = pictures.size;
  seen.bars = document.querySelectorAll('#histogram rect').length;
  const tool = document.getElementById('tool');
  seen.tools = tool.options.length;
  tool.value = tool.options.length - 1;
  tool.dispatchEvent(new Event('change'));
)js";

void expect_a_working_page(const PageVisit& visit) {
  EXPECT_EQ(visit.complaints, "");
  ASSERT_TRUE(visit.seen.is_object()) << visit.seen;
  const nlohmann::json& seen = visit.seen;
  EXPECT_GT(seen.at("covered"), 0.2) << seen;
  EXPECT_LT(seen.at("covered"), 0.95) << seen;
  EXPECT_GT(seen.at("colours"), 10) << seen;
  EXPECT_EQ(seen.at("before"), 0) << seen;
  EXPECT_GT(seen.at("path"), 500) << seen;
  EXPECT_EQ(seen.at("clicked").get<std::string>().rfind("Node ", 0), 0u) << seen;
  EXPECT_NE(seen.at("clicked"), seen.at("next")) << seen;
  EXPECT_EQ(seen.at("clicked"), seen.at("back")) << seen;
  EXPECT_EQ(seen.at("turned"), true) << seen;
  EXPECT_GE(seen.at("legends"), 5) << seen;
  EXPECT_EQ(seen.at("bars"), 30) << seen;
  EXPECT_EQ(seen.at("requests"), 0) << seen;
}

TEST(ReportPage, WorksInABrowser) {
  if (page_browser().empty()) {
    GTEST_SKIP() << "no chromium-headless-shell and no chromium";
  }
  ResponseDatabase database = sphere_database(12, 9);
  database.provenance.scene_toml = "# </script> & \"quotes\"\n";
  expect_a_working_page(
      visit_page(report_page(database, "a </title> of\"quotes\".h5"), kVisit));
}

TEST(ReportPage, ShowsAThinnedBodyToo) {
  if (page_browser().empty()) {
    GTEST_SKIP() << "no chromium-headless-shell and no chromium";
  }
  const std::string page = report_page(sphere_database(40, 5), "a.h5", 500);
  EXPECT_NE(page.find("Thinned for this page"), std::string::npos);
  expect_a_working_page(visit_page(page, kVisit));
}

TEST(ReportPage, ShowsSeveralToolsAndNodesWithoutAResponse) {
  if (page_browser().empty()) {
    GTEST_SKIP() << "no chromium-headless-shell and no chromium";
  }
  const PageVisit page = visit_page(report_page(small_database(), "a.h5"), kVisit);
  EXPECT_EQ(page.complaints, "");
  EXPECT_EQ(page.seen.at("tools"), 2) << page.seen;
}

TEST(ReportPage, ShowsHowAForceRelaxes) {
  if (page_browser().empty()) {
    GTEST_SKIP() << "no chromium-headless-shell and no chromium";
  }
  ResponseDatabase database = sphere_database(12, 9);
  Viscoelasticity& relaxation = database.tools[0].viscoelasticity;
  relaxation.tau_s = {0.5, 4.0};
  relaxation.g = (RowsOf<float>(1, 2) << 0.25F, 0.25F).finished();
  relaxation.instantaneous = true;
  const std::string visit =
      std::string(kVisit) +
      "seen.relaxation = "
      "document.querySelector('#relaxation path.curve')?.getAttribute('d').length ?? 0;"
      "seen.hidden = document.getElementById('relaxing').hidden;";
  const PageVisit page = visit_page(report_page(database, "a.h5"), visit.c_str());
  expect_a_working_page(page);
  EXPECT_GE(page.seen.at("legends"), 7) << page.seen;
  EXPECT_GT(page.seen.at("relaxation"), 500) << page.seen;
  EXPECT_EQ(page.seen.at("hidden"), false) << page.seen;
  const std::string clicked = page.seen.at("clicked");
  EXPECT_NE(clicked.find("Held for long, 50 % of it stay."), std::string::npos);
}

TEST(ReportPage, CountsWhatWasSolvedAgain) {
  ResponseDatabase database = sphere_database(12, 9);
  ResponseTable& table = database.tools[0];
  EXPECT_EQ(report_page(database, "a.h5").find("solved again"), std::string::npos);
  table.history.assign(static_cast<std::size_t>(table.nodes()), -1);
  table.history[1] = table.history[4] = 0;
  table.history_text = {"touches late: mesh 2 times finer"};
  EXPECT_NE(report_page(database, "a.h5").find("2 of touches late: mesh 2 times finer"),
            std::string::npos);
}

TEST(ReportPage, SaysWhatANeedleBreaks) {
  ResponseDatabase database = punctured_sphere(true);
  EXPECT_NE(
      report_page(database, "a.h5").find("<th>puncture</th><td>the first membrane"),
      std::string::npos);
  database.tools[0].puncture = known_puncture(1);
  EXPECT_NE(report_page(database, "a.h5").find("needle of radius 0.75 mm, tip angle"),
            std::string::npos);
  database.tools[0].puncture = {};
  EXPECT_EQ(report_page(database, "a.h5").find("<th>puncture</th>"), std::string::npos);
}

TEST(ReportPage, AsksForNothingFromElsewhere) {
  const std::string page = report_page(small_database(), "a.h5");
  for (const char* way :
       {"http:", "https:", "src=", "href=", "import(", "fetch(", "url("}) {
    EXPECT_EQ(page.find(way), std::string::npos) << way;
  }
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
}

TEST(ReportPage, EscapesTextsOfTheFile) {
  ResponseDatabase database = small_database();
  database.provenance.scene_toml = "</pre></script><b>";
  database.provenance.left_out = "<i>\"a\" & b";
  const std::string page = report_page(database, "<u>.h5");
  EXPECT_EQ(page.find("</script><b>"), std::string::npos);
  EXPECT_EQ(page.find("<i>"), std::string::npos);
  EXPECT_EQ(page.find("<u>"), std::string::npos);
  EXPECT_NE(page.find("&lt;i&gt;&quot;a&quot; &amp; b"), std::string::npos);
}

TEST(ReportPage, IsWrittenByTheTool) {
  const ScratchFolder folder;
  write_database(folder / "a.h5", small_database());
  const ToolRun run = run_tool_process(
      "palpate-db", {"report", folder / "a.h5", "-o", folder / "a.html", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(parse_json(run.out).at("bytes"),
            std::filesystem::file_size(folder / "a.html"));
  EXPECT_EQ(run_tool_process("palpate-db",
                             {"report", folder / "a.h5", "-o", folder / "no/a.html"})
                .exit_code,
            2);
}

TEST(ThinBody, KeepsItsBoundAndAClosedSurface) {
  const SurfaceMesh body = sphere_database(60, 2).body;
  const ThinBody thin = thin_body(body, 1000);
  EXPECT_LE(std::ssize(thin.node), 1000);
  EXPECT_GT(std::ssize(thin.node), 250);
  ASSERT_GT(thin.triangle.rows(), 0);
  SurfaceMesh kept;
  kept.position_m.resize(std::ssize(thin.node), 3);
  for (std::size_t i = 0; i < thin.node.size(); ++i) {
    kept.position_m.row(static_cast<Eigen::Index>(i)) =
        body.position_m.row(thin.node[i]);
  }
  kept.triangle = thin.triangle;
  // Cells are a twentieth of the body or smaller: chords cut off a few per cent.
  EXPECT_NEAR(enclosed_volume_m3(kept) / enclosed_volume_m3(body), 1.0, 0.08);
}

TEST(ThinBody, LeavesASmallBodyAlone) {
  const SurfaceMesh body = octahedron(0.05);
  const ThinBody thin = thin_body(body, 6);
  EXPECT_EQ(thin.triangle, body.triangle);
  EXPECT_EQ(thin.node, (std::vector<std::int32_t>{0, 1, 2, 3, 4, 5}));
}

}  // namespace
}  // namespace palpate
