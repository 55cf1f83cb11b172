#include "precompute/lock_step.h"

#include <memory>

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

void scatter(const Request& request, Eigen::Ref<Eigen::VectorXd> column) {
  for (std::size_t i = 0; i < request.dof.size(); ++i) {
    if (request.dof[i] >= 0) {
      column[request.dof[i]] = (*request.source)[static_cast<Eigen::Index>(i)];
    }
  }
}

void gather(const Eigen::Ref<const Eigen::VectorXd>& column, Request& request) {
  request.result.resize(static_cast<Eigen::Index>(request.dof.size()));
  for (std::size_t i = 0; i < request.dof.size(); ++i) {
    request.result[static_cast<Eigen::Index>(i)] =
        request.dof[i] >= 0 ? column[request.dof[i]] : 0.0;
  }
}

struct Running {
  Request request;
  std::unique_ptr<Coroutine::pull_type> coroutine;
};

void serve(const CholeskyFactor& factor, const std::vector<Running*>& waiting) {
  Eigen::MatrixXd B =
      Eigen::MatrixXd::Zero(factor.size(), static_cast<Eigen::Index>(waiting.size()));
  for (std::size_t k = 0; k < waiting.size(); ++k) {
    scatter(waiting[k]->request, B.col(static_cast<Eigen::Index>(k)));
  }
  const Eigen::MatrixXd X = factor.solve(B);
  for (std::size_t k = 0; k < waiting.size(); ++k) {
    gather(X.col(static_cast<Eigen::Index>(k)), waiting[k]->request);
  }
}

}  // namespace

RestSolve single_solves(const CholeskyFactor& factor) {
  return [&factor](std::span<const std::int64_t> dof, const Eigen::VectorXd& source) {
    Request request{.dof = dof, .source = &source, .result = {}};
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(factor.size(), 1);
    scatter(request, b.col(0));
    gather(factor.solve(b).col(0), request);
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
