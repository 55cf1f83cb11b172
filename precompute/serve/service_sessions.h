// Those who have joined a service: each hears all that is said and says where its hand
// is.
#pragma once

#include <atomic>
#include <filesystem>
#include <list>
#include <thread>

#include "formats/service/service_socket.h"
#include "precompute/serve/answer_log.h"
#include "precompute/serve/hand_places.h"

namespace palpate {

/// Threads of its own: one that lets others join, and one for each who has. Who sends
/// what is no message, or does not take what is sent within ten seconds, is let go.
class ServiceSessions {
 public:
  /// Both must outlive this. @throws InputError as ServiceListener.
  ServiceSessions(const std::filesystem::path& socket, const AnswerLog& log,
                  HandPlaces& hands);
  /// Who has joined, or joins within a second, still hears what has been said, for five
  /// seconds at most.
  ~ServiceSessions();
  ServiceSessions(const ServiceSessions&) = delete;
  ServiceSessions& operator=(const ServiceSessions&) = delete;

 private:
  struct Session {
    std::thread thread;
    std::atomic<bool> over = false;
  };

  void let_join();
  void serve(int who, ServiceConnection connection);
  void forget_those_who_left();

  const AnswerLog& log_;
  HandPlaces& hands_;
  ServiceListener listener_;
  std::atomic<bool> closing_ = false;
  std::list<Session> session_;  // of the joining thread alone
  std::thread joining_;
};

}  // namespace palpate
