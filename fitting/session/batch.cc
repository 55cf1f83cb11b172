#include "fitting/session/batch.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <iterator>
#include <map>
#include <mutex>

#include <fmt/format.h>

#include "fitting/curve/split_presses.h"
#include "fitting/session/session_machine.h"
#include "fitting/session/session_probes.h"
#include "formats/base/error.h"
#include "formats/base/named_message.h"
#include "formats/base/on_threads.h"
#include "formats/base/stopwatch.h"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

void collect_flags(RunResult& result) {
  result.flags = result.contact.flags;
  take_misfit(result.choice, result.flags);
  for (const FitFlag flag : result.modulus.flags) {
    if (std::find(result.flags.begin(), result.flags.end(), flag) ==
        result.flags.end()) {
      result.flags.push_back(flag);
    }
  }
}

void fit(const Session& session, const Measurement& samples,
         const FrameCompliance* frame, RunResult& result) {
  CorrectedPress press =
      correct_press(samples, frame, session.fit.range, session.fit.baseline,
                    session.fit.noise_relative);
  model_adhesion(session.indenter, press);
  result.corrections = press.corrections;
  result.approach = press.approach;
  result.contact = press.contact;
  result.choice = choose_family(session.fit, result.approach, result.contact);
  result.modulus = corrected_modulus(press, session.indenter);
  result.relaxation = find_relaxation(press.samples);
  result.loop = find_loop(press.moved, result.approach, result.contact);
  result.segments = find_segments(turned(samples, result.approach).depth_m);
  collect_flags(result);
  result.rating = rate(result.contact, result.choice);
}

// Standard deviation over mean of the force at 80 % of the depth that all repeats
// reach.
double scatter(const std::vector<RunResult*>& repeats) {
  double depth = std::numeric_limits<double>::infinity();
  for (const RunResult* run : repeats) {
    depth = std::min(depth, 0.8 * run->best()->depth_max_m);
  }
  double sum = 0.0, squares = 0.0;
  for (const RunResult* run : repeats) {
    const double force = family_point(*run->best(), depth).force;
    sum += force;
    squares += force * force;
  }
  const auto n = static_cast<double>(repeats.size());
  const double mean = sum / n;
  return std::sqrt(std::max(0.0, (squares - n * mean * mean) / (n - 1.0))) / mean;
}

void compare_repeats(BatchReport& report) {
  std::map<std::pair<std::string, std::string>, std::vector<RunResult*>> points;
  for (RunResult& run : report.runs) {
    if (run.best() != nullptr && run.rating.verdict != Verdict::kSkip) {
      points[{run.specimen, run.point}].push_back(&run);
    }
  }
  for (const auto& [point, repeats] : points) {
    for (RunResult* run : repeats) {
      if (repeats.size() > 1) {
        run->rating.features.repeat_scatter = scatter(repeats);
      }
    }
  }
}

// What is being thrown, whatever it is.
std::string thrown() {
  try {
    throw;
  } catch (const std::exception& error) {
    return error.what();
  } catch (...) {
    return "an error without a name";
  }
}

void fit_or_say(const Session& session, const Measurement& samples,
                const FrameCompliance* frame, const std::string& unreadable,
                RunResult& result) {
  result.bad = unreadable;
  if (unreadable.empty()) {
    try {
      fit(session, samples, frame, result);
      return;
    } catch (...) {
      result.bad = with_name(result.run_name, thrown());
    }
  }
  result.rating = Rating{};
  result.rating.gates.emplace_back("bad_file");
  result.choice = FamilyChoice{};
}

}  // namespace

void model_adhesion(const Indenter& indenter, CorrectedPress& press) {
  if (indenter.shape == "sphere" && !(indenter.thickness_m > 0.0) &&
      press.corrections.adhesion.seen()) {
    press.corrections.jkr =
        fit_jkr(press.approach, press.corrections.adhesion, indenter.radius_m);
  }
}

Modulus corrected_modulus(const CorrectedPress& press, const Indenter& indenter) {
  Modulus modulus = find_modulus(press.approach, press.contact, indenter);
  if (press.softer && modulus.refused.empty()) {
    const Modulus softer =
        find_modulus(press.softer->approach, press.softer->contact, indenter);
    if (softer.refused.empty()) {
      modulus.sd_pa = std::hypot(modulus.sd_pa,
                                 softer.youngs_modulus_pa - modulus.youngs_modulus_pa);
    }
  }
  return modulus;
}

std::vector<RunResult> fit_run(const Session& session, const SessionRun& run,
                               const FrameCompliance* frame) {
  std::vector<Measurement> presses;
  std::vector<std::size_t> chosen{1};
  std::string unreadable;
  const auto begin = Clock::now();
  try {
    presses = split_presses(read_run(session, run).samples);
    chosen = chosen_cycles(session.fit.cycle.value_or(CycleChoice{}), presses.size());
  } catch (...) {
    unreadable = thrown();
    presses.resize(std::max<std::size_t>(1, presses.size()));
  }
  std::vector<RunResult> results;
  double counted_s = 0.0;  // reading counts for the first press
  for (const std::size_t number : chosen) {
    RunResult& result = results.emplace_back();
    result.press = number;
    result.presses = presses.size();
    result.name = number == 1 ? run.name : fmt::format("{} press {}", run.name, number);
    result.run_name = run.name;
    result.point = run.point;
    result.specimen = run.specimen;
    result.position_m = run.position_m;
    fit_or_say(session, presses[number - 1], frame, unreadable, result);
    if (results.size() == 1 && unreadable.empty()) {
      try {
        result.cycles = summarise_cycles(presses, frame);
      } catch (...) {  // each press says what ails it
        result.cycles.clear();
      }
    }
    result.seconds = seconds_since(begin) - counted_s;
    counted_s += result.seconds;
  }
  return results;
}

BatchReport fit_session(const Session& session, unsigned threads,
                        const std::function<void(std::size_t)>& progress) {
  const auto begin = Clock::now();
  BatchReport report;
  report.frame = session_frame(session);
  const FrameCompliance* frame = report.frame ? &report.frame->frame : nullptr;
  std::vector<std::vector<RunResult>> results(session.run.size());
  std::atomic<std::size_t> done{0};
  std::mutex telling;
  on_threads(threads, session.run.size(), [&](std::size_t i) {
    results[i] = fit_run(session, session.run[i], frame);
    const std::size_t count = ++done;
    const std::lock_guard<std::mutex> lock(telling);
    progress(count);
  });
  for (std::vector<RunResult>& presses : results) {
    std::move(presses.begin(), presses.end(), std::back_inserter(report.runs));
  }
  compare_repeats(report);
  report.seconds = seconds_since(begin);
  return report;
}

}  // namespace palpate
