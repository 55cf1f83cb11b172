// The page of a batch, in a browser.
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "tests/support/batch_folder.h"
#include "tests/support/page_visit.h"

namespace palpate {
namespace {

class BatchPage : public BatchFolder {};

TEST_F(BatchPage, ThePageShowsWhereOnTheBodyItWasMeasured) {
  write("a.csv", synthetic({}, 1));
  write("b.csv", synthetic({}, 2));
  write("c.csv", "nothing");
  write("sheet.obj", "v 0 0 0\nv 100 0 0\nv 100 100 0\nv 0 100 0\nf 1 2 3\nf 1 3 4\n");
  const auto page_of = [&](const std::string& mesh) {
    write("session.toml",
          fmt::format("{}{}[body]\nmesh = \"{}\"\nlength_unit = \"mm\"\n"
                      "[[run]]\nfiles = [\"a.csv\", \"b.csv\"]\n"
                      "position_m = [0.03, 0.04, 0.001]\n[[run]]\nfiles = \"c.csv\"\n"
                      "position_m = [0.07, 0.02, 0.0]\n",
                      kRead, kFamilies, mesh));
    const Session s = read_session(folder_ / "session.toml");
    return batch_page(s, fit_session(s, 1, [](std::size_t) {}));
  };
  const std::string page = page_of("sheet.obj");
  const std::string head = "<script type=\"application/json\" id=\"info\">";
  const std::size_t begin = page.find(head);
  ASSERT_NE(begin, std::string::npos);
  const std::size_t from = begin + head.size();
  const auto info = parse_json(page.substr(from, page.find("</script>", from) - from));
  ASSERT_EQ(info["points"].size(), 2U);
  const auto& two = info["points"][0];
  EXPECT_NEAR(two["position_m"][2].get<double>(), 0.0, 1e-12);  // on the sheet
  EXPECT_EQ(two["runs"].size(), 2U);
  EXPECT_EQ(two["runs"][1]["name"], "b.csv");
  EXPECT_EQ(two["verdict"], "use");
  EXPECT_GT(two["stiffness_n_per_m"].get<double>(), 100.0);
  EXPECT_EQ(info["points"][1]["verdict"], "skip");
  EXPECT_TRUE(info["points"][1]["stiffness_n_per_m"].is_null());
  EXPECT_NE(page.find("<article id=\"run1\">"), std::string::npos);
  EXPECT_NE(page_of("absent.obj").find("No map of the body: "), std::string::npos);
  if (page_browser().empty()) {
    GTEST_SKIP() << "no chromium-headless-shell and no chromium";
  }
  const PageVisit visit = visit_page(page, R"js(
    const canvas = document.getElementById('body');
    canvas.dispatchEvent(new KeyboardEvent('keydown', {key: 'n', bubbles: true}));
    seen.said = document.getElementById('said').textContent;
    seen.legend = document.getElementById('legend').textContent;
  )js");
  EXPECT_EQ(visit.complaints, "");
  ASSERT_TRUE(visit.seen.is_object());
  EXPECT_NE(visit.seen["said"].get<std::string>().find("b.csv: use"),
            std::string::npos);
  EXPECT_NE(visit.seen["legend"].get<std::string>().find("skip: 1"), std::string::npos);
}

}  // namespace
}  // namespace palpate
