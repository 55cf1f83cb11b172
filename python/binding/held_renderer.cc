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

HeldRenderer::HeldRenderer(const std::shared_ptr<HeldDatabase>& held,
                           HostOptions options)
    : body_(std::make_unique<HostBody>(
          std::shared_ptr<const ResponseDatabase>(held, &held->database),
          without_thread(std::move(options)))),
      tool_(&body_->add_tool()),
      process_(getpid()) {}

HeldRenderer::HeldRenderer(const std::filesystem::path& file, HostOptions options)
    : body_(std::make_unique<HostBody>(file, without_thread(std::move(options)))),
      tool_(&body_->add_tool()),
      process_(getpid()) {}

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
  return why + ", no element came: slow_step() about 100 times a second, or start()";
}

const HostTick& HeldRenderer::step(const HostSample& sample) {
  latest_ = tool_->step(sample);
  if (latest_.command.fault != 0) {
    refuse_other_process();
    throw RenderingFault(why_faulted(latest_.command.fault));
  }
  return latest_;
}

void HeldRenderer::delivered(const Eigen::Vector3d& force_n,
                             const std::optional<Eigen::Vector3d>& torque_n_m) {
  PortWrenches made = tool_->wanted();
  made[0].force_n = force_n;
  made[0].torque_n_m = torque_n_m.value_or(made[0].torque_n_m);
  if (!tool_->delivered(made)) {
    throw InputError("delivered: force and torque must be finite");
  }
}

void HeldRenderer::reset() {
  tool_->reset();
  latest_ = HostTick{};
}

void HeldRenderer::refuse_running() const {
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
