#include "runtime/usb/usb_transport.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <libusb-1.0/libusb.h>

#include "formats/base/error.h"
#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

constexpr std::size_t kInTransfers = 2;
constexpr std::size_t kReceivedMax = 4096;
constexpr int kErrorsMax = 8;  // transfers that fail in a row: the device is gone
constexpr unsigned kControlMs = 1000;
constexpr std::int64_t kCancelNs = 500'000'000;

std::int64_t now_ns() noexcept {
  MonotonicClock clock;
  return clock.now_ns();
}

void demand(int result, const char* step) {
  if (result < 0) {
    throw DeviceError(fmt::format("USB device: {}: {}", step,
                                  libusb_strerror(static_cast<libusb_error>(result))));
  }
}

}  // namespace

std::int64_t deadline_ns_after(double wait_s) noexcept {
  return now_ns() + std::llround(wait_s * kNanosecondsPerSecond);
}

struct UsbTransport::State {
  UsbPair pair;
  libusb_context* context = nullptr;
  libusb_device_handle* handle = nullptr;
  bool claimed = false;
  bool closing = false;
  bool lost = false;
  bool stalled = false;
  int errors = 0;
  std::array<libusb_transfer*, kInTransfers> in{};
  libusb_transfer* out = nullptr;
  int in_flight = 0;
  bool out_busy = false;
  libusb_transfer_status out_status = LIBUSB_TRANSFER_COMPLETED;
  std::vector<std::uint8_t> buffers;
  std::array<std::uint8_t, kReceivedMax> received{};
  std::size_t received_count = 0;

  ~State() { release(); }

  void release() noexcept {
    closing = true;
    if (handle != nullptr) {
      cancel();
    }
    for (libusb_transfer* transfer : in) {
      libusb_free_transfer(transfer);
    }
    libusb_free_transfer(out);
    if (claimed) {
      libusb_release_interface(handle, pair.interface);  // and re-attaches
    }
    if (handle != nullptr) {
      libusb_close(handle);
    }
    if (context != nullptr) {
      libusb_exit(context);
    }
  }

  void cancel() noexcept {
    for (libusb_transfer* transfer : in) {
      if (transfer != nullptr) {
        libusb_cancel_transfer(transfer);
      }
    }
    if (out_busy) {
      libusb_cancel_transfer(out);
    }
    const std::int64_t until_ns = now_ns() + kCancelNs;
    while ((in_flight > 0 || out_busy) && now_ns() < until_ns) {
      pump(until_ns);
    }
  }

  void submit_in(libusb_transfer* transfer) noexcept {
    const int result = libusb_submit_transfer(transfer);
    if (result == LIBUSB_SUCCESS) {
      ++in_flight;
    } else if (result == LIBUSB_ERROR_NO_DEVICE || ++errors >= kErrorsMax) {
      lost = true;
    }
  }

  // Counts an end that was none; true if the transfer is worth another try.
  bool judge(libusb_transfer_status status) noexcept {
    switch (status) {
      case LIBUSB_TRANSFER_COMPLETED:
        errors = 0;
        return true;
      case LIBUSB_TRANSFER_NO_DEVICE:
        lost = true;
        return false;
      case LIBUSB_TRANSFER_STALL:
        stalled = true;
        break;
      default:
        break;
    }
    lost = lost || ++errors >= kErrorsMax;
    return !lost;
  }

  void keep(const libusb_transfer& transfer) noexcept {
    const auto length = static_cast<std::size_t>(transfer.actual_length);
    if (length <= pair.status_bytes) {
      return;
    }
    const std::size_t count = length - pair.status_bytes;
    if (received_count + count > received.size()) {
      received_count = 0;  // nobody has read for long: what is old is of no use
    }
    std::memcpy(&received[received_count], transfer.buffer + pair.status_bytes, count);
    received_count += count;
  }

  static void in_done(libusb_transfer* transfer) noexcept {
    State& state = *static_cast<State*>(transfer->user_data);
    --state.in_flight;
    if (state.closing || transfer->status == LIBUSB_TRANSFER_CANCELLED) {
      return;
    }
    if (transfer->status == LIBUSB_TRANSFER_COMPLETED) {
      state.keep(*transfer);
    }
    if (state.judge(transfer->status) && !state.stalled) {
      state.submit_in(transfer);
    }
  }

  static void out_done(libusb_transfer* transfer) noexcept {
    State& state = *static_cast<State*>(transfer->user_data);
    state.out_busy = false;
    state.out_status = transfer->status;
  }

  void pump(std::int64_t deadline_ns) noexcept {
    const std::int64_t wait_us =
        std::max<std::int64_t>(0, (deadline_ns - now_ns()) / 1000);
    timeval wait{.tv_sec = wait_us / 1'000'000, .tv_usec = wait_us % 1'000'000};
    const int result = libusb_handle_events_timeout_completed(context, &wait, nullptr);
    lost = lost || result == LIBUSB_ERROR_NO_DEVICE || result == LIBUSB_ERROR_IO;
    if (stalled && !closing && !lost) {
      stalled = false;
      libusb_clear_halt(handle, pair.in);
      libusb_clear_halt(handle, pair.out);
      if (in_flight == 0) {
        for (libusb_transfer* transfer : in) {
          submit_in(transfer);
        }
      }
    }
  }

