#include "runtime/view/served_news.h"

#include <chrono>
#include <fstream>
#include <memory>
#include <set>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "runtime/view/live_view.h"
#include "runtime/view/view_session.h"
#include "runtime/view/watch_view.h"
#include "tests/support/fake_clock.h"
#include "tests/support/fake_service.h"
#include "tests/support/sample_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

using std::chrono::milliseconds;
using Json = nlohmann::json;

const std::atomic<bool> kNever = false;

class Outbox : public ViewOutbox {
 public:
  void send(ViewClient, std::string text) override {
    sent.push_back(Json::parse(text));
  }
  void send_latest(ViewClient,
                   const std::shared_ptr<const std::string>& text) override {
    frame = Json::parse(*text);
  }
  std::vector<Json> sent;
  Json frame;
};

TEST(ServedNews, APageIsToldAnswersOnceAndPressesWhatIsThere) {
  const ResponseDatabase database = sample_database(
      plate(0.1, 10), ball(0.005, 0.0, 5e-4),
      [](Eigen::Index node, double d) {
        return (node % 2 == 0 ? 200.0 : 300.0) * d;
      },
      0.01);
  const ScratchFolder folder;
  std::atomic<bool> answers = false;
  FakeService service(folder / "s", [&](ServiceConnection& to, const auto& goes_on) {
    (void)to.send(served_scene(database), milliseconds(1000));
    while (goes_on() && !answers) {
      std::this_thread::sleep_for(milliseconds(2));
    }
    (void)to.send(served_responses(database, AnswerQuality::kCheap),
                  milliseconds(1000));
    (void)to.send(ServedProgress{.stage = "cheap answers", .nodes = 121, .cheap = 121},
                  milliseconds(1000));
    while (goes_on()) {
      std::this_thread::sleep_for(milliseconds(5));
    }
  });
  const auto file = folder / "scene.toml";
  std::ofstream(file) << "a scene";
  ServedClient client({.socket = folder / "s"});
  const ServedScene& scene = client.scene(kNever);
  const ResponseDatabase body = body_of(scene, client.tool());
  GrowingElements elements(body.body, body.normal, body.tools[0].tool);
  const Feeding feeding(client, elements);
  ViewSession session(body, {.growing = &elements});
  ServedNews news(client, elements, scene, SceneWatch(file));
  SimulatedClock wall;
  LiveView live(session, wall, &news);
  Outbox outbox;
  live.answer_through(outbox);
  live.opened(1);
  const auto frames = [&](int count, double height_m) {
    const Json point{
        {"type", "point"}, {"hold", true}, {"target_m", {0.001, 0.002, height_m}}};
    for (int k = 0; k < count; ++k) {
      wall.sleep_until_ns(wall.now_ns() + 50'000'000);
      live.received(1, point.dump());
      live.frame();
    }
  };
  // Grey: it is pressed, without a force, and that is said.
  frames(20, 0.002);
  EXPECT_EQ(outbox.frame["service"]["state"], "serving");
  EXPECT_EQ(outbox.frame["service"]["here"], "none");
  EXPECT_EQ(outbox.frame["service"]["changed"], false);
  EXPECT_GT(outbox.frame["penetration_m"], 0.002);
  EXPECT_EQ(outbox.frame["force_n"], Json({0.0, 0.0, 0.0}));
  EXPECT_EQ(outbox.sent.size(), 1U);  // the role

  answers = true;
  for (int i = 0; i < 500 && client.answers().all().size() < 121; ++i) {
    std::this_thread::sleep_for(milliseconds(10));
  }
  frames(30, 0.002);
  ASSERT_EQ(outbox.sent.size(), 2U);
  const Json& told = outbox.sent[1];
  EXPECT_EQ(told["type"], "answers");
  EXPECT_EQ(told["node"].size(), 121U);
  EXPECT_EQ(told["good"][0], 0);
  EXPECT_NEAR(told["stiffness"][1].get<double>(), 300.0, 0.01);
  EXPECT_NEAR(told["low_n_per_m"].get<double>(), 200.0, 0.01);
  EXPECT_NEAR(told["high_n_per_m"].get<double>(), 300.0, 0.01);
  EXPECT_NEAR(told["force_max_n"].get<double>(), 3.0, 1e-9);
  EXPECT_EQ(outbox.frame["service"]["here"], "cheap");
  EXPECT_EQ(outbox.frame["service"]["cheap"], 121);
  // A tool at rest is not pushed out: nobody has put in that energy.
  EXPECT_LT(outbox.frame["force_n"][2], 0.01);
  EXPECT_GT(outbox.frame["shift_m"], 0.002);
  frames(10, 0.01);
  frames(20, 0.002);
  EXPECT_GT(outbox.frame["force_n"][2], 0.2);  // the hand's 3 mm, less what it gives
  EXPECT_EQ(outbox.frame["shift_m"], 0.0);
  EXPECT_GE(outbox.frame["net_j"], 0.0);
  EXPECT_EQ(outbox.frame["fault"], "none");

  live.received(1, R"({"type":"node","node":1})");
  EXPECT_EQ(outbox.sent.back()["type"], "curve");
  EXPECT_NEAR(outbox.sent.back()["stiffness_max_n_per_m"].get<double>(), 300.0, 0.01);
  // Pages that watch a device are told the same, and may have it computed anew.
  const ViewedBody viewed{.database = body,
                          .table = body.tools[0],
                          .name = "scene.toml",
                          .device = "falcon",
                          .fast_hz = 1000.0,
                          .force_max_n = 8.0};
  const auto ticks = std::make_unique<TickQueue>();
  WatchView watch(viewed, {}, *ticks, nullptr, &news);
  Outbox watching;
  watch.answer_through(watching);
  watch.opened(7);
  watch.frame();
  EXPECT_EQ(watching.frame["service"]["state"], "serving");
  EXPECT_EQ(watching.frame["state"], "waiting for the device");
  ASSERT_EQ(watching.sent.size(), 2U);
  EXPECT_EQ(watching.sent[1]["type"], "answers");
  EXPECT_EQ(watching.sent[1]["node"].size(), 121U);
  watch.received(7, R"({"type":"node","node":1})");
  EXPECT_NEAR(watching.sent.back()["stiffness_max_n_per_m"].get<double>(), 300.0, 0.01);
  watch.received(7, R"({"type":"run","do":"anew"})");
  EXPECT_EQ(watching.sent.size(), 3U);  // no refusal
  watch.received(7, R"({"type":"run","do":"pause"})");
  EXPECT_EQ(watching.sent.back()["type"], "refused");
  watch.closed(7);

  live.opened(2);  // another page is told all
  frames(5, 0.002);
  EXPECT_EQ(outbox.sent.back()["node"].size(), 121U);
  live.received(1, R"({"type":"run","do":"anew"})");
  for (int i = 0; i < 200 && client.status().detail.empty(); ++i) {
    std::this_thread::sleep_for(milliseconds(10));
  }
  EXPECT_EQ(client.status().detail, "no service can be started from here");
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
  Outbox outbox;
  live.answer_through(outbox);
  live.opened(1);
  live.received(1, R"({"type":"run","do":"anew"})");
  EXPECT_EQ(outbox.sent.back()["type"], "refused");
  live.frame();
  EXPECT_FALSE(outbox.frame.contains("service"));
}

}  // namespace
}  // namespace palpate
