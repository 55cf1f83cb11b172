#include "formats/database/database_check_optional.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/database/compliance_rules.h"
#include "formats/database/contact_rules.h"
#include "formats/database/format_error.h"
#include "formats/database/puncture_rules.h"
#include "formats/database/viscoelasticity_rules.h"

namespace palpate {
namespace {

void require_rows(const std::string& path, std::size_t rows, std::size_t wanted,
                  bool may_be_absent) {
  if (rows != wanted && !(may_be_absent && rows == 0)) {
    fail("{} has {} rows, must have {}", path, rows, wanted);
  }
}

template <typename Values>
void require_range(const std::string& path, const Values& values, double low,
                   double high) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto value = static_cast<double>(values[i]);
    if (!(value >= low && value <= high)) {
      fail("{}: element {} is {}, must lie in [{:.6g}, {:.6g}]", path, i, value, low,
           high);
    }
  }
}

void require_lines(const std::string& path, const std::vector<std::string>& lines) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].empty() || lines[i].find('\n') != std::string::npos ||
        lines[i].find('\0') != std::string::npos) {
      fail("{}: line {} is {:?}, must be one line with something in it", path, i,
           lines[i].substr(0, 80));
    }
  }
}

// Rows of lines, by node.
void check_rows(const std::string& path, const std::vector<std::int32_t>& row,
                const std::string& lines_path, const std::vector<std::string>& lines,
                std::size_t n) {
  require_rows(path, row.size(), n, true);
  require_lines(lines_path, lines);
  require_range(path, row, -1.0, static_cast<double>(lines.size()) - 1.0);
}

void check_history(const std::string& group, const ResponseTable& table,
                   std::size_t n) {
  check_rows(group + "/history", table.history, group + "/history_text",
             table.history_text, n);
  for (std::size_t i = 0; i < table.history.size(); ++i) {
    const auto origin = static_cast<ResponseOrigin>(table.origin[i]);
    if (table.history[i] >= 0 && (origin == ResponseOrigin::kInterpolated ||
                                  origin == ResponseOrigin::kMeasured)) {
      fail(
          "{}/history: node {} has row {}, but was interpolated or measured, not "
          "solved",
          group, i, table.history[i]);
    }
  }
}

void check_failures(const std::string& group, const ResponseTable& table,
                    std::size_t n) {
  check_rows(group + "/failure", table.failure, group + "/failure_reason",
             table.failure_reason, n);
  for (std::size_t i = 0; i < table.failure.size(); ++i) {
    if (table.failure[i] >= 0 && (table.flags[i] & (kFailed | kTruncatedPath)) == 0) {
      fail(
          "{}/failure: node {} has reason {} but neither the flag failed nor "
          "truncated_path",
          group, i, table.failure[i]);
    }
  }
}

void check_verified(const std::string& group, const ResponseTable& table,
                    std::size_t n) {
  const std::string path = group + "/verified_error_relative";
  const std::vector<double>& verified = table.verified_error_relative;
  require_rows(path, verified.size(), n, true);
  for (std::size_t i = 0; i < verified.size(); ++i) {
    if (!std::isnan(verified[i]) && !(verified[i] >= 0.0 && verified[i] <= kLargest)) {
      fail("{}: node {} has {}, must be NaN or at least 0", path, i, verified[i]);
    }
  }
}

void check_sample_directions(const std::string& group, const ResponseTable& table,
                             std::size_t n) {
  const std::vector<std::int64_t>& begin = table.direction_begin;
  const std::string path = group + "/direction_begin";
  const auto rows = static_cast<std::int64_t>(table.sample_direction.rows());
  require_rows(path, begin.size(), n + 1, rows == 0);
  if (begin.empty()) {
    return;
  }
  if (begin.front() != 0 || begin.back() != rows) {
    fail("{} runs from {} to {}, must run from 0 to the rows of sample_direction {}",
         path, begin.front(), begin.back(), rows);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const std::int64_t count = begin[i + 1] - begin[i];
    const std::int64_t samples = table.sample_begin[i + 1] - table.sample_begin[i];
    if (count != 0 && count != samples) {
      fail("{}: node {} has {} directions, must be none or one per sample: {}", path, i,
           count, samples);
    }
  }
  for (Eigen::Index i = 0; i < table.sample_direction.rows(); ++i) {
    const double length = table.sample_direction.row(i).norm();
    if (!(std::abs(length - 1.0) <= kUnitTolerance)) {
      fail("{}/sample_direction: row {} has length {}, must be 1", group, i, length);
    }
  }
}

void require_ascending(const std::string& path, const std::vector<double>& values) {
  if (!std::is_sorted(values.begin(), values.end())) {
    fail("{} falls, must increase", path);
  }
}