  void open(int descriptor) {
    demand(libusb_init(&context), "start of libusb");
    demand(libusb_wrap_sys_device(context, descriptor, &handle), "open");
    static_cast<void>(libusb_set_auto_detach_kernel_driver(handle, 1));
    demand(libusb_claim_interface(handle, pair.interface),
           "claim of the interface (is another program using it?)");
    claimed = true;
    buffers.resize((kInTransfers + 1) * pair.packet_bytes);
    out = libusb_alloc_transfer(0);
    for (std::size_t i = 0; i < kInTransfers; ++i) {
      in[i] = libusb_alloc_transfer(0);
    }
    if (out == nullptr || in[0] == nullptr || in[1] == nullptr) {
      throw DeviceError("USB device: no memory for transfers");
    }
    const auto size = static_cast<int>(pair.packet_bytes);
    libusb_fill_bulk_transfer(out, handle, pair.out, buffers.data(), 0,
                              &State::out_done, this, 0);
    for (std::size_t i = 0; i < kInTransfers; ++i) {
      libusb_fill_bulk_transfer(in[i], handle, pair.in,
                                &buffers[(i + 1) * pair.packet_bytes], size,
                                &State::in_done, this, 0);
      submit_in(in[i]);
    }
  }
};

UsbTransport::UsbTransport(int descriptor, const UsbPair& pair)
    : state_(std::make_unique<State>()) {
  state_->pair = pair;
  state_->open(descriptor);
}

UsbTransport::~UsbTransport() = default;

void UsbTransport::control(const UsbRequest& request) {
  const int result =
      state_->lost ? static_cast<int>(LIBUSB_ERROR_NO_DEVICE)
                   : libusb_control_transfer(state_->handle, request.request_type,
                                             request.request, request.value,
                                             request.index, nullptr, 0, kControlMs);
  state_->lost = state_->lost || result == LIBUSB_ERROR_NO_DEVICE;
  demand(result, "control request");
}

UsbStatus UsbTransport::send(std::span<const std::uint8_t> bytes,
                             std::int64_t deadline_ns) noexcept {
  State& s = *state_;
  const std::size_t count = std::min(bytes.size(), s.pair.packet_bytes);
  // 1. One transfer goes out at a time. That of a send which timed out has to end
  // first.
  while (s.out_busy && !s.lost && now_ns() < deadline_ns) {
    s.pump(deadline_ns);
  }
  if (s.lost) {
    return UsbStatus::kLost;
  }
  if (s.out_busy) {
    libusb_cancel_transfer(s.out);
    return UsbStatus::kTimeout;
  }
  // 2. The transfer's own buffer, so that nothing is allocated here.
  std::memcpy(s.out->buffer, bytes.data(), count);
  s.out->length = static_cast<int>(count);
  const int result = libusb_submit_transfer(s.out);
  if (result != LIBUSB_SUCCESS) {
    s.lost = s.lost || result == LIBUSB_ERROR_NO_DEVICE || ++s.errors >= kErrorsMax;
    return s.lost ? UsbStatus::kLost : UsbStatus::kTimeout;
  }
  s.out_busy = true;
  // 3. libusb runs callbacks in pump() alone: out_done() clears out_busy.
  do {
    s.pump(deadline_ns);
  } while (s.out_busy && !s.lost && now_ns() < deadline_ns);
  if (s.out_busy) {
    libusb_cancel_transfer(s.out);
  } else if (s.judge(s.out_status) && s.out_status == LIBUSB_TRANSFER_COMPLETED) {
    return UsbStatus::kOk;
  }
  return s.lost ? UsbStatus::kLost : UsbStatus::kTimeout;
}

UsbStatus UsbTransport::receive(std::span<std::uint8_t> bytes, std::size_t& got,
                                std::int64_t deadline_ns) noexcept {
  State& s = *state_;
  got = 0;
  while (s.received_count == 0 && !s.lost) {
    const bool over = now_ns() >= deadline_ns;
    s.pump(deadline_ns);  // what has come counts, however late this thread is
    if (over && s.received_count == 0 && !s.lost) {
      return UsbStatus::kTimeout;
    }
  }
  if (s.received_count == 0) {
    return UsbStatus::kLost;
  }
  got = std::min(bytes.size(), s.received_count);
  std::memcpy(bytes.data(), s.received.data(), got);
  s.received_count -= got;
  std::memmove(s.received.data(), s.received.data() + got, s.received_count);
  return UsbStatus::kOk;
}

void UsbTransport::drop_received() noexcept {
  state_->received_count = 0;
}

bool UsbTransport::lost() const noexcept {
  return state_->lost;
}

}  // namespace palpate
