// The live view without a network: who steers, what silence does, and that its forces
// are the body's.
#include "runtime/view/live_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "runtime/view/view_json.h"
#include "runtime/view/view_session.h"
#include "tests/support/fake_clock.h"
#include "tests/support/said.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

constexpr double kRadius = 0.005;
constexpr double kStiffness = 200.0;  // [N/m] of every node

class Outbox : public ViewOutbox {
 public:
  void send(ViewClient client, std::string text) override {
    sent[client] = std::move(text);
  }
  void send_latest(ViewClient client,
                   const std::shared_ptr<const std::string>& text) override {
    frame[client] = *text;
  }
  std::map<ViewClient, std::string> sent;
  std::map<ViewClient, std::string> frame;
};

class LiveViewTest : public testing::Test {
 protected:
  LiveViewTest() { view_.answer_through(outbox_); }

  static ViewSessionOptions options() {
    ViewSessionOptions o;
    o.device.coulomb_n = 0.0;
    o.device.resolution_m = 0.0;
    return o;
  }

  // Wall time in frames of a sixtieth of a second; the holder speaks in each.
  void pass(double seconds, const std::string& says = "", ViewClient client = 1) {
    for (int i = 0; i < static_cast<int>(60.0 * seconds); ++i) {
      if (!says.empty()) {
        view_.received(client, says);
      }
      wall_.sleep_until_ns(wall_.now_ns() + 16'666'667);
      view_.frame();
    }
  }

  [[nodiscard]] double force_n() const {
    const auto& f = session_.latest().force_n;
    return std::hypot(f[0], f[1], f[2]);
  }

  // The hand 3 mm below touch in the middle of the plate.
  const std::string press_ =
      R"({"type":"point","hold":true,"target_m":[0.001,0.002,0.002]})";
  ResponseDatabase database_ = sample_database(
      plate(0.1, 10), ball(kRadius, 0.3, 5e-4),
      [](Eigen::Index, double d) {
        return kStiffness * d;
      },
      0.01);
  ViewSession session_{database_, options()};
  FakeClock wall_{1};
  LiveView view_{session_, wall_};
  Outbox outbox_;
};

TEST_F(LiveViewTest, TheToolRestsWhereBodyAndGripBalance) {
  view_.opened(1);
  pass(2.0, press_);
  // k d = k_h (3 mm - d)
  const double grip = session_.options().device.hand_n_per_m;
  const double depth = 0.003 * grip / (grip + kStiffness);
  EXPECT_NEAR(session_.latest().depth_m, depth, 1e-6);
  EXPECT_NEAR(session_.latest().force_n[2], kStiffness * depth, 2e-4);
  EXPECT_TRUE(contains(outbox_.frame[1], "\"state\":\"pressing\""));
}

TEST_F(LiveViewTest, LettingGoGivesZeroForce) {
  view_.opened(1);
  pass(1.0, press_);
  EXPECT_GT(force_n(), 0.1);
  view_.received(1, R"({"type":"point","hold":false})");
  pass(1.0);
  EXPECT_EQ(force_n(), 0.0);
  EXPECT_GE(session_.report().model_work_j, -1e-12);
  EXPECT_TRUE(contains(outbox_.frame[1], "\"state\":\"free\""));
}

TEST_F(LiveViewTest, APageThatFallsSilentHasLetGo) {
  view_.opened(1);
  pass(1.0, press_);
  pass(0.9);
  EXPECT_TRUE(session_.holding());
  pass(0.2);
  EXPECT_FALSE(session_.holding());
  pass(1.0);
  EXPECT_EQ(force_n(), 0.0);
  EXPECT_TRUE(contains(outbox_.frame[1], "let go: page silent"));
}

TEST_F(LiveViewTest, AClosedPageHasLetGo) {
  view_.opened(1);
  pass(1.0, press_);
  view_.closed(1);
  EXPECT_FALSE(session_.holding());
}

