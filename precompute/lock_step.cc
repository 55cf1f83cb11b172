#include "precompute/lock_step.h"

#include <algorithm>
#include <memory>
#include <vector>

#include <boost/coroutine2/coroutine.hpp>

namespace palpate {
namespace {

using Coroutine = boost::coroutines2::coroutine<void>;

constexpr std::size_t kStackBytes = 1 << 20;

struct Request {
  std::span<const std::int64_t> dof;
  const Eigen::VectorXd* source = nullptr;
  Eigen::VectorXd result;
};

// Where unknowns stand in a solve: of all of them, or of the near ones alone.
class Rows {
 public:
  Rows(const CholeskyFactor& factor, bool near) : factor_(factor), near_(near) {}
  [[nodiscard]] std::int64_t of(std::int64_t dof) const {
    return near_ ? factor_.near_row()[static_cast<std::size_t>(dof)] : dof;
  }
  [[nodiscard]] Eigen::Index count() const {
    return near_ ? factor_.near_size() : factor_.size();
  }
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const {
    return near_ ? factor_.solve_near(B) : factor_.solve(B);
  }

 private:
  const CholeskyFactor& factor_;
  bool near_;
};

bool is_near(const CholeskyFactor& factor, const Request& request) {
  const std::vector<std::int64_t>& row = factor.near_row();
  return !row.empty() && request.dof.size() <= row.size() &&
         std::all_of(request.dof.begin(), request.dof.end(), [&](std::int64_t dof) {
           return dof < 0 || row[static_cast<std::size_t>(dof)] >= 0;
         });
}

void scatter(const Request& request, const Rows& rows,
             Eigen::Ref<Eigen::VectorXd> column) {
  for (std::size_t i = 0; i < request.dof.size(); ++i) {
    if (request.dof[i] >= 0) {
      column[rows.of(request.dof[i])] = (*request.source)[static_cast<Eigen::Index>(i)];
    }
  }
}

void gather(const Eigen::Ref<const Eigen::VectorXd>& column, const Rows& rows,
            Request& request) {
  request.result.resize(static_cast<Eigen::Index>(request.dof.size()));
  for (std::size_t i = 0; i < request.dof.size(); ++i) {
    request.result[static_cast<Eigen::Index>(i)] =
        request.dof[i] >= 0 ? column[rows.of(request.dof[i])] : 0.0;
  }
}

struct Running {
  Request request;
  std::unique_ptr<Coroutine::pull_type> coroutine;
};

void serve(const CholeskyFactor& factor, const std::vector<Running*>& waiting) {
  const Rows rows(factor,
                  std::all_of(waiting.begin(), waiting.end(), [&](const Running* r) {
                    return is_near(factor, r->request);
                  }));
  Eigen::MatrixXd B =
      Eigen::MatrixXd::Zero(rows.count(), static_cast<Eigen::Index>(waiting.size()));
  for (std::size_t k = 0; k < waiting.size(); ++k) {
    scatter(waiting[k]->request, rows, B.col(static_cast<Eigen::Index>(k)));
  }
  const Eigen::MatrixXd X = rows.solve(B);
  for (std::size_t k = 0; k < waiting.size(); ++k) {
    gather(X.col(static_cast<Eigen::Index>(k)), rows, waiting[k]->request);
  }
}

}  // namespace

RestSolve single_solves(const CholeskyFactor& factor) {
  return [&factor](std::span<const std::int64_t> dof, const Eigen::VectorXd& source) {
    Request request{.dof = dof, .source = &source, .result = {}};
    const Rows rows(factor, is_near(factor, request));
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(rows.count(), 1);
    scatter(request, rows, b.col(0));
    gather(rows.solve(b).col(0), rows, request);
    return std::move(request.result);
  };
}

void run_in_lock_step(const CholeskyFactor& factor,
                      std::span<const std::function<void(const RestSolve&)>> tasks) {
  std::vector<Running> running(tasks.size());
  std::vector<Running*> waiting;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    running[i].coroutine = std::make_unique<Coroutine::pull_type>(
        boost::coroutines2::fixedsize_stack(kStackBytes),
        [&request = running[i].request, &task = tasks[i]](Coroutine::push_type& yield) {
          task([&](std::span<const std::int64_t> dof, const Eigen::VectorXd& source) {
            request.dof = dof;
            request.source = &source;
            yield();
            return std::move(request.result);
          });
        });
  }
  for (;;) {
    waiting.clear();
    for (Running& r : running) {
      if (*r.coroutine) {
        waiting.push_back(&r);
      }
    }
    if (waiting.empty()) {
      return;
    }
    serve(factor, waiting);
    for (Running* r : waiting) {
      (*r->coroutine)();
    }
  }
}

}  // namespace palpate
