#include "runtime/view/served_news.h"

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <set>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "runtime/view/live_view.h"
#include "runtime/view/view_session.h"
#include "runtime/view/watch_view.h"
#include "tests/support/comes_true.h"
#include "tests/support/fake_clock.h"
#include "tests/support/fake_service.h"
#include "tests/support/sample_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

using std::chrono::milliseconds;
using Json = nlohmann::json;

const std::atomic<bool> kNever = false;

class NewsOutbox : public ViewOutbox {
 public:
  void send(ViewClient, std::string text) override { sent.push_back(parse_json(text)); }
  void send_latest(ViewClient,
                   const std::shared_ptr<const std::string>& text) override {
    frame = parse_json(*text);
  }
  std::vector<Json> sent;
  Json frame;
};

// A page that presses a plate, whose responses come once let_answer() was called.
class ServedPage : public testing::Test {
 protected:
  ServedPage() {
    std::ofstream(file_) << "a scene";
    live_.answer_through(outbox_);
    live_.opened(1);
  }

  void serve(ServiceConnection& to, const std::function<bool()>& goes_on) {
    (void)to.send(served_scene(database_), milliseconds(1000));
    while (goes_on() && !answers_) {
      std::this_thread::sleep_for(milliseconds(2));
    }
    (void)to.send(served_responses(database_, AnswerQuality::kPreliminary),
                  milliseconds(1000));
    (void)to.send(
        ServedProgress{.stage = "preliminary answers", .nodes = 121, .answered = 121},
        milliseconds(1000));
    while (goes_on()) {
      std::this_thread::sleep_for(milliseconds(5));
    }
  }

  void let_answer() {
    answers_ = true;
    ASSERT_TRUE(comes_true(
        [&] {
          return client_.answers().all().size() == 121;
        },
        milliseconds(5000)));
  }

  // The page holds the tool there.
  void frames(int count, double height_m) {
    const Json point{
        {"type", "point"}, {"hold", true}, {"target_m", {0.001, 0.002, height_m}}};
    for (int k = 0; k < count; ++k) {
      wall_.sleep_until_ns(wall_.now_ns() + 50'000'000);
      live_.received(1, json_text(point));
      live_.frame();
    }
  }

  const ResponseDatabase database_ = sample_database(
      plate(0.1, 10), ball(0.005, 0.0, 5e-4),
      [](Eigen::Index node, double d) {
        return (node % 2 == 0 ? 200.0 : 300.0) * d;
      },
      0.01);
  const ScratchFolder folder_;
  const std::filesystem::path file_ = folder_ / "scene.toml";
  std::atomic<bool> answers_ = false;
  FakeService service_{folder_ / "s", [this](auto& to, const auto& goes_on) {
                         serve(to, goes_on);
                       }};
  ServedClient client_{{.socket = folder_ / "s"}};
  const ServedScene& scene_ = client_.scene(kNever);
  const ResponseDatabase body_ = body_of(scene_, client_.tool());
  GrowingElements elements_{body_.body, body_.normal, body_.tools[0].tool};
  const Feeding feeding_{client_, elements_};
  ViewSession session_{body_, {.growing = &elements_}};
  ServedNews news_{client_, elements_, scene_, SceneWatch(file_)};
  SimulatedClock wall_;
  LiveView live_{session_, wall_, &news_};
  NewsOutbox outbox_;
};

TEST_F(ServedPage, PressesGreyPlacesWithoutAForceAndSaysSo) {
  frames(20, 0.002);
  EXPECT_EQ(outbox_.frame["service"]["state"], "serving");
  EXPECT_EQ(outbox_.frame["service"]["here"], "none");
  EXPECT_EQ(outbox_.frame["service"]["changed"], false);
  EXPECT_GT(outbox_.frame["penetration_m"], 0.002);
  EXPECT_EQ(outbox_.frame["force_n"], Json({0.0, 0.0, 0.0}));
  EXPECT_EQ(outbox_.sent.size(), 1U);  // the role
}

