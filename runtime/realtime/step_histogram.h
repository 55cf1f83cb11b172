// How long the fast step takes: a histogram of fixed size that the fast loop can fill.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace palpate {

/// Counts durations in bins of 1/16 of an octave and less (percentiles to 6 %); the
/// largest is kept exactly. One thread; no allocation.
class StepHistogram {
 public:
  void add(std::int64_t duration_ns) noexcept {
    const auto ns = static_cast<std::uint64_t>(std::max<std::int64_t>(duration_ns, 0));
    ++bin_[bin(ns)];
    ++count_;
    max_ns_ = std::max(max_ns_, ns);
  }

  /// All the steps of another one.
  void add(const StepHistogram& other) noexcept {
    for (std::size_t i = 0; i < bin_.size(); ++i) {
      bin_[i] += other.bin_[i];
    }
    count_ += other.count_;
    max_ns_ = std::max(max_ns_, other.max_ns_);
  }

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] double max_ns() const noexcept { return static_cast<double>(max_ns_); }

  /// The duration [ns] that a `fraction` in (0, 1] of all steps did not exceed. The
  /// duration is rounded up to the end of its bin; 0 without steps.
  [[nodiscard]] double percentile_ns(double fraction) const noexcept {
    const auto wanted =
        static_cast<std::uint64_t>(std::ceil(fraction * static_cast<double>(count_)));
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < bin_.size(); ++i) {
      seen += bin_[i];
      if (seen >= wanted && seen > 0) {
        return std::min(static_cast<double>(end_ns(i)), max_ns());
      }
    }
    return 0.0;
  }

 private:
  static constexpr std::size_t kPerOctave = 16;
  static constexpr std::size_t kBins = 40 * kPerOctave;  // to 2^43 ns, hours

  // Durations below 16 ns have a bin each; above, the leading five bits name the bin.
  static std::size_t bin(std::uint64_t ns) noexcept {
    if (ns < kPerOctave) {
      return ns;
    }
    const auto shift = static_cast<std::size_t>(std::bit_width(ns)) - 5;
    const auto leading = static_cast<std::size_t>(ns >> shift);
    return std::min(kBins - 1, shift * kPerOctave + leading);
  }

  static std::uint64_t end_ns(std::size_t bin) noexcept {
    if (bin < 2 * kPerOctave) {
      return bin;
    }
    const std::size_t shift = bin / kPerOctave - 1;
    const std::uint64_t leading = bin - shift * kPerOctave;
    return ((leading + 1) << shift) - 1;
  }

  std::array<std::uint64_t, kBins> bin_{};
  std::uint64_t count_ = 0;
  std::uint64_t max_ns_ = 0;
};

}  // namespace palpate
