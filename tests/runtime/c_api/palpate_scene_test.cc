// A scene that is computed while a host presses it.
#include <atomic>
#include <cmath>
#include <fstream>
#include <memory>
#include <thread>

#include "formats/service/service_socket.h"
#include "tests/runtime/c_api/pressed_plate_host.h"
#include "tests/support/comes_true.h"
#include "tests/support/fake_service.h"

namespace palpate {
namespace {

using std::chrono::milliseconds;

constexpr double kModulusPa = 8000.0;

class PalpateScene : public PressedPlateHost {
 protected:
  PalpateScene() {
    std::ofstream(scene_) << "a scene";  // what the service says that it computes
    ServedScene told = served_scene(database_);
    told.modulus_pa = kModulusPa;
    const auto script = [this, told](ServiceConnection& to, const auto& goes_on) {
      (void)to.send(told, milliseconds(1000));
      bool sent = false;
      while (goes_on() && to.is_open()) {
        if (answers_ && !sent) {
          sent = true;
          (void)to.send(served_responses(database_, AnswerQuality::kFinal),
                        milliseconds(1000));
          (void)to.send(
              ServedProgress{
                  .stage = "", .nodes = 121, .answered = 121, .finished = 121},
              milliseconds(1000));
        }
        if (const auto hand = to.receive(milliseconds(5))) {
          ++hands_;
        }
      }
    };
    service_ =
        std::make_unique<FakeService>(service_socket(folder_ / "out.h5"), script);
  }

  [[nodiscard]] palpate_options scene_options(std::uint32_t more = 0) const {
    palpate_options wanted = options();
    wanted.flags |= PALPATE_SCENE | more;
    wanted.output = output_.c_str();
    wanted.server = "/nowhere/palpate-precompute";
    return wanted;
  }
  palpate_tool* open_scene(const palpate_options& wanted) {
    palpate_close(body_);
    body_ = palpate_open(scene_.c_str(), &wanted, error_, sizeof error_);
    return body_ == nullptr ? nullptr : palpate_tool_add(body_);
  }
  [[nodiscard]] palpate_service service() const {
    palpate_service is{};
    is.struct_size = sizeof is;
    EXPECT_EQ(palpate_service_get(body_, &is), 0);
    return is;
  }
  void let_answer() {
    answers_ = true;
    ASSERT_TRUE(comes_true(
        [&] {
          return service().finished == 121;
        },
        milliseconds(5000)));
  }
  // Above the surface, until the place below answers so: steps take real time.
  void hover(palpate_tool* tool, int answer) {
    EXPECT_TRUE(comes_true(
        [&] {
          force(tool, -0.005);
          return palpate_slow_step(body_) < 0 || answer_under(tool) == answer;
        },
        milliseconds(5000)));
  }
  static int answer_under(palpate_tool* tool) {
    palpate_state state{};
    state.struct_size = sizeof state;
    palpate_state_get(tool, &state);
    return state.answer;
  }