TEST_F(ServedPage, IsToldAnswersOnce) {
  let_answer();
  frames(30, 0.01);
  ASSERT_EQ(outbox_.sent.size(), 2U);
  const Json& told = outbox_.sent[1];
  EXPECT_EQ(told["type"], "answers");
  EXPECT_EQ(told["node"].size(), 121U);
  EXPECT_EQ(told["final"][0], 0);
  EXPECT_NEAR(told["stiffness"][1].get<double>(), 300.0, 0.01);
  EXPECT_NEAR(told["low_n_per_m"].get<double>(), 200.0, 0.01);
  EXPECT_NEAR(told["high_n_per_m"].get<double>(), 300.0, 0.01);
  EXPECT_NEAR(told["force_max_n"].get<double>(), 3.0, 1e-9);
  // Counts of the service come by themselves.
  for (int i = 0; i < 1000 && outbox_.frame["service"]["answered"] != 121; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    frames(1, 0.01);
  }
  EXPECT_EQ(outbox_.frame["service"]["answered"], 121);
  live_.received(1, R"({"type":"node","node":1})");
  EXPECT_EQ(outbox_.sent.back()["type"], "curve");
  EXPECT_NEAR(outbox_.sent.back()["stiffness_max_n_per_m"].get<double>(), 300.0, 0.01);
}

// A tool at rest is not pushed out: nobody has put in that energy.
TEST_F(ServedPage, FeelsWhatCameUnderTheToolAtTheNextPress) {
  frames(20, 0.002);
  let_answer();
  frames(30, 0.002);
  EXPECT_EQ(outbox_.frame["service"]["here"], "preliminary");
  EXPECT_LT(outbox_.frame["force_n"][2], 0.01);
  EXPECT_GT(outbox_.frame["shift_m"], 0.002);
  frames(10, 0.01);
  frames(20, 0.002);
  EXPECT_GT(outbox_.frame["force_n"][2], 0.2);  // the hand's 3 mm, less what it gives
  EXPECT_EQ(outbox_.frame["shift_m"], 0.0);
  EXPECT_GE(outbox_.frame["net_j"], 0.0);
  EXPECT_EQ(outbox_.frame["fault"], "none");
}

// Pages that watch a device are told the same, and the oldest may have it computed
// anew.
TEST_F(ServedPage, WatchesADeviceAsWell) {
  let_answer();
  const ViewedBody viewed{.database = body_,
                          .table = body_.tools[0],
                          .name = "scene.toml",
                          .device = "falcon",
                          .fast_hz = 1000.0,
                          .force_max_n = 8.0};
  const auto ticks = std::make_unique<TickQueue>();
  WatchView watch(viewed, {}, *ticks, &news_);
  watch.answer_through(outbox_);
  outbox_.sent.clear();
  watch.opened(7);
  watch.frame();
  EXPECT_EQ(outbox_.frame["service"]["state"], "serving");
  EXPECT_EQ(outbox_.frame["state"], "waiting for the device");
  ASSERT_EQ(outbox_.sent.size(), 2U);
  EXPECT_EQ(outbox_.sent[1]["type"], "answers");
  EXPECT_EQ(outbox_.sent[1]["node"].size(), 121U);
  watch.received(7, R"({"type":"node","node":1})");
  EXPECT_NEAR(outbox_.sent.back()["stiffness_max_n_per_m"].get<double>(), 300.0, 0.01);
  watch.opened(8);
  outbox_.sent.clear();
  watch.received(8, R"({"type":"run","do":"anew"})");
  EXPECT_EQ(outbox_.sent.back()["type"], "refused");  // the older page's to say
  watch.closed(8);
  outbox_.sent.clear();
  watch.received(7, R"({"type":"run","do":"anew"})");
  EXPECT_TRUE(outbox_.sent.empty());  // no refusal
  watch.received(7, R"({"type":"run","do":"pause"})");
  EXPECT_EQ(outbox_.sent.back()["type"], "refused");
  watch.closed(7);
}

TEST_F(ServedPage, AnotherOneIsToldAllAndMayAskToStartAnew) {
  let_answer();
  frames(5, 0.01);
  live_.opened(2);
  frames(5, 0.01);
  EXPECT_EQ(outbox_.sent.back()["node"].size(), 121U);
  live_.received(1, R"({"type":"run","do":"anew"})");
  EXPECT_TRUE(comes_true(
      [&] {
        return client_.status().detail == "no service can be started from here";
      },
      milliseconds(2000)));
}

TEST(ServedNews, ABodyThatIsWholeIsNotStartedAnew) {
  const ResponseDatabase database = sample_database(
      plate(0.1, 4), ball(0.005, 0.0, 5e-4),
      [](Eigen::Index, double d) {
        return 200.0 * d;
      },
      0.01);
  ViewSession session(database, {});
  SimulatedClock wall;
  LiveView live(session, wall);
  NewsOutbox outbox;
  live.answer_through(outbox);
  live.opened(1);
  live.received(1, R"({"type":"run","do":"anew"})");
  EXPECT_EQ(outbox.sent.back()["type"], "refused");
  live.frame();
  EXPECT_FALSE(outbox.frame.contains("service"));
}

}  // namespace
}  // namespace palpate
