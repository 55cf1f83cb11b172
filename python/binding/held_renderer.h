// The fast and the slow process of one tool, as Python holds them.
#pragma once

#include "python/binding/held_database.h"

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <sys/types.h>

#include "formats/base/error.h"
#include "runtime/c_api/host_body.h"
#include "runtime/c_api/host_drawing.h"

namespace palpate {

/// The force is zero for good, until reset().
class RenderingFault : public Error {
 public:
  explicit RenderingFault(const std::string& what) : Error(what, 4) {}
};

/// Steps, resets and what they tell are called under Python's lock, one at a time; slow
/// steps and the slow thread go on without it. So do the ticks between begin_steps()
/// and end_steps(): meanwhile all else but slow steps is refused by an InputError.
class HeldRenderer {
 public:
  /// Lives with the database. @param second tool of a second hand that presses the body
  /// together with the first; none: there is one. @throws as HostBody.
  HeldRenderer(const std::shared_ptr<HeldDatabase>& held, HostOptions options,
               const std::optional<std::string>& second);

  /// Of a file, which may be streamed, or a scene, whose service is waited for.
  HeldRenderer(const std::filesystem::path& file, HostOptions options,
               const std::optional<std::string>& second);

  /// A forked child has no slow thread to wait for, so it leaves the body where it is.
  ~HeldRenderer();
  HeldRenderer(const HeldRenderer&) = delete;
  HeldRenderer& operator=(const HeldRenderer&) = delete;

  /// The C interface's palpate_step(). @param samples one of each hand. @returns the
  /// latest tick. @throws RenderingFault, at this tick and all that follow until
  /// reset().
  const HostTick& step(std::span<const HostSample> samples);

  /// @throws InputError between two such calls already.
  void begin_steps();
  void end_steps() noexcept { stepped_ = false; }

  /// step() between begin_steps() and end_steps(), without Python's lock.
  const HostTick& tick(std::span<const HostSample> samples);

  [[nodiscard]] std::size_t hands() const noexcept { return tool_->hands(); }
  /// What the latest tick asked for.
  [[nodiscard]] const PortWrenches& wanted() const noexcept { return tool_->wanted(); }

  /// palpate_delivered(). @throws InputError for what is not finite.
  void delivered(const PortWrenches& made);

  /// All contacts of the latest tick, in the world.
  [[nodiscard]] std::vector<BodyContact> contacts() const;

  /// How the surface deforms under these contacts. @throws as displaced_surface().
  [[nodiscard]] DisplacedSurface displaced() const {
    return displaced_surface(*body_, *tool_, contacts());
  }

  /// As HostTool has them.
  [[nodiscard]] NeedleSeen needle() const {
    refuse_stepped();
    return tool_->needle();
  }
  [[nodiscard]] Channel channel_at(std::int32_t i) const {
    refuse_stepped();
    return tool_->channel_at(i);
  }

  /// palpate_place(). @throws InputError for a place that is none.
  void place(const Eigen::Vector3d& origin_m, const Eigen::Vector4d& quaternion);

  void reset();

  /// As save_surface(), load_surface(), while no slow thread runs.
  void save_surface(const std::filesystem::path& file) const;
  void load_surface(const std::optional<std::filesystem::path>& file);

  /// @returns elements sent. @throws InputError while the thread runs.
  std::size_t slow_step();

  void start();
  void stop();
  [[nodiscard]] bool runs() const;

  [[nodiscard]] const HostTick& latest() const {
    refuse_stepped();
    return latest_;
  }
  [[nodiscard]] const HostBody& body() const noexcept { return *body_; }
  [[nodiscard]] double force_scale() const noexcept { return force_scale_; }
  /// What the place that was stepped to last answers with; of a database final.
  [[nodiscard]] GrownQuality answer() const;

 private:
  HeldRenderer(std::unique_ptr<HostBody> body,
               const std::optional<std::string>& second);
  void refuse_other_process() const;
  void refuse_stepped() const;
  void refuse_running() const;
  [[nodiscard]] std::string why_faulted(std::uint8_t fault) const;

  std::unique_ptr<HostBody> body_;
  HostTool* tool_ = nullptr;
  double force_scale_ = 1.0;
  HostTick latest_;
  std::atomic<bool> stepped_{false};
  mutable std::mutex slow_;  // starting, ending, stepping: one at a time
  pid_t process_;
};

}  // namespace palpate
