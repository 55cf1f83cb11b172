#include "runtime/served/served_client.h"

#include <chrono>
#include <functional>
#include <memory>
#include <thread>

#include <gtest/gtest.h>
#include <sys/socket.h>

#include "formats/base/error.h"
#include "tests/support/comes_true.h"
#include "tests/support/fake_service.h"
#include "tests/support/served_plate.h"

namespace palpate {
namespace {

using std::chrono::milliseconds;

class ServedClientOfPlate : public ServedPlate {};

TEST_F(ServedClientOfPlate, TakesSceneAndAnswersAndTellsWhereTheHandIs) {
  FakeService* at = nullptr;
  FakeService service(socket_, plain(at));
  at = &service;
  ServedClient client(options());
  const ServedScene& scene = client.scene(kNever);
  EXPECT_EQ(scene.plan.body.position_m.rows(), 49);
  const ResponseDatabase body = body_of(scene, client.tool());
  EXPECT_EQ(body.tools[0].depth_max_m(), 0.0);
  GrowingElements elements(body.body, body.normal, body.tools[0].tool);
  client.feed(elements);
  ASSERT_TRUE(comes_true(
      [&] {
        return client.answers().all().size() == 49;
      },
      milliseconds(2000)));
  EXPECT_EQ(client.status().answers, 49);
  EXPECT_EQ(state(client), ServiceState::kServing);
  EXPECT_EQ(client.answers().at(3)->node->response.depth_m.size(), 21U);
  EXPECT_FALSE(client.answers().at(49));
  std::size_t changes = 0;
  EXPECT_EQ(client.answers().changed_since(changes).size(), 49U);
  EXPECT_TRUE(client.answers().changed_since(changes).empty());

  auto fifo = std::make_unique<ElementFifo>();
  for (std::uint64_t i = 1; i <= 100; ++i) {  // every 2 ms: 0.2 s
    elements.update({.sequence = i,
                     .time_ns = static_cast<std::int64_t>(i) * 2'000'000,
                     .position_m = {0.0, 0.0, 0.01}},
                    static_cast<std::int64_t>(i) * 2'000'000, *fifo);
    while (fifo->front() != nullptr) {
      fifo->pop();
    }
    std::this_thread::sleep_for(milliseconds(2));
  }
  EXPECT_TRUE(comes_true(
      [&] {
        return !service.hands().empty();
      },
      milliseconds(2000)));
  const auto hands = service.hands();
  ASSERT_FALSE(hands.empty());
  EXPECT_LE(hands.size(), 12U);  // 20 a second, however slow this machine: 0.6 s
  EXPECT_EQ(hands.back().position_m.z(), 0.01);
  EXPECT_EQ(elements.quality(0), GrownQuality::kPreliminary);
  client.forget(elements);
}

TEST_F(ServedClientOfPlate, GoesOnWhenTheServiceDiesAndJoinsTheNextOne) {
  FakeService* at = nullptr;
  auto service = std::make_unique<FakeService>(socket_, plain(at));
  at = service.get();
  ServedClient client(options());
  (void)client.scene(kNever);
  ASSERT_TRUE(comes_true(
      [&] {
        return client.answers().all().size() == 49;
      },
      milliseconds(2000)));
  service->die();
  ASSERT_TRUE(comes_true(
      [&] {
        return state(client) == ServiceState::kLost;
      },
      milliseconds(1000)));
  EXPECT_EQ(client.answers().all().size(), 49U);
  const auto answers = client.status().answers;
  at = nullptr;
  service = std::make_unique<FakeService>(socket_, plain(at));
  at = service.get();
  ASSERT_TRUE(comes_true(
      [&] {
        return state(client) == ServiceState::kServing && client.status().joins == 2;
      },
      milliseconds(3000)));
  EXPECT_EQ(client.status().answers, answers);  // the same again are no news
}

TEST_F(ServedClientOfPlate, NonsenseEndsTheConnectionAndNothingOfItIsUsed) {
  int joins = 0;
  FakeService service(socket_, [&](ServiceConnection& to, const GoesOn&) {
    (void)to.send(served_scene(database_), milliseconds(1000));
    ServedResponses responses = served_responses(database_, AnswerQuality::kFinal);
    switch (++joins) {
      case 1: {  // one index that the body does not have, the last of all
        responses.node.back().vertex = 49;
        (void)to.send(responses, milliseconds(1000));
        break;
      }
      case 2: {  // bytes
        const std::string text = "HTTP/1.1 200 OK\r\n\r\n";
        (void)to.send(std::as_bytes(std::span(text)), milliseconds(1000));
        break;
      }
      default:
        (void)to.send(responses, milliseconds(1000));
    }
    std::this_thread::sleep_for(milliseconds(300));
  });
  ServedClient client(options());
  (void)client.scene(kNever);
  ASSERT_TRUE(comes_true(
      [&] {
        return state(client) == ServiceState::kNonsense;
      },
      milliseconds(1000)));
  EXPECT_NE(client.status().detail.find("vertex 49"), std::string::npos);
  EXPECT_TRUE(client.answers().all().empty());
  EXPECT_TRUE(comes_true(
      [&] {
        return client.status().detail.find("not of a palpate service") !=
               std::string::npos;
      },
      milliseconds(2000)));
  EXPECT_TRUE(comes_true(
      [&] {
        return client.answers().all().size() == 49;
      },
      milliseconds(3000)));
}

TEST_F(ServedClientOfPlate, SilenceHasANameAndEndsWithTheNextMessage) {
  std::atomic<bool> speak = false;
  FakeService service(socket_, [&](ServiceConnection& to, const GoesOn& goes_on) {
    (void)to.send(served_scene(database_), milliseconds(1000));
    while (goes_on()) {
      std::this_thread::sleep_for(milliseconds(20));
      if (speak) {
        (void)to.send(ServedProgress{.stage = "mesh", .nodes = 49}, milliseconds(100));
      }
    }
  });
  ServedClient client(options());
  (void)client.scene(kNever);
  EXPECT_EQ(state(client), ServiceState::kServing);
  ASSERT_TRUE(comes_true(
      [&] {
        return state(client) == ServiceState::kSilent;
      },
      milliseconds(2000)));
  speak = true;
  ASSERT_TRUE(comes_true(
      [&] {
        return state(client) == ServiceState::kServing;
      },
      milliseconds(1000)));
  EXPECT_EQ(client.status().progress.stage, "mesh");
}

TEST_F(ServedClientOfPlate, TheEndOfAServiceIsNoLossAndItsFileIsRead) {
  const auto file = folder_ / "whole.h5";
  write_database(file, database_);
  FakeService service(socket_, [&](ServiceConnection& to, const GoesOn&) {
    (void)to.send(served_scene(database_), milliseconds(1000));
    ServedResponses some = served_responses(database_, AnswerQuality::kFinal, 0.5);
    some.node.resize(10);
    (void)to.send(some, milliseconds(1000));
    (void)to.send(ServedEnd{.file = file.string(), .failure = ""}, milliseconds(1000));
  });
  ServedClient client(options());
  (void)client.scene(kNever);
  ASSERT_TRUE(comes_true(
      [&] {
        return state(client) == ServiceState::kDone;
      },
      milliseconds(2000)));
  EXPECT_EQ(client.status().detail, file.string());
  EXPECT_EQ(client.answers().all().size(), 49U);
  EXPECT_EQ(client.answers().at(3)->node->response.force_n.back(), 2.0);
  std::this_thread::sleep_for(milliseconds(200));
  EXPECT_EQ(state(client), ServiceState::kDone);
  EXPECT_EQ(service.joined(), 1);
}

TEST_F(ServedClientOfPlate, AServiceThatFailsSaysWhy) {
  FakeService service(socket_, [&](ServiceConnection& to, const GoesOn&) {
    (void)to.send(served_scene(database_), milliseconds(1000));
    (void)to.send(ServedEnd{.file = "", .failure = "no node was solved"},
                  milliseconds(1000));
  });
  ServedClient client(options());
  (void)client.scene(kNever);
  ASSERT_TRUE(comes_true(
      [&] {
        return state(client) == ServiceState::kFailed;
      },
      milliseconds(2000)));
  EXPECT_EQ(client.status().detail, "no node was solved");
}

TEST_F(ServedClientOfPlate, RefusesInOneSentenceWhatItCannotRender) {
  const auto refusal = [&](const ServedScene& scene, const std::string& tool) {
    FakeService service(socket_, [&](ServiceConnection& to, const GoesOn& goes_on) {
      (void)to.send(scene, milliseconds(1000));
      while (goes_on()) {
        std::this_thread::sleep_for(milliseconds(5));
      }
    });
    ServedClientOptions named = options();
    named.tool = tool;
    ServedClient client(named);
    try {
      (void)client.scene(kNever);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal(served_scene(database_), "needle"),
            "tool \"needle\" is not there; known: ball");
  ServedScene relaxing = served_scene(database_);
  relaxing.plan.relaxation.tau_s = {0.5};
  relaxing.plan.relaxation.g = RowsOf<float>::Constant(1, 1, 0.3F);
  EXPECT_NE(refusal(relaxing, "").find("relaxes"), std::string::npos);
  ServedScene two = served_scene(database_);
  two.plan.tool.push_back(two.plan.tool[0]);
  two.plan.tool[1].name = "tip";
  EXPECT_NE(refusal(two, "").find("name one: ball, tip"), std::string::npos);
}

TEST_F(ServedClientOfPlate, KilledAtTwentyMomentsItNeverStopsTheSlowProcess) {
  const ResponseDatabase body = database_;
  GrowingElements elements(body.body, body.normal, body.tools[0].tool);
  std::unique_ptr<FakeService> service;
  const auto begin = [&](int moment) {
    service = std::make_unique<FakeService>(
        socket_, [this, moment](ServiceConnection& to, const GoesOn& goes_on) {
          auto frame = to_frame(served_scene(database_));
          const auto answers =
              to_frame(served_responses(database_, AnswerQuality::kPreliminary));
          frame.insert(frame.end(), answers.begin(), answers.end());
          // Cut anywhere: in the scene, between the messages, in the answers.
          if (moment < 20) {
            frame.resize(frame.size() * static_cast<std::size_t>(moment) / 20 + 1);
          }
          (void)to.send(frame, milliseconds(1000));
          while (moment == 20 && goes_on()) {
            std::this_thread::sleep_for(milliseconds(5));
          }
        });
  };
  begin(20);
  ServedClient client(options());
  (void)client.scene(kNever);
  client.feed(elements);
  auto fifo = std::make_unique<ElementFifo>();
  std::uint64_t tick = 0;
  std::chrono::nanoseconds longest{0};
  for (int moment = 0; moment < 20; ++moment) {
    service->die();
    begin(moment);
    for (int i = 0; i < 5; ++i) {
      const auto before = std::chrono::steady_clock::now();
      EXPECT_GT(elements.update({.sequence = ++tick,
                                 .time_ns = static_cast<std::int64_t>(tick) * 500'000,
                                 .position_m = {0.0, 0.0, 0.004}},
                                static_cast<std::int64_t>(tick) * 500'000, *fifo),
                0U);
      longest = std::max<std::chrono::nanoseconds>(
          longest, std::chrono::steady_clock::now() - before);
      while (fifo->front() != nullptr) {
        fifo->pop();
      }
      std::this_thread::sleep_for(milliseconds(2));
    }
  }
  // It never waits for a service that does not answer.
  EXPECT_LT(longest, milliseconds(500));
  EXPECT_EQ(client.answers().all().size(), 49U);
  service->die();
  begin(20);
  EXPECT_TRUE(comes_true(
      [&] {
        return state(client) == ServiceState::kServing;
      },
      milliseconds(4000)));
  client.forget(elements);
}

TEST_F(ServedClientOfPlate, AServiceThatEndsBeforeItsSceneIsSaid) {
  ServedClient client({.socket = socket_, .start = [](bool) {
                         return std::make_unique<ServiceProcess>(ServiceCommand{
                             .program = "/bin/false", .scene = "a", .output = "b"});
                       }});
  try {
    (void)client.scene(kNever);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("exit code 1"), std::string::npos);
  }
}

}  // namespace
}  // namespace palpate
