#include "python/binding/held_renderer.h"

#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "runtime/c_api/host_surface.h"

namespace palpate {
namespace {

// Python starts the thread when it wants one.
HostOptions without_thread(HostOptions options) {
  options.own_slow_steps = true;
  return options;
}

}  // namespace

HeldRenderer::HeldRenderer(std::unique_ptr<HostBody> body,
                           const std::optional<std::string>& second)
    : body_(std::move(body)), force_scale_(body_->force_scale()), process_(getpid()) {
  if (second) {
    const HostBody::Together both = body_->add_together(*second);
    tool_ = &both.tool;
    force_scale_ = both.force_scale;
  } else {
    tool_ = &body_->add_tool();
  }
}

HeldRenderer::HeldRenderer(const std::shared_ptr<HeldDatabase>& held,
                           HostOptions options,
                           const std::optional<std::string>& second)
    : HeldRenderer(std::make_unique<HostBody>(
                       std::shared_ptr<const ResponseDatabase>(held, &held->database),
                       without_thread(std::move(options))),
                   second) {}

HeldRenderer::HeldRenderer(const std::filesystem::path& file, HostOptions options,
                           const std::optional<std::string>& second)
    : HeldRenderer(std::make_unique<HostBody>(file, without_thread(std::move(options))),
                   second) {}

HeldRenderer::~HeldRenderer() {
  if (getpid() != process_ && body_->slow_runs()) {
    static_cast<void>(body_.release());
  }
}

void HeldRenderer::refuse_other_process() const {
  if (getpid() != process_ && body_->slow_runs()) {
    throw InputError(
        "the renderer's slow thread stayed in the process that forked: make a renderer "
        "in this one");
  }
}

std::string HeldRenderer::why_faulted(std::uint8_t fault) const {
  const auto kind = static_cast<Fault>(fault);
  std::string why = fmt::format("force is zero until reset(): {}", name(kind));
  if (kind != Fault::kSlowStalled) {
    return why;
  }
  if (const SlowFailure failure = body_->slow_failure(); failure.exit_code != 0) {
    return why + ", because of " + failure.text;
  }
  return why +
         ", no element came: slow_step() about 100 times a second, or start(), with "
         "steps no faster than real time";
}

void HeldRenderer::refuse_stepped() const {
  if (stepped_) {
    throw InputError("step_many() steps the renderer in another thread: wait for it");
  }
}

void HeldRenderer::begin_steps() {
  if (stepped_.exchange(true)) {
    throw InputError("step_many() steps the renderer in another thread: wait for it");
  }
}

const HostTick& HeldRenderer::step(std::span<const HostSample> samples) {
  refuse_stepped();
  return tick(samples);
}

const HostTick& HeldRenderer::tick(std::span<const HostSample> samples) {
  latest_ = tool_->step(samples);
  if (latest_.command.fault != 0) {
    refuse_other_process();
    throw RenderingFault(why_faulted(latest_.command.fault));
  }
  return latest_;
}

std::vector<BodyContact> HeldRenderer::contacts() const {
  refuse_stepped();
  std::vector<BodyContact> all;
  for (int i = 0; i < tool_->contacts(); ++i) {
    all.push_back(tool_->contact_at(i));
  }
  return all;
}

GrownQuality HeldRenderer::answer() const {
  const GrowingElements* grown = body_->grown(*tool_);
  return grown == nullptr ? GrownQuality::kFinal : grown->here();
}

void HeldRenderer::delivered(const PortWrenches& made) {
  refuse_stepped();
  if (!tool_->delivered(made)) {
    throw InputError("delivered: force and torque must be finite");
  }
}

void HeldRenderer::place(const Eigen::Vector3d& origin_m,
                         const Eigen::Vector4d& quaternion) {
  refuse_stepped();
  if (!body_->placement().place(origin_m, quaternion)) {
    throw InputError(
        "place: position must be finite, orientation a quaternion other than 0");
  }
}

void HeldRenderer::reset() {
  refuse_stepped();
  tool_->reset();
  latest_ = HostTick{};
}

void HeldRenderer::refuse_running() const {
  refuse_stepped();
  if (runs()) {
    throw InputError("the slow thread runs: stop() it first");
  }
}

void HeldRenderer::save_surface(const std::filesystem::path& file) const {
  refuse_running();
  palpate::save_surface(*body_, *tool_, file);
}

void HeldRenderer::load_surface(const std::optional<std::filesystem::path>& file) {
  refuse_running();
  palpate::load_surface(*body_, *tool_, file);
  latest_ = HostTick{};
}

std::size_t HeldRenderer::slow_step() {
  refuse_other_process();
  const std::scoped_lock lock(slow_);
  return body_->slow_step();
}

void HeldRenderer::start() {
  refuse_other_process();
  const std::scoped_lock lock(slow_);
  body_->start_slow();
}

void HeldRenderer::stop() {
  refuse_other_process();
  const std::scoped_lock lock(slow_);
  body_->stop_slow();
}

bool HeldRenderer::runs() const {
  if (getpid() != process_) {
    return false;
  }
  const std::scoped_lock lock(slow_);
  return body_->slow_runs();
}

}  // namespace palpate
