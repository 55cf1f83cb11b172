#include "formats/database/viscoelasticity_rules.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

#include <fmt/format.h>

#include "formats/database/format_error.h"

namespace palpate {
namespace {

// What single precision may add to sums of shares.
constexpr double kSumTolerance = 1e-5;

// Positive, finite, each larger than the one before.
void require_rising(const std::string& path, const std::vector<double>& values) {
  double before = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] > before && values[i] <= kLargest)) {
      fail("{}: element {} is {} after {}, must be positive and increase", path, i,
           values[i], before);
    }
    before = values[i];
  }
}

void require_count(const std::string& path, std::int64_t count, std::int64_t low,
                   std::int64_t high) {
  if (count < low || count > high) {
    fail("{} has {} rows, must have {} to {}", path, count, low, high);
  }
}

void check_shares(const std::string& path, const RowsOf<float>& g, std::int64_t first) {
  for (Eigen::Index i = 0; i < g.rows(); ++i) {
    double sum = 0.0;
    for (Eigen::Index k = 0; k < g.cols(); ++k) {
      const auto share = static_cast<double>(g(i, k));
      if (!(share >= 0.0)) {
        fail("{}: row {} has {}, must be at least 0", path, first + i, share);
      }
      sum += share;
    }
    if (!(sum <= 1.0 + kSumTolerance)) {
      fail("{}: row {} sums to {:.6g}, must sum to at most 1", path, first + i, sum);
    }
  }
}

// Either all datasets of a group, or none.
void require_together(const std::string& group,
                      std::initializer_list<std::size_t> rows) {
  const auto some = std::count_if(rows.begin(), rows.end(), [](std::size_t n) {
    return n > 0;
  });
  if (some != 0 && some != std::ssize(rows)) {
    fail("{} has {} of its {} datasets, must have all", group, some, rows.size());
  }
}

void check_sites(const std::string& group, const MemorySites& sites, std::int64_t count,
                 std::int64_t first) {
  for (Eigen::Index i = 0; i < sites.site.rows(); ++i) {
    double sum = 0.0;
    for (Eigen::Index k = 0; k < sites.site.cols(); ++k) {
      const std::int32_t site = sites.site(i, k);
      const auto weight = static_cast<double>(sites.weight(i, k));
      if (site < -1 || site >= count) {
        fail("{}/site: row {} has {}, must lie in [-1, {}]", group, first + i, site,
             count - 1);
      }
      if (!(weight >= 0.0) || (site < 0 && weight != 0.0)) {
        fail(
            "{}/weight: row {} has {} at site {}, must be at least 0, and 0 without a "
            "site",
            group, first + i, weight, site);
      }
      sum += weight;
    }
    // Weights of a node that remembers sum to 1, so that equal sites blend to their
    // value.
    const bool none = (sites.site.row(i).array() < 0).all();
    if (!none && !(std::abs(sum - 1.0) <= kSumTolerance)) {
      fail("{}/weight: row {} sums to {:.6g}, must sum to 1", group, first + i, sum);
    }
  }
}

}  // namespace

void check_terms(const std::string& tool, const Viscoelasticity& relaxation) {
  if (relaxation.empty()) {
    return;
  }
  const std::string group = tool + "/relaxation";
  require_count(group + "/tau_s", relaxation.terms(), 1, kMostTerms);
  require_rising(group + "/tau_s", relaxation.tau_s);
  if (!relaxation.instantaneous &&
      !(relaxation.speed_m_per_s > 0.0 && relaxation.speed_m_per_s <= kLargest)) {
    fail("{}@speed_m_per_s is {}, must be positive where curves are of a press", group,
         relaxation.speed_m_per_s);
  }
  if (relaxation.probes < 0) {
    fail("{}@probes is {}, must be at least 0", group, relaxation.probes);
  }
  if (relaxation.rule.find('\n') != std::string::npos) {
    fail("{}@rule is {:?}, must be one line", group, relaxation.rule.substr(0, 80));
  }
  require_count(tool + "/memory/bundle_depth_m", relaxation.bundles() - 1, 0,
                kMostBundles - 1);
  require_rising(tool + "/memory/bundle_depth_m", relaxation.bundle_depth_m);
}

