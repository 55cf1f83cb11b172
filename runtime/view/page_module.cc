// The runtime of a page that needs no server, as a WebAssembly module: PageBody behind
// functions of numbers (runtime_worker.js calls them). Bytes go in through room(), and
// come out at ready().
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/base/error.h"
#include "formats/database/response_database.h"
#include "runtime/view/page_body.h"

#define PALPATE_EXPORTED(name) __attribute__((export_name(#name)))

namespace palpate {
namespace {

struct PageModule {
  std::string given;               // what the page has put in last
  std::vector<std::string> names;  // of the database, then of tools
  std::optional<std::string> told;
  std::string_view ready;
  InverseConfig inverse;
  std::unique_ptr<PageBody> body;
};

PageModule& module() {
  static PageModule all;
  return all;
}

// How many bytes are ready.
std::size_t ready(std::string_view bytes) {
  module().ready = bytes;
  return bytes.size();
}

std::size_t say(std::string text) {
  module().told = std::move(text);
  return ready(*module().told);
}

void open() {
  PageModule& m = module();
  const std::string flat = std::exchange(m.given, {});
  ViewSessionOptions options;
  options.tools.assign(m.names.begin() + 1, m.names.end());
  m.body = std::make_unique<PageBody>(
      read_database(StoredSource(std::as_bytes(std::span(flat)), m.names.front())),
      m.names.front(), options, m.inverse);
}

PageDevice& own_device() {
  return module().body->device();
}

}  // namespace

extern "C" {

/// Where the page puts `bytes` bytes, for the next call.
PALPATE_EXPORTED(palpate_page_room) char* palpate_page_room(std::size_t bytes) {
  module().given.resize(bytes);
  return module().given.data();
}

/// Where the bytes are that a call has ready, until the next call.
PALPATE_EXPORTED(palpate_page_ready) const char* palpate_page_ready() {
  return module().ready.data();
}

/// First the name of the database, then those of tools.
PALPATE_EXPORTED(palpate_page_name) void palpate_page_name() {
  module().names.push_back(std::exchange(module().given, {}));
}

/// A database in flat form. @return 0, or bytes of a sentence that says why not
PALPATE_EXPORTED(palpate_page_open) std::size_t palpate_page_open() {
  try {
    open();
    return 0;
  } catch (const std::exception& error) {
    return say(error.what());
  }
}

/// body.json and body.bin.
PALPATE_EXPORTED(palpate_page_text) std::size_t palpate_page_text() {
  return ready(module().body->text());
}
PALPATE_EXPORTED(palpate_page_body) std::size_t palpate_page_body() {
  return ready(module().body->bytes());
}

/// A message of the page.
PALPATE_EXPORTED(palpate_page_receive) void palpate_page_receive() {
  module().body->receive(module().given);
}

/// @param now_ms [ms] by the page's clock
PALPATE_EXPORTED(palpate_page_frame) void palpate_page_frame(double now_ms) {
  module().body->frame(nanoseconds_in(1e-3 * now_ms));
}

/// The next message to the page; 0: none.
PALPATE_EXPORTED(palpate_page_take) std::size_t palpate_page_take() {
  module().told = module().body->take();
  return ready(module().told ? std::string_view(*module().told) : "");
}

/// Of Haply's service, before the database.
PALPATE_EXPORTED(palpate_page_ports) void palpate_page_ports(int states, int events) {
  module().inverse.port = static_cast<std::uint16_t>(states);
  module().inverse.events_port = static_cast<std::uint16_t>(events);
}

/// Whether the page wants messages of a device carried: from 0 to 1 a connection is to
/// be made, from 1 to 0 it is to be closed.
PALPATE_EXPORTED(palpate_page_device_active) int palpate_page_device_active() {
  return own_device().active() ? 1 : 0;
}

/// A message of states that came. @param now_ms, received_ms [ms] by the page's clock
/// @param withheld, asked as HeardAt's
PALPATE_EXPORTED(palpate_page_device_hear)
void palpate_page_device_hear(double now_ms, double received_ms, int withheld,
                              int asked) {
  own_device().hear(module().given, {.now_ns = nanoseconds_in(1e-3 * now_ms),
                                     .received_ns = nanoseconds_in(1e-3 * received_ms),
                                     .withheld = withheld != 0,
                                     .asked = asked != 0});
}

/// A message of events.
PALPATE_EXPORTED(palpate_page_device_event) void palpate_page_device_event() {
  own_device().hear_event(module().given);
}

/// The connection is gone, for the reason that the page has put in.
PALPATE_EXPORTED(palpate_page_device_gone) void palpate_page_device_gone() {
  own_device().let_go(module().given);
}

/// Time has passed: a few times within InverseConfig::answer_s.
PALPATE_EXPORTED(palpate_page_device_watch)
void palpate_page_device_watch(double now_ms) {
  own_device().watch(nanoseconds_in(1e-3 * now_ms));
}

/// What is to be sent after any call; 0: nothing.
PALPATE_EXPORTED(palpate_page_device_command)
std::size_t palpate_page_device_command() {
  return say(own_device().take_command());
}

}  // extern "C"

}  // namespace palpate
