// A body that a page holds by itself: the same requests give what the live view gives.
#include "runtime/view/page_body.h"

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "runtime/view/view_json.h"
#include "tests/support/fake_clock.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

using Json = nlohmann::json;

constexpr std::int64_t kFrameNs = 16'666'667;

ResponseDatabase soft_plate() {
  return sample_database(
      plate(0.1, 10), ball(0.005, 0.3, 5e-4),
      [](Eigen::Index, double d) {
        return 200.0 * d;
      },
      0.01);
}

// What a page says frame by frame: a press that slides, and a setting.
std::vector<std::string> requests() {
  std::vector<std::string> all;
  for (int i = 0; i < 90; ++i) {
    all.push_back(
        fmt::format(R"({{"type":"point","hold":true,"target_m":[{:.6f},0.002,0.002]}})",
                    0.001 + 1e-4 * i));
  }
  all.push_back(R"({"type":"set","stiffness_scale":2})");
  all.push_back(R"({"type":"node","node":12})");
  all.push_back(R"({"type":"point","hold":false})");
  return all;
}

// All that a page is told, in order.
std::vector<std::string> told(PageBody& page) {
  std::vector<std::string> all;
  while (std::optional<std::string> text = page.take()) {
    all.push_back(std::move(*text));
  }
  return all;
}

// What is told, without what the machine's clock measured. A page of its own can have a
// device.
std::vector<Json> parsed(const std::vector<std::string>& texts) {
  std::vector<Json> all;
  for (const std::string& text : texts) {
    all.push_back(Json::parse(text));
    if (all.back().erase("device") > 0) {
      EXPECT_EQ(Json::parse(text)["device"]["phase"], "off");
    }
    all.back()["run"]["step_p50_ns"] = all.back()["run"]["step_p99_ns"] = nullptr;
  }
  return all;
}

class Messages : public ViewOutbox {
 public:
  void send(ViewClient /*client*/, std::string text) override {
    all.push_back(std::move(text));
  }
  void send_latest(ViewClient /*client*/,
                   const std::shared_ptr<const std::string>& text) override {
    all.push_back(*text);
  }
  std::vector<std::string> all;
};

TEST(PageBody, TellsWhatTheLiveViewTells) {
  const ResponseDatabase database = soft_plate();
  ViewSession session(database, {});
  session.set({.stiffness_scale = 1.0});
  FakeClock wall;
  LiveView view(session, wall);
  Messages served;
  view.answer_through(served);
  view.opened(1);
  PageBody page(soft_plate(), "plate", {});
  std::vector<std::string> inside = told(page);
  EXPECT_EQ(inside, std::vector<std::string>{role_text(true)});
  std::int64_t now_ns = 5;
  for (const std::string& request : requests()) {
    now_ns += kFrameNs;
    view.received(1, request);
    wall.sleep_until_ns(now_ns);
    view.frame();
    page.receive(request);
    page.frame(now_ns);
    for (std::string& text : told(page)) {
      inside.push_back(std::move(text));
    }
  }
  EXPECT_EQ(parsed(inside), parsed(served.all));
  EXPECT_GT(Json::parse(inside[90])["force_n"][2].get<double>(), 0.1);
  EXPECT_EQ(page.text(), body_text(viewed(session, "plate")));
  EXPECT_EQ(page.bytes(), body_bytes(database, session.table()));
}

TEST(PageBody, KeepsAnswersAndTheLatestFrameUntilTheyAreTaken) {
  PageBody page(soft_plate(), "plate", {});
  for (int i = 1; i <= 3; ++i) {
    page.receive("no message");
    page.frame(i * kFrameNs);
  }
  const std::vector<std::string> all = told(page);
  ASSERT_EQ(all.size(), 5U);  // a role, three refusals, a frame
  EXPECT_EQ(Json::parse(all[3])["type"], "refused");
  // A first frame takes no time: the page's clock starts anywhere.
  EXPECT_EQ(Json::parse(all[4])["run"]["ticks"], 66);  // of 2 kHz in two sixtieths
  EXPECT_FALSE(page.take());
}

TEST(PageBody, AToolThatIsNotThereIsNamed) {
  EXPECT_THROW(PageBody(soft_plate(), "plate", {.tools = {"needle"}}), InputError);
}

}  // namespace
}  // namespace palpate