void check_yielding(const std::string& tool, const Yielding& yielding,
                    std::int64_t nodes, std::int64_t first) {
  for_each_dataset(yielding, [&](const std::string& name, const char* /*units*/,
                                 const std::vector<double>& values) {
    const std::string path = tool + name;
    const auto rows = std::ssize(values);
    if (rows > 1 && rows != nodes) {
      fail("{} has {} rows, must have 1 or {}", path, rows, nodes);
    }
    const bool share = name.ends_with("share") || name.ends_with("largest");
    const bool scale = name.ends_with("scale_m");
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double value = values[i];
      const bool right =
          share ? value >= 0.0 && value < 1.0 : value >= 0.0 && value <= kLargest;
      if (!right || (scale && !(value > 0.0))) {
        fail("{}: row {} has {}, must {}", path,
             static_cast<std::int64_t>(i) + (rows > 1 ? first : 0), value,
             share   ? "lie in [0, 1)"
             : scale ? "be positive and finite"
                     : "be at least 0 and finite");
      }
    }
  });
}

void check_node_rows(const std::string& tool, const Viscoelasticity& relaxation,
                     std::int64_t nodes, std::int64_t sites, std::int64_t first) {
  if (!relaxation.empty()) {
    const std::string path = tool + "/relaxation/g";
    const RowsOf<float>& g = relaxation.g;
    if (g.cols() != relaxation.terms() || (g.rows() != 1 && g.rows() != nodes)) {
      fail("{} is {} x {}, must be 1 or {} x {}", path, g.rows(), g.cols(), nodes,
           relaxation.terms());
    }
    check_shares(path, g, g.rows() == 1 ? 0 : first);
  }
  if (relaxation.sites.empty()) {
    return;
  }
  const std::string group = tool + "/memory";
  const MemorySites& memory = relaxation.sites;
  for (const auto& [name, rows, columns] :
       {std::tuple{"site", memory.site.rows(), memory.site.cols()},
        std::tuple{"weight", memory.weight.rows(), memory.weight.cols()}}) {
    if (rows != nodes || columns != kMostNodeSites) {
      fail("{}/{} is {} x {}, must be {} x {}", group, name, rows, columns, nodes,
           kMostNodeSites);
    }
  }
  check_sites(group, memory, sites, first);
}

void check(const std::string& tool, const Viscoelasticity& relaxation,
           std::int64_t nodes) {
  check_terms(tool, relaxation);
  check_yielding(tool, relaxation.yielding, nodes);
  require_together(tool + "/plastic", {relaxation.yielding.yield_depth_m.size(),
                                       relaxation.yielding.share.size()});
  require_together(tool + "/damage", {relaxation.yielding.onset_m.size(),
                                      relaxation.yielding.scale_m.size(),
                                      relaxation.yielding.largest.size()});
  const MemorySites& sites = relaxation.sites;
  const auto count = static_cast<std::int64_t>(sites.node.size());
  check_node_rows(tool, relaxation, nodes, count);
  const auto errors = static_cast<std::int64_t>(relaxation.error_relative.size());
  if (errors > 1 && errors != nodes) {
    fail("{}/relaxation/error_relative has {} rows, must have 1 or {}", tool, errors,
         nodes);
  }
  for (std::size_t i = 0; i < relaxation.error_relative.size(); ++i) {
    if (!(relaxation.error_relative[i] >= 0.0F)) {
      fail("{}/relaxation/error_relative: row {} has {}, must be at least 0", tool, i,
           relaxation.error_relative[i]);
    }
  }
  if (sites.empty()) {
    return;
  }
  if (!(sites.spacing_m > 0.0 && sites.spacing_m <= kLargest)) {
    fail("{}/memory@spacing_m is {}, must be positive", tool, sites.spacing_m);
  }
  for (std::size_t i = 0; i < sites.node.size(); ++i) {
    if (sites.node[i] < -1 || sites.node[i] >= nodes) {
      fail("{}/memory/site_node: row {} has {}, must lie in [-1, {}]", tool, i,
           sites.node[i], nodes - 1);
    }
  }
}

}  // namespace palpate
