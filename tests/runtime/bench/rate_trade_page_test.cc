// The trade study's page in a browser, skipped where there is none.
#include "runtime/bench/rate_trade_page.h"

#include <gtest/gtest.h>

#include "tests/support/page_visit.h"

namespace palpate {
namespace {

// Two devices, two models, three slow rates; the stiffness is the row's number.
std::vector<RateTradeRow> rate_rows() {
  std::vector<RateTradeRow> all;
  for (const char* device : {"pencat", "falcon"}) {
    for (const LocalModel model : {LocalModel::kSingle, LocalModel::kPotential}) {
      for (const double slow_hz : {10.0, 100.0, 2000.0}) {
        all.push_back(
            {.device = device,
             .model = model,
             .fast_hz = 2000.0,
             .slow_hz = slow_hz,
             .stable_stiffness_n_per_m = 1.0 + static_cast<double>(all.size()),
             .rms_relative_error = 0.0,
             .net_energy_j = -1e-3});
      }
    }
  }
  return all;
}

constexpr const char* kVisit = R"js(
  const all = query => Array.from(document.querySelectorAll(query), e => e.textContent);
  const choose = (id, value) => {
    const select = document.getElementById(id);
    select.value = value;
    select.dispatchEvent(new Event('change'));
  };
  const shown = () => ({cells: all('td'), marks: all('circle title'), lines: document.querySelectorAll('#plot .line').length,
    broken: document.getElementById('plot').innerHTML.includes('NaN')});
  seen.first = shown();
  choose('device', 'falcon');
  seen.falcon = shown();
  choose('what', 'energy');
  seen.energy = shown();
  choose('what', 'error');
  seen.error = shown();
  seen.names = all('#key span');
)js";

TEST(TradePage, ShowsTheRowsOfWhatIsChosen) {
  if (page_browser().empty()) {
    GTEST_SKIP() << "no chromium-headless-shell and no chromium";
  }
  const PageVisit visit = visit_page(trade_page(rate_rows()), kVisit);
  EXPECT_EQ(visit.complaints, "");
  ASSERT_TRUE(visit.seen.is_object());
  const nlohmann::json& seen = visit.seen;
  using List = std::vector<std::string>;
  // By slow rate, in it by model.
  EXPECT_EQ(seen["first"]["cells"], (List{"1", "4", "2", "5", "3", "6"}));
  EXPECT_EQ(seen["first"]["marks"][2], "single, 2000 Hz: 3");
  EXPECT_EQ(seen["falcon"]["cells"], (List{"7", "10", "8", "11", "9", "12"}));
  EXPECT_EQ(seen["energy"]["cells"], List(6, "-1"));
  EXPECT_EQ(seen["error"]["cells"], List(6, "0"));
  for (const char* kind : {"first", "falcon", "energy", "error"}) {
    EXPECT_EQ(seen[kind]["lines"], 2) << kind;
    EXPECT_EQ(seen[kind]["broken"], false) << kind;
  }
  EXPECT_EQ(seen["names"], (List{"single", "potential"}));
  EXPECT_EQ(seen["requests"], 0);
}

TEST(TradePage, AsksForNothingFromElsewhere) {
  const std::string page = trade_page(rate_rows());
  for (const char* way : {"http:", "https:", "src=", "href=", "import(", "fetch("}) {
    EXPECT_EQ(page.find(way), std::string::npos) << way;
  }
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
}

}  // namespace
}  // namespace palpate