void check_accuracy(const std::string& group, const AccuracyRecord& accuracy) {
  const std::string path = group + "/accuracy";
  require_range(path + "@budget_relative", std::vector{accuracy.budget_relative}, 0.0,
                kLargest);
  require_range(path + "@error_factor", std::vector{accuracy.error_factor}, 0.0,
                kLargest);
  require_range(path + "@hard_error_factor", std::vector{accuracy.hard_error_factor},
                0.0, kLargest);
  require_range(path + "@verified", std::vector{accuracy.verified}, 0.0, 1e18);
  require_range(path + "@between_nodes", std::vector{accuracy.between_nodes}, 0.0,
                static_cast<double>(accuracy.verified));
  require_range(path + "/quantile_level", accuracy.quantile_level, 0.0, 1.0);
  require_range(path + "/error_relative", accuracy.error_relative, 0.0, kLargest);
  require_rows(path + "/error_relative", accuracy.error_relative.size(),
               accuracy.quantile_level.size(), false);
  require_ascending(path + "/quantile_level", accuracy.quantile_level);
  require_range(path + "/depth_share", accuracy.depth_share, 0.0, 1.0);
  require_range(path + "/covering_relative", accuracy.covering_relative, 0.0, kLargest);
  require_rows(path + "/covering_relative", accuracy.covering_relative.size(),
               accuracy.depth_share.size(), false);
  require_ascending(path + "/depth_share", accuracy.depth_share);
  require_range(path + "@covered", std::vector{accuracy.covered}, 0.0, 1.0);
  require_range(path + "@hard_covered", std::vector{accuracy.hard_covered}, 0.0, 1.0);
}

void check_displacement(const std::string& group, const DisplacementField& field,
                        std::size_t n) {
  const auto k = static_cast<std::size_t>(field.coefficient.rows());
  require_rows(group + "/basis", static_cast<std::size_t>(field.basis.rows()), 3 * n,
               k == 0);
  if (field.basis.cols() != field.coefficient.cols()) {
    fail("{}/coefficient_m has {} columns, must have one per mode of the basis: {}",
         group, field.coefficient.cols(), field.basis.cols());
  }
  require_rows(group + "/node", field.node.size(), k, false);
  require_rows(group + "/depth_m", field.depth_m.size(), k, false);
  require_rows(group + "/error_relative", field.error_relative.size(), k, false);
  require_range(group + "/node", field.node, 0.0, static_cast<double>(n) - 1.0);
  require_range(group + "/depth_m", field.depth_m, 0.0, kLargest);
  require_range(group + "/error_relative", field.error_relative, 0.0, kLargest);
  if (!field.basis.allFinite() || !field.coefficient.allFinite()) {
    fail("{} holds numbers that are not finite", group);
  }
}

// Terms that one row of Prony's series can have; all not a number where it may be.
void check_prony(const std::string& group, const PronyTerms& terms,
                 bool may_be_unknown) {
  require_rows(group + "/g_2", terms.g_2.size(), terms.size(), false);
  require_rows(group + "/tau_1_s", terms.tau_1_s.size(), terms.size(), false);
  require_rows(group + "/tau_2_s", terms.tau_2_s.size(), terms.size(), false);
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const double g_1 = terms.g_1[i], g_2 = terms.g_2[i];
    const double tau_1 = terms.tau_1_s[i], tau_2 = terms.tau_2_s[i];
    if (may_be_unknown && std::isnan(g_1) && std::isnan(g_2) && std::isnan(tau_1) &&
        std::isnan(tau_2)) {
      continue;
    }
    if (!(g_1 >= 0.0 && g_2 >= 0.0 && g_1 + g_2 <= 1.0 + kUnitTolerance)) {
      fail(
          "{}: row {} has g_1 {} and g_2 {}, must be at least 0 and together at most 1",
          group, i, g_1, g_2);
    }
    if (!(tau_1 > 0.0 && tau_2 >= tau_1 && tau_2 <= kLargest)) {
      fail(
          "{}: row {} has tau_1_s {} and tau_2_s {}, must be positive and the second "
          "not smaller",
          group, i, tau_1, tau_2);
    }
  }
}

void check_run_relaxation(const RunRelaxation& relaxation, std::size_t runs) {
  const std::string group = "/measurement/relaxation";
  const std::size_t rows = relaxation.terms.size();
  require_rows(group + "/g_1", rows, runs, true);
  check_prony(group, relaxation.terms, true);
  const auto require = [&](const char* name, const std::vector<double>& values) {
    const std::string path = fmt::format("{}/{}", group, name);
    require_rows(path, values.size(), rows, false);
    for (std::size_t i = 0; i < rows; ++i) {
      const bool unknown = std::isnan(relaxation.terms.g_1[i]);
      if (unknown ? !std::isnan(values[i])
                  : !(values[i] >= 0.0 && values[i] <= kLargest)) {
        fail("{}: run {} has {}, must be {}", path, i, values[i],
             unknown ? "not a number as its terms" : "finite and at least 0");
      }
    }
  };
  require("speed_m_per_s", relaxation.speed_m_per_s);
  require("seconds", relaxation.seconds);
  require("rms_relative", relaxation.rms_relative);
}