TEST_F(LiveViewTest, ASecondPageWatchesUntilTheFirstIsGone) {
  view_.opened(1);
  view_.opened(2);
  EXPECT_TRUE(contains(outbox_.sent[1], "controller"));
  EXPECT_TRUE(contains(outbox_.sent[2], "watcher"));
  for (const std::string& order :
       {press_, std::string(R"({"type":"set","slow_hz":10})"),
        std::string(R"({"type":"run","do":"pause"})")}) {
    outbox_.sent.clear();
    view_.received(2, order);
    EXPECT_TRUE(contains(outbox_.sent[2], "refused")) << order;
  }
  EXPECT_FALSE(session_.holding());
  EXPECT_EQ(session_.options().slow_hz, 100.0);
  pass(0.1);
  EXPECT_EQ(outbox_.frame[1], outbox_.frame[2]);
  view_.closed(1);
  EXPECT_TRUE(contains(outbox_.sent[2], "controller"));
  pass(0.5, press_, 2);
  EXPECT_TRUE(session_.holding());
}

TEST_F(LiveViewTest, AMalformedMessageIsAnsweredAndChangesNothing) {
  view_.opened(1);
  view_.received(1, R"({"type":"set","slow_hz":1e9})");
  EXPECT_TRUE(contains(outbox_.sent[1], "refused"));
  EXPECT_EQ(session_.options().slow_hz, 100.0);
  view_.received(1, R"({"type":"node","node":100000})");
  EXPECT_TRUE(contains(outbox_.sent[1], "is not there"));
  view_.received(1, R"({"type":"device","do":"keep"})");
  EXPECT_TRUE(contains(outbox_.sent[1], "this page has no device"));
}

TEST_F(LiveViewTest, TimeStandsStillWhilePausedAndAStepIsASlowPeriod) {
  view_.opened(1);
  pass(0.1);
  view_.received(1, R"({"type":"run","do":"pause"})");
  const std::int64_t ticks = session_.report().ticks;
  pass(1.0);
  EXPECT_EQ(session_.report().ticks, ticks);
  view_.received(1, R"({"type":"run","do":"step"})");
  EXPECT_EQ(session_.report().ticks, ticks + 20);
  view_.received(1, R"({"type":"run","do":"resume"})");
  pass(0.5);
  EXPECT_NEAR(static_cast<double>(session_.report().ticks - ticks), 20.0 + 1000.0, 2.0);
}

