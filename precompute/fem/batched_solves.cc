#include "precompute/fem/batched_solves.h"

#include <algorithm>
#include <exception>
#include <memory>
#include <optional>
#include <vector>

#include <boost/coroutine2/coroutine.hpp>

namespace palpate {
namespace {

using Coroutine = boost::coroutines2::coroutine<void>;

constexpr std::size_t kStackBytes = 1 << 20;

struct Request {
  std::span<const std::int64_t> dof;
  const Eigen::VectorXd* source = nullptr;
  SolveWith with = SolveWith::kFactor;
  Eigen::VectorXd result;
  std::exception_ptr failure;  // why it was not served
};

// Solves requests with the part of the factor that they reach, which is kept as long as
// the same unknowns are asked for.
class PartSolver {
 public:
  explicit PartSolver(const CholeskyFactor& factor) : factor_(factor) {}

  void serve(std::span<Request* const> requests) {
    choose_part(requests);
    if (requests.size() == 1) {
      serve_one(*requests.front());
      return;
    }
    constexpr auto kMost = static_cast<std::size_t>(kSolveWidthMax);
    for (std::size_t first = 0; first < requests.size(); first += kMost) {
      serve_several(requests.subspan(first, std::min(kMost, requests.size() - first)));
    }
  }

 private:
  void serve_one(Request& request) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(part_.size());
    for (std::size_t i = 0; i < request.dof.size(); ++i) {
      if (request.dof[i] >= 0) {
        x[row(request.dof[i])] = (*request.source)[static_cast<Eigen::Index>(i)];
      }
    }
    (request.with == SolveWith::kRounded ? rounded() : part_).solve(x);
    request.result.resize(static_cast<Eigen::Index>(request.dof.size()));
    for (std::size_t i = 0; i < request.dof.size(); ++i) {
      request.result[static_cast<Eigen::Index>(i)] =
          request.dof[i] >= 0 ? x[row(request.dof[i])] : 0.0;
    }
  }

  void serve_several(std::span<Request* const> requests) {
    const auto count = static_cast<Eigen::Index>(requests.size());
    SolveRows X = SolveRows::Zero(part_.size(), solve_width(count));
    for (Eigen::Index k = 0; k < count; ++k) {
      const Request& request = *requests[static_cast<std::size_t>(k)];
      for (std::size_t i = 0; i < request.dof.size(); ++i) {
        if (request.dof[i] >= 0) {
          X(row(request.dof[i]), k) = (*request.source)[static_cast<Eigen::Index>(i)];
        }
      }
    }
    part_.solve(X);
    for (Eigen::Index k = 0; k < count; ++k) {
      Request& request = *requests[static_cast<std::size_t>(k)];
      request.result.resize(static_cast<Eigen::Index>(request.dof.size()));
      for (std::size_t i = 0; i < request.dof.size(); ++i) {
        request.result[static_cast<Eigen::Index>(i)] =
            request.dof[i] >= 0 ? X(row(request.dof[i]), k) : 0.0;
      }
    }
  }

  const FactorPart& rounded() {
    if (!rounded_) {
      rounded_ = part_.rounded();
    }
    return *rounded_;
  }

  [[nodiscard]] std::int64_t row(std::int64_t dof) const {
    return part_.row()[static_cast<std::size_t>(dof)];
  }

  void choose_part(std::span<Request* const> requests) {
    std::size_t wanted = 0;
    bool known = made_for_ > 0;
    for (const Request* request : requests) {
      wanted += request->dof.size();
      known = known && std::all_of(request->dof.begin(), request->dof.end(),
                                   [&](std::int64_t dof) {
                                     return dof < 0 || row(dof) >= 0;
                                   });
    }
    // A part that was made for more unknowns would do, but cost more.
    if (known && wanted == made_for_) {
      return;
    }
    std::vector<std::int64_t> unknowns;
    for (const Request* request : requests) {
      unknowns.insert(unknowns.end(), request->dof.begin(), request->dof.end());
    }
    part_ = factor_.part(unknowns);
    rounded_.reset();
    made_for_ = wanted;
  }

  const CholeskyFactor& factor_;
  FactorPart part_;
  std::optional<FactorPart> rounded_;  // of part_, once it was asked for
  std::size_t made_for_ = 0;
};

struct Running {
  Request request;
  std::exception_ptr thrown;  // by the task
  std::unique_ptr<Coroutine::pull_type> coroutine;
};

// A task as far as its next request. What it throws waits for the others, which may not
// be left where they are: they would be unwound by an exception that they may swallow.
void run_task(const std::function<void(const RestSolve&)>& task, Running& running,
              Coroutine::push_type& yield) {
  Request& request = running.request;
  try {
    task([&](std::span<const std::int64_t> dof, const Eigen::VectorXd& source,
             SolveWith with) {
      request = {
          .dof = dof, .source = &source, .with = with, .result = {}, .failure = {}};
      yield();
      if (request.failure) {
        std::rethrow_exception(request.failure);
      }
      return std::move(request.result);
    });
  } catch (...) {
    running.thrown = std::current_exception();
  }
}

}  // namespace

RestSolve single_solves(const CholeskyFactor& factor) {
  return [solver = std::make_shared<PartSolver>(factor)](
             std::span<const std::int64_t> dof, const Eigen::VectorXd& source,
             SolveWith with) {
    Request request{
        .dof = dof, .source = &source, .with = with, .result = {}, .failure = {}};
    Request* const one = &request;
    solver->serve({&one, 1});
    return std::move(request.result);
  };
}

void run_in_lock_step(const CholeskyFactor& factor,
                      std::span<const std::function<void(const RestSolve&)>> tasks) {
  std::vector<Running> running(tasks.size());
  std::vector<Running*> waiting;
  std::vector<Request*> requests;
  PartSolver solver(factor);
  // 1. Every task runs to its first request or to its end: a coroutine starts when
  //    made.
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    running[i].coroutine = std::make_unique<Coroutine::pull_type>(
        boost::coroutines2::fixedsize_stack(kStackBytes),
        [&one = running[i], &task = tasks[i]](Coroutine::push_type& yield) {
          run_task(task, one, yield);
        });
  }
  for (;;) {
    // 2. The requests of all tasks that wait are served by one block solve.
    waiting.clear();
    requests.clear();
    for (Running& r : running) {
      if (*r.coroutine) {
        waiting.push_back(&r);
        requests.push_back(&r.request);
      }
    }
    if (waiting.empty()) {
      break;
    }
    std::exception_ptr failure;
    try {
      solver.serve(requests);
    } catch (...) {
      failure = std::current_exception();
    }
    // 3. Each task goes on to its next request. A solve that failed throws in each of
    //    them.
    for (Running* r : waiting) {
      r->request.failure = failure;
      (*r->coroutine)();
    }
  }
  for (const Running& r : running) {
    if (r.thrown) {
      std::rethrow_exception(r.thrown);
    }
  }
}

}  // namespace palpate
