// The exchanges of a probe, within its limits. The force is never more than its
// largest, and the probe ends where the tool runs away or the person wants an end.
#pragma once

#include <cstdint>
#include <limits>

#include "runtime/attach/probe.h"
#include "runtime/realtime/step_histogram.h"

namespace palpate {

/// A motion begins where the tool is; ways and times count from there. Forces are along
/// one axis, that of begin_pushing(); x before.
class ProbeWire {
 public:
  /// All must outlive it. @param planned_s [s] of the whole probe, for the report to
  /// the person.
  ProbeWire(DeviceLink& link, const ProbeOptions& options, const ProbeGuide& guide,
            Clock& clock, double planned_s)
      : link_(link),
        options_(options),
        guide_(guide),
        clock_(clock),
        left_s_(planned_s) {}

  /// Of the procedure, planned to take so long [s].
  void begin_step(double planned_s);

  void begin_motion();
  [[nodiscard]] double motion_s();  ///< [s] since then
  [[nodiscard]] double way_m(double sign) const {
    return sign * (position_m_ - from_m_)[axis_];
  }

  /// Nobody holds it: a tool that runs away from where it was the first time is let go.
  void begin_pushing(int axis);

  /// One exchange. False where it had no answer. @throws DeviceError where the link is
  /// lost or the tool runs away; Interrupted when stopped. The force is the last one's.
  bool exchange(double force_n);
  /// When it is due at the probe's rate.
  bool paced(double force_n);
  /// Whether it stands for for_s within a time, without force.
  bool rests(double within_s, double for_s);
  void let_go() noexcept;

  [[nodiscard]] const Eigen::Vector3d& position_m() const { return position_m_; }
  /// [s] of the motion at which the latest paced exchange began; [s] the longest of the
  /// motion, or between two.
  [[nodiscard]] double begun_s() const { return begun_s_; }
  [[nodiscard]] double gap_s() const { return gap_s_; }
  /// [m] least step so far; of a device that never moved yet: none.
  [[nodiscard]] double step_m() const;
  /// [s] a percentile of exchanges.
  [[nodiscard]] double exchange_s(double fraction) const {
    return exchange_.percentile_ns(fraction) / kNanosecondsPerSecond;
  }

  /// Fills in what is the wire's.
  void report(ProbeReport& report) const;

 private:
  void learn_step(const Eigen::Vector3d& moved_m);
  void stop_a_runaway(std::int64_t now_ns);
  void show_progress();

  DeviceLink& link_;
  const ProbeOptions& options_;
  const ProbeGuide& guide_;
  Clock& clock_;
  StepHistogram exchange_;
  std::int64_t exchanges_ = 0;
  std::int64_t missed_ = 0;
  double force_max_n_ = 0.0;
  double resolution_m_ = std::numeric_limits<double>::infinity();
  int axis_ = 0;
  bool free_ = false;
  double left_s_;  // of the steps after this one
  double step_s_ = 0.0;
  std::int64_t step_ns_ = 0;
  double begun_s_ = 0.0;
  double gap_s_ = 0.0;
  std::int64_t begin_ns_ = 0;
  std::int64_t next_ns_ = 0;
  std::int64_t progress_ns_ = 0;
  std::int64_t speed_ns_ = 0;
  Eigen::Vector3d position_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d from_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d speed_m_ = Eigen::Vector3d::Zero();
};

}  // namespace palpate
