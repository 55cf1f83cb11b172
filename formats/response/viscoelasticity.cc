#include "formats/response/viscoelasticity.h"

#include <algorithm>

#include <fmt/format.h>

#include "formats/base/reproducible.h"

namespace palpate {
namespace {

std::string extent(double low, double high, double size = 1.0) {
  const std::string first = fmt::format("{:.3g}", size * low);
  const std::string last = fmt::format("{:.3g}", size * high);
  return first == last ? first : first + ".." + last;
}

}  // namespace

double relaxed_share(const Viscoelasticity& relaxation, std::int64_t node,
                     double time_s) {
  const Eigen::RowVectorXd g = relaxation.shares(node);
  double share = 1.0;
  for (std::size_t k = 0; k < relaxation.tau_s.size(); ++k) {
    share += g(static_cast<Eigen::Index>(k)) *
             reproducible::expm1(-time_s / relaxation.tau_s[k]);
  }
  return share;
}

double slow_share(const Viscoelasticity& relaxation, std::int64_t node) {
  return std::max(0.0, 1.0 - relaxation.shares(node).sum());
}

double mean_time_s(const Viscoelasticity& relaxation, std::int64_t node) {
  const Eigen::RowVectorXd g = relaxation.shares(node);
  const Eigen::Map<const Eigen::RowVectorXd> tau_s(relaxation.tau_s.data(), g.size());
  return g.sum() > 0.0 ? g.dot(tau_s) / g.sum() : 0.0;
}

ShareExtent share_extent(const Viscoelasticity& relaxation) {
  RowsOf<double> all(relaxation.g.rows(), relaxation.g.cols() + 1);
  all << relaxation.g.cast<double>(), relaxation.g.cast<double>().rowwise().sum();
  return {all.colwise().minCoeff(), all.colwise().maxCoeff()};
}

std::string describe(const Viscoelasticity& relaxation, const ShareExtent& shares) {
  const Eigen::Index terms = relaxation.terms();
  std::string text = fmt::format("held for long, {} % of the force stay: ",
                                 extent(std::max(0.0, 1.0 - shares.high(terms)),
                                        std::max(0.0, 1.0 - shares.low(terms)), 100.0));
  for (Eigen::Index k = 0; k < terms; ++k) {
    text += fmt::format("{}g {} in {:.3g} s", k == 0 ? "" : ", ",
                        extent(shares.low(k), shares.high(k)),
                        relaxation.tau_s[static_cast<std::size_t>(k)]);
  }
  text += relaxation.instantaneous
              ? std::string("; curves are instantaneous")
              : fmt::format("; curves are of a press at {:.3g} mm/s",
                            1e3 * relaxation.speed_m_per_s);
  if (relaxation.probes > 0) {
    text += fmt::format("; {} probes", relaxation.probes);
  }
  return text + (relaxation.rule.empty() ? "" : "; " + relaxation.rule);
}

std::string describe_memory(const Viscoelasticity& relaxation, std::int64_t sites) {
  std::string text = sites == 0 ? std::string("every node")
                                : fmt::format("{} sites, {:.3g} mm apart", sites,
                                              1e3 * relaxation.sites.spacing_m);
  if (relaxation.bundles() > 1) {
    text += fmt::format(", in {} bundles", relaxation.bundles());
  }
  return text;
}

}  // namespace palpate
