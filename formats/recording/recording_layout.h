// The one place that says which field of a recording is which object of its file; the
// writer and the reader walk these tables.
#pragma once

#include <array>
#include <cstddef>

#include "formats/recording/recording.h"

namespace palpate::recording {

/// A dataset of `width` values per row (1: one-dimensional), from a member of a row.
struct Column {
  const char* path;
  const char* units;
  Hdf5Type type;
  std::size_t offset;  ///< [bytes] of the member in the row
  std::size_t width;
};

struct TextField {
  const char* name;  ///< of the attribute of "/"
  std::string RecordingHeader::*member;
};

struct NumberField {
  const char* name;
  double RecordingHeader::*member;
};

inline constexpr const char* kFormat = "palpate-recording";

inline constexpr std::array kTickColumns{
    Column{"/tick/number", "1", Hdf5Type::kInt64, offsetof(TickRecord, tick), 1},
    Column{"/tick/time_ns", "ns", Hdf5Type::kInt64, offsetof(TickRecord, time_ns), 1},
    Column{"/tick/arrivals", "1", Hdf5Type::kInt64, offsetof(TickRecord, arrivals), 1},
    Column{"/tick/position_m", "m", Hdf5Type::kFloat64,
           offsetof(TickRecord, position_m), 3},
    Column{"/tick/force_n", "N", Hdf5Type::kFloat64, offsetof(TickRecord, force_n), 3},
    Column{"/tick/depth_m", "m", Hdf5Type::kFloat64, offsetof(TickRecord, depth_m), 1},
    Column{"/tick/work_j", "J", Hdf5Type::kFloat64, offsetof(TickRecord, work_j), 1},
    Column{"/tick/stored_j", "J", Hdf5Type::kFloat64, offsetof(TickRecord, stored_j),
           1},
    Column{"/tick/tank_j", "J", Hdf5Type::kFloat64, offsetof(TickRecord, tank_j), 1},
    Column{"/tick/dissipated_j", "J", Hdf5Type::kFloat64,
           offsetof(TickRecord, dissipated_j), 1},
    Column{"/tick/relaxed_shift_m", "m", Hdf5Type::kFloat64,
           offsetof(TickRecord, relaxed_shift_m), 1},
    Column{"/tick/triangle", "1", Hdf5Type::kInt32, offsetof(TickRecord, triangle), 1},
    Column{"/tick/flags", "1", Hdf5Type::kUint8, offsetof(TickRecord, flags), 1},
    Column{"/tick/raised", "1", Hdf5Type::kUint8, offsetof(TickRecord, raised), 1},
    Column{"/tick/fault", "1", Hdf5Type::kUint8, offsetof(TickRecord, fault), 1}};

inline constexpr std::array kArrivalColumns{
    Column{"/arrival/tick", "1", Hdf5Type::kInt64, offsetof(ArrivalRecord, tick), 1},
    Column{"/arrival/sequence", "1", Hdf5Type::kInt64,
           offsetof(ArrivalRecord, sequence), 1},
    Column{"/arrival/sent_ns", "ns", Hdf5Type::kInt64, offsetof(ArrivalRecord, sent_ns),
           1},
    Column{"/arrival/triangle", "1", Hdf5Type::kInt32,
           offsetof(ArrivalRecord, triangle), 1},
    Column{"/arrival/active", "1", Hdf5Type::kUint8, offsetof(ArrivalRecord, active),
           1}};

/// There only where something had yielded.
inline constexpr std::array kSurfaceColumns{
    Column{"/surface/site", "1", Hdf5Type::kInt32, offsetof(YieldedRow, site), 1},
    Column{"/surface/dent_m", "m", Hdf5Type::kFloat64, offsetof(YieldedRow, dent_m), 1},
    Column{"/surface/softened_m", "m", Hdf5Type::kFloat64,
           offsetof(YieldedRow, softened_m), 1}};

inline constexpr std::array kTexts{
    TextField{"writer", &RecordingHeader::writer},
    TextField{"database", &RecordingHeader::database},
    TextField{"database_sha256", &RecordingHeader::database_sha256},
    TextField{"tool", &RecordingHeader::tool},
    TextField{"model", &RecordingHeader::model},
    TextField{"clock", &RecordingHeader::clock},
    TextField{"device", &RecordingHeader::device}};

inline constexpr std::array kNumbers{
    NumberField{"fast_hz", &RecordingHeader::fast_hz},
    NumberField{"slow_hz", &RecordingHeader::slow_hz},
    NumberField{"force_scale", &RecordingHeader::force_scale},
    NumberField{"tool_radius_m", &RecordingHeader::tool_radius_m},
    NumberField{"force_max_n", &RecordingHeader::force_max_n},
    NumberField{"slew_max_n_per_s", &RecordingHeader::slew_max_n_per_s},
    NumberField{"energy_floor_j", &RecordingHeader::energy_floor_j},
    NumberField{"recovery_m_per_s", &RecordingHeader::recovery_m_per_s},
    NumberField{"ramp_s", &RecordingHeader::ramp_s},
    NumberField{"device_damping_n_s_per_m", &RecordingHeader::device_damping_n_s_per_m},
    NumberField{"device_coulomb_n", &RecordingHeader::device_coulomb_n},
    NumberField{"device_resolution_m", &RecordingHeader::device_resolution_m},
    NumberField{"device_delay_s", &RecordingHeader::device_delay_s}};

}  // namespace palpate::recording
