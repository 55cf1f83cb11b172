#include "runtime/c_api/host_body.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/database/response_database.h"
#include "runtime/c_api/host_limits.h"
#include "runtime/realtime/clock.h"
#include "runtime/realtime/deadlines.h"
#include "runtime/served/fed_elements.h"
#include "runtime/served/join_scene.h"
#include "runtime/slow/file_elements.h"
#include "runtime/slow/file_press_site.h"

namespace palpate {
namespace {

// Of the exception that is being handled.
SlowFailure failure_in_hand() {
  try {
    throw;
  } catch (const Error& error) {
    return {error.exit_code(), error.what()};
  } catch (const std::exception& error) {
    return {1, error.what()};
  }
}

// What keeps a table in its file from being read; empty where nothing does.
std::string damage_of(const ElementSender* sender) {
  const auto* streamed = dynamic_cast<const StreamedElements*>(sender);
  return streamed != nullptr && streamed->is_damaged() ? streamed->damage() : "";
}

std::string damage_of(const ContactStream* contacts) {
  std::string why;
  for (std::size_t i = 0; contacts != nullptr && i < contacts->elements().size(); ++i) {
    why = why.empty() ? damage_of(contacts->elements()[i].get()) : why;
  }
  return why;
}

}  // namespace

HostBody::HostBody(const StoredSource& file, const HostOptions& options)
    : options_(options) {
  check(options_);
  if (options_.scene) {
    if (file.in_memory()) {
      throw InputError("a scene is opened by the name of its file, not by its bytes");
    }
    open_scene(file.path());
    begin();
    return;
  }
  file_ = file.name();
  sha256_ = database_sha256(file);
  if (options_.streamed) {
    source_ =
        responses_in_file(file, CacheOptions{}.budget_bytes, !options_.own_slow_steps);
    open_responses();
  } else {
    database_ = std::make_shared<const ResponseDatabase>(read_database(file));
    source_ = responses_in_memory(*database_);
    open_responses();
  }
  begin();
}

HostBody::HostBody(std::shared_ptr<const ResponseDatabase> database,
                   const HostOptions& options)
    : options_(options) {
  check(options_);
  if (options_.streamed) {
    throw InputError("a database in memory is not streamed: name its file instead");
  }
  database_ = std::move(database);
  source_ = responses_in_memory(*database_);
  open_responses();
  begin();
}

HostBody::~HostBody() {
  stop_slow();
}

void HostBody::begin() {
  if (const char* wrong = check(fast_)) {
    throw InputError(fmt::format("fast step: {}", wrong));
  }
  if (!options_.own_slow_steps) {
    start_slow();
  }
}

void HostBody::start_slow() {
  if (!thread_.joinable()) {
    stop_.store(false);
    thread_ = std::thread([this] {
      run();
    });
  }
}

void HostBody::stop_slow() {
  stop_.store(true);
  if (thread_.joinable()) {
    thread_.join();
  }
}

void HostBody::open_responses() {
  const PressingTool tool = source_->tool(options_.tool);
  tool_name_ = tool.shape.name;
  fast_ = fast_config(options_, tool.shape);
  several_ = !tool.shape.contact.empty();
  if (const ChunkReader* reader = source_->reader()) {
    const StreamedPlace place =
        streamed_place(*reader, find_tool(reader->index(), tool_name_), std::nullopt);
    start_m_ = place.around.body.position_m.row(place.row).transpose();
  }
  if (several_) {
    if (const char* wrong = check(coupled_set(std::span(&tool, 1)), fast_)) {
      throw InputError(fmt::format("tool \"{}\": {}", tool_name_, wrong));
    }
    const ContactStiffness contacts = stiffness_of(tool_name_);
    force_scale_ = contacts_scale(options_, contacts);
    stiffness_n_per_m_ =
        wrench_margin(contacts, 1.0, 0.0, options_.tick_s, options_.delay_s)
            .stiffness_n_per_m;
  } else {
    take_stiffness(source_->stiffness(tool_name_, fast_.model, fast_.force_max_n));
  }
  if (database_ != nullptr && several_) {
    contact_stream_ = contacts_of({tool_name_}, force_scale_);
  } else if (database_ != nullptr) {
    whole_ = source_->elements(tool_name_, force_scale_, start_m_);
  }
}

ContactStiffness HostBody::stiffness_of(const std::string& tool) const {
  return contact_stiffness(source_->tool(tool),
                           source_->stiffest(tool, fast_.model, fast_.force_max_n));
}

std::shared_ptr<ContactStream> HostBody::contacts_of(
    const std::vector<std::string>& tools, double force_scale) const {
  return source_->contacts(tools, force_scale, start_m_);
}

void HostBody::take_stiffness(const RenderedStiffness& stiffness) {
  stiffness_n_per_m_ = stiffness.largest_n_per_m();
  force_scale_ = renderable_scale(options_, stiffness);
}

void HostBody::open_scene(const std::filesystem::path& scene) {
  if (options_.damping_n_s_per_m > 0.0 && !options_.limit_stiffness) {
    throw InputError(
        "nobody knows yet how stiff a scene is: with the device's damping given, the "
        "flag to limit stiffness must be set, or the damping left out");
  }
  client_ = join_scene({.scene = scene,
                        .server = options_.server,
                        .output = options_.output,
                        .tool = options_.tool,
                        .estimate = options_.estimate});
  const std::atomic<bool> never = false;
  const ServedScene& served = client_->scene(never);
  database_ =
      std::make_shared<const ResponseDatabase>(body_of(served, client_->tool()));
  const ToolShape& tool = database_->tools.front().tool;
  tool_name_ = tool.name;
  fast_ = fast_config(options_, tool);
}

std::unique_ptr<HostBody::Served> HostBody::of_scene() const {
  auto elements =
      std::make_unique<FedElements>(*client_, *database_, renderable_n_per_m(options_));
  const GrowingElements& grown = elements->elements();
  auto made = std::make_unique<Served>(std::move(elements), nullptr, *this);
  made->grown = &grown;
  return made;
}

const GrowingElements* HostBody::grown(const HostTool& tool) const {
  const std::scoped_lock lock(mutex_);
  const auto found =
      std::find_if(tools_.begin(), tools_.end(), [&](const auto& served) {
        return &served->tool == &tool;
      });
  return found == tools_.end() ? nullptr : (*found)->grown;
}

std::int64_t HostBody::softened() const {
  const std::scoped_lock lock(mutex_);
  std::int64_t most = 0;  // every tool gets the same answers
  for (const auto& served : tools_) {
    most = std::max(most, served->grown == nullptr ? 0 : served->grown->softened());
  }
  return most;
}

Points HostBody::static_forces_n(const Points& position_m) {
  if (database_ == nullptr || client_ != nullptr || several_) {
    throw InputError(
        "forces at rest are of a tool of one contact and a whole database in memory");
  }
  std::call_once(field_made_, [&] {
    field_ = std::make_unique<StaticField>(
        *database_, find_tool(*database_, tool_name_), field_kind(fast_.model));
  });
  Points at(position_m.rows(), 3);
  for (Eigen::Index i = 0; i < at.rows(); ++i) {
    at.row(i) = placement_.point_in_body(position_m.row(i).transpose()).transpose();
  }
  Points force_n = force_scale_ * field_->force_n(at);
  for (Eigen::Index i = 0; i < at.rows(); ++i) {
    force_n.row(i) = placement_.vector_in_world(force_n.row(i).transpose()).transpose();
  }
  return force_n;
}

double HostBody::needed_damping_n_s_per_m() const {
  double stiffness_n_per_m = force_scale_ * stiffness_n_per_m_;
  if (client_ != nullptr) {
    const std::scoped_lock lock(mutex_);
    for (const auto& served : tools_) {
      stiffness_n_per_m =
          std::max(stiffness_n_per_m, served->grown->stiffest_n_per_m());
    }
  }
  return stiffness_n_per_m * options_.position_gain * options_.force_gain *
         (0.5 * options_.tick_s + options_.delay_s);
}

void HostBody::check_room() const {
  const std::scoped_lock lock(mutex_);
  if (tools_.size() == kHostToolsMax) {
    throw InputError(
        fmt::format("a body takes {} tools at most, all are there", kHostToolsMax));
  }
}

// Made before: who makes it takes its time, and others in contact wait for elements.
HostTool& HostBody::keep(std::unique_ptr<Served> tool) {
  const std::scoped_lock lock(mutex_);
  tools_.push_back(std::move(tool));
  return tools_.back()->tool;
}

HostTool& HostBody::add_tool() {
  check_room();
  if (several_) {
    return keep(std::make_unique<Served>(
        contact_stream_ ? contact_stream_ : contacts_of({tool_name_}, force_scale_),
        *this));
  }
  if (client_ != nullptr) {
    return keep(of_scene());
  }
  return keep(std::make_unique<Served>(
      whole_ ? nullptr : source_->elements(tool_name_, force_scale_, start_m_),
      whole_.get(), *this));
}

HostBody::Together HostBody::add_together(const std::string& second) {
  if (source_ == nullptr) {
    throw InputError(
        "two hands press a body together whose table of compliance is there: a scene "
        "has none yet, build its database first");
  }
  const std::string& other = second.empty() ? tool_name_ : second;
  const double scale =
      std::min(force_scale_, contacts_scale(options_, stiffness_of(other)));
  const auto stream = contacts_of({tool_name_, other}, scale);
  if (const char* wrong = check(stream->set(), fast_)) {
    throw InputError(fmt::format("two hands: {}", wrong));
  }
  check_room();
  return {keep(std::make_unique<Served>(stream, *this)), scale};
}

std::size_t HostBody::slow_step() {
  if (thread_.joinable()) {
    throw InputError("a slow thread is at work already: no slow steps of the host's");
  }
  const std::scoped_lock lock(mutex_);
  try {
    return serve();
  } catch (...) {
    failure_ = failure_in_hand();
    throw;
  }
}

SlowFailure HostBody::slow_failure() {
  const std::scoped_lock lock(mutex_);
  return failure_;
}

std::size_t HostBody::serve() {
  MonotonicClock clock;
  std::size_t sent = 0;
  for (const auto& served : tools_) {
    sent += served->tool.serve(clock.now_ns());
    std::string why = damage_of(served->sender.get());
    why = why.empty() ? damage_of(served->contacts.get()) : why;
    if (!why.empty()) {
      failure_ = {FormatError("").exit_code(), why};
    }
  }
  return sent;
}

// The slow thread. After an error no element is sent: in contact, tools then stall.
void HostBody::run() noexcept {
  MonotonicClock clock;
  Deadlines deadlines(clock.now_ns(), options_.slow_hz);
  while (!stop_.load()) {
    clock.sleep_until_ns(deadlines.next_ns());
    static_cast<void>(deadlines.begin(clock.now_ns()));
    const std::scoped_lock lock(mutex_);
    try {
      serve();
    } catch (...) {
      failure_ = failure_in_hand();
      return;
    }
  }
}

}  // namespace palpate