// Runs divide the samples among themselves.
void check_runs(const Measurement& measurement, std::int64_t nodes) {
  const std::vector<std::int64_t>& begin = measurement.run_begin;
  const std::size_t runs = begin.empty() ? 0 : begin.size() - 1;
  require_rows("/measurement/run_node", measurement.run_node.size(), runs, true);
  require_rows("/measurement/run_name", measurement.run_name.size(), runs, true);
  require_range("/measurement/run_node", measurement.run_node, -1.0,
                static_cast<double>(nodes) - 1.0);
  require_lines("/measurement/run_name", measurement.run_name);
  check_run_relaxation(measurement.relaxation, runs);
  if (begin.empty()) {
    return;
  }
  if (begin.front() != 0 || !std::is_sorted(begin.begin(), begin.end()) ||
      begin.back() != static_cast<std::int64_t>(measurement.depth_m.size())) {
    fail("/measurement/run_begin runs from {} to {}, must rise from 0 to {}",
         begin.front(), begin.back(), measurement.depth_m.size());
  }
}

}  // namespace

void check_relaxation(const std::string& group, const ResponseRelaxation& relaxation,
                      std::int64_t nodes) {
  check_prony(group, relaxation.terms, false);
  if (relaxation.empty()) {
    return;
  }
  const auto positive = [&](const char* name, double value) {
    if (!(value > 0.0 && value <= kLargest)) {
      fail("{}@{} is {}, must be positive", group, name, value);
    }
  };
  if (relaxation.terms.size() != 1) {
    require_rows(group + "/g_1", relaxation.terms.size(),
                 static_cast<std::size_t>(nodes), false);
  }
  require_lines(group + "@rule", {relaxation.rule});
  positive("probes", static_cast<double>(relaxation.probes));
  positive("speed_m_per_s", relaxation.speed_m_per_s);
  positive("seconds", relaxation.seconds);
}

void check_optional(const std::string& group, const ResponseTable& table) {
  const auto n = static_cast<std::size_t>(table.nodes());
  check_verified(group, table, n);
  check_failures(group, table, n);
  check_history(group, table, n);
  require_rows(group + "/force_n_errors", table.force_errors_n.size(),
               table.force_n.size(), true);
  require_range(group + "/force_n_errors", table.force_errors_n, 0.0, kLargest);
  check_sample_directions(group, table, n);
  check_accuracy(group, table.accuracy);
  check_displacement(group + "/displacement", table.displacement, n);
  check_relaxation(group + "/relaxation", table.relaxation, table.nodes());
  check(group, table.viscoelasticity, table.nodes());
  check_compliance_head(group, table.compliance);
  check_compliance_rows(group, table.compliance, table.nodes());
  check_puncture(group, table.puncture, table.nodes());
  check_contact(group, table.contact, table.nodes());
  if (!table.relaxation.empty() && !table.viscoelasticity.empty()) {
    fail("{}/relaxation has g_1 and g, must have one of them", group);
  }
}

void check(const Measurement& measurement, std::int64_t nodes) {
  const std::size_t m = measurement.depth_m.size();
  if (m != measurement.force_n.size()) {
    fail("/measurement/force_n has {} rows, must have as many as depth_m: {}",
         measurement.force_n.size(), m);
  }
  for (std::size_t i = 0; i < m; ++i) {
    if (!std::isfinite(measurement.depth_m[i]) ||
        !std::isfinite(measurement.force_n[i])) {
      fail("/measurement: sample {} is ({} m, {} N), must be finite", i,
           measurement.depth_m[i], measurement.force_n[i]);
    }
  }
  require_rows("/measurement/time_s", measurement.time_s.size(), m, true);
  require_rows("/measurement/depth_m_errors", measurement.depth_errors_m.size(), m,
               true);
  require_rows("/measurement/force_n_errors", measurement.force_errors_n.size(), m,
               true);
  require_range("/measurement/time_s", measurement.time_s, -kLargest, kLargest);
  require_range("/measurement/depth_m_errors", measurement.depth_errors_m, 0.0,
                kLargest);
  require_range("/measurement/force_n_errors", measurement.force_errors_n, 0.0,
                kLargest);
  check_runs(measurement, nodes);
}

}  // namespace palpate
