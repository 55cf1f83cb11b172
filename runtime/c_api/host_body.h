// A body in somebody else's simulator: its database, its slow process, its tools.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "formats/database/response_database.h"
#include "runtime/c_api/host_tool.h"
#include "runtime/device/stability_margin.h"
#include "runtime/render/one_contact.h"
#include "runtime/render/several_contacts.h"
#include "runtime/served/served_client.h"
#include "runtime/slow/contact_elements.h"
#include "runtime/slow/element_source.h"
#include "runtime/slow/response_source.h"
#include "runtime/slow/static_field.h"

namespace palpate {

constexpr std::size_t kHostToolsMax = 16;

/// What ended a slow process.
struct SlowFailure {
  int exit_code = 0;  ///< as Error::exit_code(); 1 for anything else; 0: nothing did
  std::string text;   ///< one line
};

/// All but the tools' haptic functions may wait and allocate.
class HostBody {
 public:
  /// Opens the database and, unless options.own_slow_steps, starts the slow thread.
  /// Of a scene: waits for its service's first message. @throws InputError,
  /// FormatError; InputError for a body that is stiffer than the device can render,
  /// unless options.limit_stiffness.
  /// Bytes in memory are read meanwhile alone; with options.streamed they must outlive
  /// the body. @throws InputError for a scene in memory.
  HostBody(const StoredSource& file, const HostOptions& options);

  /// Of a database in memory, which no file holds.
  /// @throws InputError as above, and for options.streamed.
  HostBody(std::shared_ptr<const ResponseDatabase> database,
           const HostOptions& options);
  ~HostBody();
  HostBody(const HostBody&) = delete;
  HostBody& operator=(const HostBody&) = delete;

  /// Lives as long as the body. @throws InputError past kHostToolsMax.
  HostTool& add_tool();

  struct Together {
    HostTool& tool;
    double force_scale;  ///< [-] (0, 1] of both hands
  };

  /// A tool of two hands that press the body together, coupled through it: the body's
  /// own, and `second` (empty: another of the same). @throws InputError as add_tool()
  /// and coupled_set(). @throws InputError for a scene, for a model that several
  /// contacts have not, and for a second tool that the device cannot render.
  Together add_together(const std::string& second);

  /// Starts and ends the slow thread, by one thread at a time; nothing where it is so
  /// already.
  void start_slow();
  void stop_slow();
  [[nodiscard]] bool slow_runs() const noexcept { return thread_.joinable(); }

  /// One turn of the slow process, for every tool that has moved. @returns elements
  /// sent. @throws InputError if there is a slow thread; what ended the process.
  std::size_t slow_step();

  [[nodiscard]] SlowFailure slow_failure();

  [[nodiscard]] const HostOptions& options() const noexcept { return options_; }
  /// What the database was opened by, and its content's digest; empty of a scene, and
  /// of a database that no file holds.
  [[nodiscard]] const std::string& file() const noexcept { return file_; }
  [[nodiscard]] const std::string& sha256() const noexcept { return sha256_; }
  /// Of the tool that all tools of the body are.
  [[nodiscard]] const std::string& tool_name() const noexcept { return tool_name_; }
  [[nodiscard]] double force_scale() const noexcept { return force_scale_; }

  /// How the body stands in the host's world. Not while one of its tools steps.
  [[nodiscard]] BodyPlacement& placement() noexcept { return placement_; }
  [[nodiscard]] const BodyPlacement& placement() const noexcept { return placement_; }

  /// The surface, where it is in memory; else null.
  [[nodiscard]] const SurfaceMesh* mesh() const noexcept {
    return database_ == nullptr ? nullptr : &database_->body;
  }

  /// All of it, in memory; null: streamed, or a scene.
  [[nodiscard]] const ResponseDatabase* database() const noexcept {
    return client_ == nullptr ? database_.get() : nullptr;
  }

  /// Forces [N] (n x 3) on the tool at rest, as they are rendered but for friction and
  /// history, in the world. @param position_m (n x 3) [m] there. @throws InputError for
  /// a tool of several contacts, a body that is not in memory or yields, a position
  /// that is not finite.
  [[nodiscard]] Points static_forces_n(const Points& position_m);

  /// [N s/m] b = K (T/2 + delay), K the largest stiffness as the device feels it
  /// (Colgate & Schenkel 1997; Diolaiti et al. 2006).
  [[nodiscard]] double needed_damping_n_s_per_m() const;

  /// Of a scene; null: of a database.
  [[nodiscard]] const ServedClient* service() const noexcept { return client_.get(); }
  /// Answers of a scene that were softened for the device.
  [[nodiscard]] std::int64_t softened() const;
  /// What a scene's tool has got so far; null: of a database. Lives with the tool.
  [[nodiscard]] const GrowingElements* grown(const HostTool& tool) const;

 private:
  struct Served {
    // @param own null: the body's, which is `shared`.
    Served(std::unique_ptr<ElementSender> own, ElementSender* shared,
           const HostBody& body)
        : sender(std::move(own)),
          tool(std::make_unique<OneContact>(body.fast_, sender ? *sender : *shared),
               {body.tool_name_}, body.placement_, body.options_.tick_s,
               body.options_.stall_s) {}
    Served(const std::shared_ptr<ContactStream>& stream, const HostBody& body)
        : contacts(stream),
          tool(std::make_unique<SeveralContacts>(stream, body.fast_,
                                                 ContactsHeld{.watch_turns = false}),
               stream->tables(), body.placement_, body.options_.tick_s,
               body.options_.stall_s) {}
    std::unique_ptr<ElementSender> sender;    // null: the body's
    std::shared_ptr<ContactStream> contacts;  // of several contacts
    const GrowingElements* grown = nullptr;   // the sender's, of a scene
    HostTool tool;
  };

  void open_responses();
  [[nodiscard]] ContactStiffness stiffness_of(const std::string& tool) const;
  [[nodiscard]] std::shared_ptr<ContactStream> contacts_of(
      const std::vector<std::string>& tools, double force_scale) const;
  void check_room() const;
  HostTool& keep(std::unique_ptr<Served> tool);
  void open_scene(const std::filesystem::path& scene);
  [[nodiscard]] std::unique_ptr<Served> of_scene() const;
  void begin();
  void take_stiffness(const RenderedStiffness& stiffness);
  std::size_t serve();  // with mutex_ held
  void run() noexcept;

  HostOptions options_;
  std::string file_;
  std::string sha256_;
  std::string tool_name_;
  double force_scale_ = 1.0;
  double stiffness_n_per_m_ = 0.0;  // largest, at gains of 1 and scale 1
  FastConfig fast_;
  BodyPlacement placement_;
  std::shared_ptr<const ResponseDatabase> database_;  // null: streamed; scene: empty
  std::unique_ptr<ResponseSource> source_;            // null: a scene
  Eigen::Vector3d start_m_ = Eigen::Vector3d::Zero();
  std::unique_ptr<ElementSender> whole_;  // of all tools of one contact, in memory
  std::once_flag field_made_;
  std::unique_ptr<StaticField> field_;             // of static_forces_n()
  std::shared_ptr<ContactStream> contact_stream_;  // likewise, of several
  bool several_ = false;                           // contacts has its tool
  std::unique_ptr<ServedClient> client_;           // of a scene
  mutable std::mutex mutex_;  // of all below; never taken in a haptic function
  std::vector<std::unique_ptr<Served>> tools_;
  SlowFailure failure_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace palpate