TEST_F(LiveViewTest, ALateMachineLosesTimeInsteadOfLeaping) {
  view_.opened(1);
  pass(0.1);
  const std::int64_t ticks = session_.report().ticks;
  wall_.sleep_until_ns(wall_.now_ns() + 5'000'000'000);
  view_.frame();
  EXPECT_NEAR(static_cast<double>(session_.report().ticks - ticks), 200.0, 1.0);
}

TEST_F(LiveViewTest, ALateMachineDoesNotMakeThePageSilent) {
  view_.opened(1);
  pass(1.0, press_);
  wall_.sleep_until_ns(wall_.now_ns() + 2'000'000'000);
  view_.frame();  // before what the page said meanwhile is read
  EXPECT_TRUE(session_.holding());
}

TEST_F(LiveViewTest, SettingsChangeTheForceWhilePressing) {
  view_.opened(1);
  pass(1.0, press_);
  const double before = force_n();
  view_.received(1, R"({"type":"set","stiffness_scale":0.5})");
  pass(1.0, press_);
  const double grip = session_.options().device.hand_n_per_m;
  const double k = 0.5 * kStiffness;
  EXPECT_NEAR(session_.latest().force_n[2], k * 0.003 * grip / (grip + k), 2e-4);
  EXPECT_LT(force_n(), before);
  for (const LocalModel model : kLocalModels) {
    view_.received(1, fmt::format(R"({{"type":"set","model":"{}"}})", name(model)));
    pass(0.5, press_);
    EXPECT_EQ(session_.report().fault, Fault::kNone) << name(model);
    EXPECT_GT(force_n(), 0.0) << name(model);
  }
  view_.received(1, R"({"type":"run","do":"reset"})");
  EXPECT_FALSE(session_.holding());
  EXPECT_EQ(session_.frame().settings.stiffness_scale, 0.5);
}

// What one page did, done again: to the same bits, and with another body.
TEST_F(LiveViewTest, ARecordedHandIsReplayedToTheBit) {
  view_.opened(1);
  view_.received(1, R"({"type":"run","do":"replay"})");
  EXPECT_TRUE(contains(outbox_.sent[1], "nothing is recorded"));
  pass(0.3, press_);
  const auto poke = [&](const std::string& press) {
    std::vector<std::array<double, 3>> force_n;
    for (int i = 0; i < 120; ++i) {
      pass(1.0 / 60.0, i >= 20 && i < 80 ? press : "");
      if (i == 80 && !press.empty()) {
        view_.received(1, R"({"type":"point","hold":false})");
      }
      force_n.push_back(session_.latest().force_n);
    }
    return force_n;
  };
  view_.received(1, R"({"type":"run","do":"record"})");
  const auto first = poke(press_);
  EXPECT_TRUE(contains(outbox_.frame[1], R"("tape":"recording")"));
  view_.received(1, R"({"type":"run","do":"record"})");
  pass(0.3);
  EXPECT_TRUE(contains(outbox_.frame[1], R"("tape":"recorded")"));
  view_.received(1, R"({"type":"run","do":"replay"})");
  const auto second = poke("");
  double most_n = 0.0;
  for (const auto& f : first) {
    most_n = std::max(most_n, f[2]);
  }
  EXPECT_GT(most_n, 0.1);
  EXPECT_EQ(first, second);
  pass(0.1);
  EXPECT_TRUE(contains(outbox_.frame[1], R"("tape":"recorded")"));
  EXPECT_FALSE(session_.holding());
  view_.received(1, R"({"type":"set","stiffness_scale":0.5})");
  view_.received(1, R"({"type":"run","do":"replay"})");
  EXPECT_NE(poke(""), first);
}

TEST_F(LiveViewTest, ThePagesHandEndsAReplay) {
  view_.opened(1);
  view_.received(1, R"({"type":"run","do":"record"})");
  pass(1.0, press_);
  view_.received(1, R"({"type":"run","do":"replay"})");
  pass(0.2);
  EXPECT_TRUE(contains(outbox_.frame[1], R"("tape":"playing")"));
  pass(0.1, press_);
  EXPECT_TRUE(contains(outbox_.frame[1], R"("tape":"recorded")"));
  EXPECT_TRUE(session_.holding());
}

TEST_F(LiveViewTest, TheBodysBytesHaveTheirLayout) {
  const std::string bytes = body_bytes(database_, database_.tools[0]);
  const auto n = static_cast<std::size_t>(database_.body.position_m.rows());
  const auto t = static_cast<std::size_t>(database_.body.triangle.rows());
  EXPECT_EQ(bytes.size(), 12 + 4 * (8 * n + 3 * t));
  EXPECT_EQ(bytes.substr(0, 4), "PLPB");
}

TEST_F(LiveViewTest, EveryPageMayAskForCurvesAndFields) {
  view_.opened(1);
  view_.opened(2);
  view_.received(2, R"({"type":"node","node":3})");
  EXPECT_TRUE(contains(outbox_.sent[2], R"("type":"curve")"));
  view_.received(2, R"({"type":"field","node":3})");
  EXPECT_TRUE(contains(outbox_.sent[2], R"("type":"field")"));
  view_.received(2, R"({"type":"field","node":121})");
  EXPECT_TRUE(contains(outbox_.sent[2], "node 121 is not there, the body has 121"));
}

TEST_F(LiveViewTest, ATextFromAFileCannotBreakTheMessage) {
  database_.provenance.source_file = "\xff\"</script>";
  const ViewedBody body{.database = database_,
                        .table = database_.tools[0],
                        .name = "a\"b\n",
                        .device = "",
                        .fast_hz = 2000.0,
                        .force_max_n = 8.0};
  EXPECT_TRUE(contains(body_text(body), R"(a\"b\n)"));
}

TEST_F(LiveViewTest, AToolOfSeveralContactsIsNotShownAsOne) {
  ContactSet& contact = database_.tools[0].tool.contact;
  contact.point_m.resize(2, 3);
  contact.point_m << 0.0, 0.0, 0.0, 0.01, 0.0, 0.0;
  contact.radius_m = {kRadius, kRadius};
  try {
    const ViewSession refused(database_, options());
    FAIL() << "two contacts were shown as one";
  } catch (const InputError& e) {
    EXPECT_TRUE(contains(e.what(), "which 2 contacts on one body need")) << e.what();
  }
}

}  // namespace
}  // namespace palpate