  const ResponseDatabase database_ =
      sample_database(plate(0.1, 10), ball(kRadius, 0.3, 5e-4), wall, 0.01, 41);
  const std::string scene_ = (folder_ / "scene.toml").string();
  const std::string output_ = (folder_ / "out.h5").string();
  std::atomic<bool> answers_ = false;
  std::atomic<int> hands_ = 0;
  std::unique_ptr<FakeService> service_;
};

TEST_F(PalpateScene, GivesNoForceUntilThereIsAnAnswerThenThatOfTheDatabase) {
  palpate_tool* tool = open_scene(scene_options());
  ASSERT_NE(tool, nullptr) << error_;
  palpate_tool* other = palpate_tool_add(body_);
  ASSERT_NE(other, nullptr);
  EXPECT_EQ(service().state, PALPATE_SERVICE_SERVING);
  EXPECT_EQ(service().started, 0);
  EXPECT_EQ(press(tool, 0.003).force[2], 0.0);
  EXPECT_EQ(answer_under(tool), PALPATE_ANSWER_NONE);
  EXPECT_EQ(palpate_needed_damping(body_), 0.0);
  let_answer();
  hover(tool, PALPATE_ANSWER_FINAL);
  const double felt_n = press(tool, 0.003).force[2];
  EXPECT_NEAR(felt_n, wall(0, 0.003), 1e-6);
  hover(other, PALPATE_ANSWER_FINAL);
  EXPECT_NEAR(press(other, 0.003).force[2], felt_n, 1e-6);
  // Friction's spring mu f / delta_L at 2 N is the stiffest thing of the plate.
  EXPECT_NEAR(palpate_needed_damping(body_), 0.3 * 2.0 / 5e-4 * 0.0005, 1e-6);
  EXPECT_GT(hands_.load(), 0);

  service_->die();
  EXPECT_TRUE(comes_true(
      [&] {
        return service().state == PALPATE_SERVICE_LOST;
      },
      milliseconds(5000)));
  press(tool, -0.005);
  EXPECT_NEAR(press(tool, 0.003).force[2], felt_n, 1e-6);
}

TEST_F(PalpateScene, EstimatesByTheMaterialWhereAsked) {
  palpate_tool* tool = open_scene(scene_options(PALPATE_ESTIMATE));
  ASSERT_NE(tool, nullptr) << error_;
  const double felt_n = press(tool, 0.003).force[2];
  const double hertz_n =
      4.0 / 3.0 * kModulusPa * std::sqrt(kRadius) * std::pow(0.003, 1.5);
  EXPECT_NEAR(felt_n, hertz_n, 0.01 * hertz_n);  // 20 samples of a power of 1.5
  EXPECT_EQ(answer_under(tool), PALPATE_ANSWER_ESTIMATED);
  let_answer();
  hover(tool, PALPATE_ANSWER_FINAL);
  EXPECT_NEAR(press(tool, 0.003).force[2], wall(0, 0.003), 1e-6);
}

TEST_F(PalpateScene, SoftensWhatTheDeviceCannotRender) {
  answers_ = true;
  palpate_options wanted = scene_options(PALPATE_LIMIT_STIFFNESS);
  wanted.device_damping_n_s_per_m = 0.02;  // 2 b / T = 40 N/m
  palpate_tool* tool = open_scene(wanted);
  ASSERT_NE(tool, nullptr) << error_;
  let_answer();
  hover(tool, PALPATE_ANSWER_FINAL);
  const double felt_n = press(tool, 0.003).force[2];
  EXPECT_NEAR(felt_n, 40.0 / 400.0 * wall(0, 0.003),
              1e-6);  // the steepest slope is 400
  // Every answer counts: the final one of each node, and a preliminary one that may
  // have come before it.
  EXPECT_GE(service().softened, 121);
  EXPECT_LE(service().softened, 2 * 121);
  EXPECT_LE(palpate_needed_damping(body_), 0.02 * (1.0 + 1e-9));
}

TEST_F(PalpateScene, RefusesWhatIsNotOfAScene) {
  palpate_options wanted = scene_options();
  wanted.device_damping_n_s_per_m = 1.0;
  EXPECT_EQ(open_scene(wanted), nullptr);
  EXPECT_NE(std::string(error_).find("limit stiffness"), std::string::npos) << error_;
  wanted = scene_options(PALPATE_STREAMED);
  EXPECT_EQ(open_scene(wanted), nullptr);
  EXPECT_NE(std::string(error_).find("not streamed"), std::string::npos) << error_;
  wanted = scene_options();
  wanted.flags = PALPATE_OWN_SLOW_STEPS;
  EXPECT_EQ(open_scene(wanted), nullptr);
  EXPECT_NE(std::string(error_).find("flag is not set"), std::string::npos) << error_;
  const std::string elsewhere = (folder_ / "elsewhere.h5").string();
  wanted = scene_options();
  wanted.output = elsewhere.c_str();  // nobody listens there
  EXPECT_EQ(open_scene(wanted), nullptr);
  EXPECT_NE(std::string(error_).find("no program is there"), std::string::npos)
      << error_;
  ASSERT_NE(open_scene(scene_options()), nullptr) << error_;
  EXPECT_EQ(palpate_together_open(body_, nullptr, error_, sizeof error_), nullptr);
  EXPECT_NE(std::string(error_).find("build its database first"), std::string::npos)
      << error_;
  palpate_tool* tool = palpate_tool_add(body_);
  EXPECT_LT(palpate_surface_save(tool, (folder_ / "s").c_str(), error_, sizeof error_),
            0);
  ASSERT_NE(open(options()), nullptr) << error_;  // a database
  EXPECT_EQ(service().state, PALPATE_SERVICE_NONE);
  EXPECT_EQ(palpate_service_get(body_, nullptr), PALPATE_ERROR_INPUT);
}

}  // namespace
}  // namespace palpate
