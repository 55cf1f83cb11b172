#include "precompute/serve/service_sessions.h"

#include <chrono>
#include <utility>
#include <variant>

#include "formats/base/error.h"

namespace palpate {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds kSendTimeout{10000};
constexpr milliseconds kTurn{20};     // between looks at what a hand says
constexpr milliseconds kAlive{1000};  // progress is said at least as often
constexpr milliseconds kFarewell{5000};
constexpr milliseconds kLastCall{1000};  // for who is about to join at the end

// What one who joined has heard so far.
struct Heard {
  std::size_t frames = 0;
  std::uint64_t progress = 0;
  AnswerLog::Frame latest;
  Clock::time_point said = Clock::now();
};

// False if the other end does not listen.
bool tell_news(const AnswerLog::News& news, Heard& heard,
               ServiceConnection& connection) {
  for (const AnswerLog::Frame& frame : news.frame) {
    if (!connection.send(*frame, kSendTimeout)) {
      return false;
    }
    ++heard.frames;
  }
  heard.latest = news.progress ? news.progress : heard.latest;
  heard.progress = news.progress_number;
  const bool due = news.progress || Clock::now() - heard.said > kAlive;
  if (!news.ended && due && heard.latest) {
    heard.said = Clock::now();
    return connection.send(*heard.latest, kSendTimeout);
  }
  return true;
}

}  // namespace

ServiceSessions::ServiceSessions(const std::filesystem::path& socket,
                                 const AnswerLog& log, HandPlaces& hands)
    : log_(log), hands_(hands), listener_(socket), joining_([this] {
        let_join();
      }) {}

ServiceSessions::~ServiceSessions() {
  closing_ = true;
  joining_.join();
  for (Session& session : session_) {
    session.thread.join();
  }
}

void ServiceSessions::let_join() {
  auto last_call = Clock::time_point::max();
  for (int who = 0; Clock::now() < last_call; ++who) {
    if (closing_ && last_call == Clock::time_point::max()) {
      last_call = Clock::now() + kLastCall;
    }
    if (auto connection = listener_.accept(milliseconds(100))) {
      Session& session = session_.emplace_back();
      session.thread =
          std::thread([this, who, &session, joined = std::move(*connection)]() mutable {
            serve(who, std::move(joined));
            session.over = true;
          });
    }
    forget_those_who_left();
  }
}

void ServiceSessions::forget_those_who_left() {
  for (auto session = session_.begin(); session != session_.end();) {
    if (session->over) {
      session->thread.join();
      session = session_.erase(session);
    } else {
      ++session;
    }
  }
}

void ServiceSessions::serve(int who, ServiceConnection connection) {
  Heard heard;
  auto farewell = Clock::time_point::max();
  try {
    while (connection.is_open() && Clock::now() < farewell) {
      const AnswerLog::News news = log_.after(heard.frames, heard.progress, kTurn);
      if (closing_ && farewell == Clock::time_point::max()) {
        farewell = Clock::now() + kFarewell;
      }
      if (!tell_news(news, heard, connection) ||
          (news.frame.empty() && closing_ && !news.ended)) {
        break;
      }
      // After the last message the other end leaves by itself.
      const milliseconds wait = news.ended ? kTurn : milliseconds(0);
      while (const auto message = connection.receive(wait)) {
        if (const auto* hand = std::get_if<HandPlace>(&*message)) {
          hands_.put(who, *hand);
        }
      }
    }
  } catch (const FormatError&) {
    // What came is no message: the connection ends here.
  }
  hands_.remove(who);
}

}  // namespace palpate
